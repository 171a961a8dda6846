"""How the robot holds himself: one rule, so that he looks the same in every painter's pictures."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from babyrobot_levels.mdp.actions import DELTAS, Action


class Mood(StrEnum):
    """What has just happened to the robot."""

    CALM = "calm"
    SLIP = "slip"
    CHEER = "cheer"


@dataclass(frozen=True, slots=True)
class Pose:
    """How the robot holds himself.

    Attributes:
        facing: where he looks; `STAY` is at the viewer.
        mood: what has just happened to him.
        phase: how far he is in a step from cell to cell, 0 to 1. He bobs on the way, and at 0 and
            1 he stands.
    """

    facing: Action = Action.STAY
    mood: Mood = Mood.CALM
    phase: float = 0.0


_FACINGS = {move: action for action, move in DELTAS.items()}

STANDING = Pose()
"""How he stands before the first step."""


def pose_of(
    previous_state: int,
    state: int,
    action: int,
    width: int,
    *,
    skidded: bool = False,
    at_exit: bool = False,
) -> Pose:
    """Return the pose after a step.

    He looks to the side that he moved to. Where he stayed, or came from far, he looks to where he
    wanted to go. At an exit he cheers, and at the viewer.

    Args:
        previous_state: the cell that he came from, `y * width + x`.
        state: the cell that he stands in.
        action: what he was told to do, a `brl.Action`.
        width: the number of columns of the level.
        skidded: whether chance led him elsewhere.
        at_exit: whether he stands on an exit.
    """
    if at_exit:
        return Pose(mood=Mood.CHEER)
    before_y, before_x = divmod(previous_state, width)
    y, x = divmod(state, width)
    facing = _FACINGS.get((x - before_x, y - before_y), Action(action))
    return Pose(facing, Mood.SLIP if skidded else Mood.CALM)
