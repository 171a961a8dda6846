"""The tables that a page plays: the distinct rows, and what happens in each outcome."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from babyrobot_levels.mdp.actions import DELTAS, Action
from babyrobot_levels.mdp.events import Event, events_of, hits_by_mover
from babyrobot_levels.render.scene.situation import STANDING, Mood, Pose, pose_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from babyrobot_levels.mdp.gridworld import GridWorld
    from babyrobot_levels.mdp.tables import Mdp

    _Ints = NDArray[np.int64]

EVENTS = ("stay", "move", "carried", "bump", "skid", "bounce")
"""The events of a step: warps and wind carry the robot, walls bump it, glass bounces it.

In an outcome, the number of the event is larger by `len(EVENTS)` times the number of the mover
that hits the robot, counted from 1.
"""

CHEER = 1
"""The index of the pose at a good end."""

POSES = (
    STANDING,
    Pose(mood=Mood.CHEER),
    *(Pose(action) for action in Action if action is not Action.STAY),
    *(Pose(action, Mood.SLIP) for action in Action),
)
"""All poses after a step; outcomes give their indices. The first one is that of the start."""

HEADING_POSES = [
    [POSES.index(Pose(action, mood)) for action in Action if action is not Action.STAY]
    for mood in (Mood.CALM, Mood.SLIP)
]
"""The indices of the poses of a robot that turns, by heading: calm, and slipping."""

_FAR = len(Action)
"""The number of a displacement that is not to a neighbouring cell; others are an `Action`."""


def rows_of(level: GridWorld) -> tuple[list[list[float | int]], list[int]]:
    """Return the distinct outcome distributions, and the row of each state and action.

    A row has six numbers for each outcome: probability, next state minus state, reward, terminal,
    and the indices of event and pose. The row of a terminal state is -1.

    Args:
        level: the level; a maze needs a seed.
    """
    mdp = level.compile()
    (state,) = np.nonzero(~mdp.is_terminal)
    is_used = mdp.probability[state] > 0
    columns = [table[is_used] for table in _columns(level, mdp, state)]
    code = np.zeros(len(columns[0]), np.int64)
    for column in columns:
        # One number for what the columns so far have in common.
        distinct, place = np.unique(column, return_inverse=True)
        code = np.unique(code * len(distinct) + place, return_inverse=True)[1]
    first = np.unique(code, return_index=True)[1]
    listed = [column[first].tolist() for column in columns]
    outcomes = [[_short(value) for value in values] for values in zip(*listed, strict=True)]
    numbers = np.full(is_used.shape, -1, np.int32)
    numbers[is_used] = code
    rows: dict[bytes, int] = {}
    table = np.full((mdp.num_states, mdp.num_actions), -1, np.int32)
    table[state] = [
        [rows.setdefault(row.tobytes(), len(rows)) for row in of_state] for of_state in numbers
    ]
    distinct_rows = (np.frombuffer(row, np.int32) for row in rows)
    return [
        [value for number in row[row >= 0].tolist() for value in outcomes[number]]
        for row in distinct_rows
    ], table.ravel().tolist()


def _columns(level: GridWorld, mdp: Mdp, state: _Ints) -> Iterator[NDArray[Any]]:
    """Yield the six numbers of outcomes, each `[states, actions, outcomes]`."""
    next_state = mdp.next_state[state]
    yield mdp.probability[state]
    yield next_state - state[:, None, None]
    yield mdp.reward[state]
    yield mdp.terminal[state]
    kind, shift = events_of(mdp)[state], _displacements(mdp, state, next_state)
    action = np.arange(mdp.num_actions)[:, None]
    event = np.where(shift == action, EVENTS.index("move"), EVENTS.index("carried"))
    event[shift == Action.STAY] = EVENTS.index("stay")
    for code, name in (
        (Event.BUMPED, "bump"),
        (Event.SKIDDED, "skid"),
        (Event.BOUNCED, "bounce"),
    ):
        event[kind == code] = EVENTS.index(name)
    yield event + len(EVENTS) * _hits(level, mdp)[state]
    yield _POSE_NUMBERS[shift, action, (kind == Event.SKIDDED).astype(int)]


def _displacements(mdp: Mdp, state: _Ints, next_state: NDArray[np.int32]) -> _Ints:
    """Return the move from cell to cell, as an `Action`; `_FAR` for none of them."""
    before_y, before_x = np.divmod(state[:, None, None] % mdp.cells, mdp.width)
    y, x = np.divmod(next_state % mdp.cells, mdp.width)
    shift = np.full(next_state.shape, _FAR)
    shift[(x == before_x) & (y == before_y)] = Action.STAY
    for action, (dx, dy) in DELTAS.items():
        shift[(x - before_x == dx) & (y - before_y == dy)] = action
    return shift


def _hits(level: GridWorld, mdp: Mdp) -> NDArray[np.int8]:
    """Return the number of the mover that hits the robot, counted from 1; 0 for none."""
    numbers = np.zeros(mdp.next_state.shape, np.int8)
    for number, is_hit in enumerate(hits_by_mover(level, mdp), 1):
        numbers[is_hit & (numbers == 0)] = number
    return numbers


def _pose_numbers() -> _Ints:
    """Return the indices of poses by displacement, action and whether the robot skidded."""
    width = 5
    centre = 2 * width + 2
    ends = [centre + dx + width * dy for dx, dy in ((0, 0), *DELTAS.values(), (2, 0))]
    return np.array(
        [
            [
                [
                    POSES.index(pose_of(centre, end, action, width, skidded=skidded))
                    for skidded in (False, True)
                ]
                for action in Action
            ]
            for end in ends
        ]
    )


_POSE_NUMBERS = _pose_numbers()


def _short(value: float) -> float | int:
    """Return a number, as an integer if it is one."""
    return int(value) if float(value).is_integer() else value
