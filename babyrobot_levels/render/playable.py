"""A level as data that a script can play: the tables, and what each outcome looks like."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from babyrobot_levels.actions import NUM_ACTIONS, Action
from babyrobot_levels.mdp import GLASS, REFUSED
from babyrobot_levels.scene.layout import CELL, layout_of
from babyrobot_levels.scene.pose import STANDING, Mood, Pose, pose_of

if TYPE_CHECKING:
    from babyrobot_levels.level import Level
    from babyrobot_levels.mdp import Mdp

FORMAT, VERSION = "babyrobot-page", 1
"""What the data says of itself."""

EVENTS = ("stay", "move", "carried", "bump", "skid", "bounce")
"""What a step can come to: warps and wind carry the robot, walls bump him, glass bounces him."""

PHASES = 4
"""The number of pictures of the robot on his way from cell to cell."""

_SHIFTS = {
    Action.NORTH: (0, -1),
    Action.EAST: (1, 0),
    Action.SOUTH: (0, 1),
    Action.WEST: (-1, 0),
}


def playable(level: Level) -> tuple[dict[str, Any], list[Pose]]:
    """Return the data, which JSON can hold, and the poses that it numbers.

    `outcomes` holds for each state and action all that can happen, in one list of six numbers
    each: probability, next state, reward, terminal, and the numbers of event and pose. It is
    None where the episode is over. `possible` has a bit for each action, and `cheer` is the pose
    at an exit; pose 0 is that of the start. Lengths are those of the scene.

    Args:
        level: the level; a maze needs a seed.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """
    mdp = level.compile()
    poses = {STANDING: 0, Pose(mood=Mood.CHEER): 1}
    outcomes = [
        None if over else [_outcomes(mdp, state, action, poses) for action in range(NUM_ACTIONS)]
        for state, over in enumerate(mdp.over.tolist())
    ]
    data = {
        "format": FORMAT,
        "version": VERSION,
        "width": mdp.width,
        "height": mdp.height,
        "cell": CELL,
        "margin": layout_of(level).margin,
        "speed": level.display.robot.speed,
        "phases": PHASES,
        "cheer": 1,
        "starts": mdp.start.nonzero()[0].tolist(),
        "exits": [y * mdp.width + x for x, y in level.exits],
        "max_steps": level.max_steps,
        "possible": [
            sum(possible << action for action, possible in enumerate(row))
            for row in mdp.possible.tolist()
        ],
        "events": EVENTS,
        "outcomes": outcomes,
    }
    return data, list(poses)


def _outcomes(mdp: Mdp, state: int, action: int, poses: dict[Pose, int]) -> list[float | int]:
    row: list[float | int] = []
    for probability, next_state, reward, terminal in mdp.outcomes(state, action):
        event = _event(mdp, state, action, next_state)
        pose = pose_of(state, next_state, action, mdp.width, skidded=event == "skid")
        row += [probability, next_state, _short(reward), int(terminal)]
        row += [EVENTS.index(event), poses.setdefault(pose, len(poses))]
    return row


def _event(mdp: Mdp, state: int, action: int, next_state: int) -> str:
    target, hindered = int(mdp.target[state, action]), int(mdp.hindered[state, action])
    to_start = target == mdp.num_states and mdp.start[next_state] > 0
    if next_state != target and not to_start:
        return "bounce" if hindered == GLASS else "skid"
    if hindered == REFUSED:
        return "bump"
    if next_state == state:
        return "stay"
    before_y, before_x = divmod(state, mdp.width)
    y, x = divmod(next_state, mdp.width)
    is_own_way = _SHIFTS.get(Action(action)) == (x - before_x, y - before_y)
    return "move" if is_own_way else "carried"


def _short(value: float) -> float | int:
    return int(value) if value.is_integer() else value
