"""The robot's poses, and the pose after a step: one rule for all painters."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum

from babyrobot_levels.mdp.actions import DELTAS, Action


class Mood(StrEnum):
    """What has just happened to the robot."""

    CALM = "calm"
    SLIP = "slip"
    CHEER = "cheer"


@dataclass(frozen=True, slots=True)
class Pose:
    """A pose of the robot.

    Attributes:
        facing: where it looks; `STAY` is at the viewer.
        mood: what has just happened to it.
        phase: the part of a move from cell to cell that is done, 0 to 1. The robot bobs while it
            moves; at 0 and 1 it stands.
        heading: of a robot that turns, the direction of its next move, 0 N, 1 E, 2 S, 3 W; None
            for one that does not turn.
    """

    facing: Action = Action.STAY
    mood: Mood = Mood.CALM
    phase: float = 0.0
    heading: int | None = None

    def turned(self, heading: int | None) -> Pose:
        """Return the pose of a robot that turns, which looks where it is heading.

        None gives the pose of one that does not turn: this one.
        """
        if heading is None:
            return self
        facing = self.facing if self.mood is Mood.CHEER else Action(heading + Action.NORTH)
        return replace(self, facing=facing, heading=heading)


_FACINGS = {move: action for action, move in DELTAS.items()}

STANDING = Pose()
"""The pose before the first step."""


def pose_of(
    previous_cell: int,
    cell: int,
    action: int,
    width: int,
    *,
    skidded: bool = False,
    ends_well: bool = False,
) -> Pose:
    """Return the pose after a step.

    The robot looks in the direction of its move. If it stayed, or came from farther away, it looks
    in the direction of its action. At a good end it cheers, facing the viewer.

    Args:
        previous_cell: the number of the cell before the step, `y * width + x`.
        cell: that of the cell after the step.
        action: the action, a `brl.Action`.
        width: the number of columns of the level.
        skidded: whether the robot skidded to another cell than the action leads to.
        ends_well: whether the step ends the episode well; see `GoodEnds`.
    """
    if ends_well:
        return Pose(mood=Mood.CHEER)
    before_y, before_x = divmod(previous_cell, width)
    y, x = divmod(cell, width)
    facing = _FACINGS.get((x - before_x, y - before_y), Action(action))
    return Pose(facing, Mood.SLIP if skidded else Mood.CALM)
