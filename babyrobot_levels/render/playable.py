"""A level as data that a script can play: the tables, and what each outcome looks like."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from babyrobot_levels.mdp.actions import NUM_ACTIONS, Action
from babyrobot_levels.mdp.tables import GLASS, REFUSED
from babyrobot_levels.render.scene.layout import layout_of
from babyrobot_levels.render.scene.pose import STANDING, Mood, Pose, pose_of

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld
    from babyrobot_levels.mdp.tables import Mdp

EVENTS = ("stay", "move", "carried", "bump", "skid", "bounce")
"""What a step can come to: warps and wind carry the robot, walls bump him, glass bounces him."""

CHEER = 1
"""The number of the pose at an exit."""

POSES = (
    STANDING,
    Pose(mood=Mood.CHEER),
    *(Pose(action) for action in Action if action is not Action.STAY),
    *(Pose(action, Mood.SLIP) for action in Action),
)
"""All poses that a step can lead to, as outcomes number them; the first is that of the start."""

PHASES = 4
"""The number of pictures of the robot on his way from cell to cell."""

Row = tuple[float | int, ...]

_NUMBERS = {pose: number for number, pose in enumerate(POSES)}
_SHIFTS = {
    Action.NORTH: (0, -1),
    Action.EAST: (1, 0),
    Action.SOUTH: (0, 1),
    Action.WEST: (-1, 0),
}


def playable(level: GridWorld) -> dict[str, Any]:
    """Return the data, which JSON can hold.

    `rows` are the different things that an action can come to, and `table` says for each state and
    action (`NUM_ACTIONS * state + action`) which row it is: -1 where the episode is over. A row is
    one list of six numbers for each outcome: probability, how much larger the number of the next
    state is, reward, terminal, and the numbers of event and pose. `possible` has a bit for each
    action. Lengths are those of the scene.

    Args:
        level: the level; a maze needs a seed.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """
    mdp = level.compile()
    rows: dict[Row, int] = {}
    table: list[int] = []
    for state, over in enumerate(mdp.over.tolist()):
        for action in range(NUM_ACTIONS):
            row = None if over else tuple(_row(mdp, state, action))
            table.append(-1 if row is None else rows.setdefault(row, len(rows)))
    return {
        "width": mdp.width,
        "height": mdp.height,
        "margin": _short(layout_of(level).margin),
        "speed": _short(level.display.robot.speed),
        "starts": mdp.start.nonzero()[0].tolist(),
        "exits": [y * mdp.width + x for x, y in level.exits],
        "max_steps": level.max_steps,
        "rows": [list(row) for row in rows],
        "table": table,
        "possible": [
            sum(possible << action for action, possible in enumerate(row))
            for row in mdp.possible.tolist()
        ],
    }


def _row(mdp: Mdp, state: int, action: int) -> list[float | int]:
    row: list[float | int] = []
    for probability, next_state, reward, terminal in mdp.outcomes(state, action):
        event = _event(mdp, state, action, next_state)
        pose = pose_of(state, next_state, action, mdp.width, skidded=event == "skid")
        row += [_short(probability), next_state - state, _short(reward), int(terminal)]
        row += [EVENTS.index(event), _NUMBERS[pose]]
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
    return int(value) if float(value).is_integer() else value
