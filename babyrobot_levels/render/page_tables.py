"""The tables that a page's script plays: the distinct rows, and what happens in each outcome."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.mdp.actions import DELTAS, NUM_ACTIONS, Action
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.mdp.tables import Event, Ints, Mdp, events_of, hits_by_mover
from babyrobot_levels.render.page_format import EVENTS, POSES, TooLargeError, short
from babyrobot_levels.render.situation import pose_of

MAX_NUMBERS = 2_000_000
"""The most numbers of the distinct rows of a page's tables."""

_FAR = len(Action)
"""The number of a displacement that is not to a neighbouring cell; others are an `Action`."""


def tables_of(level: GridWorld) -> dict[str, Any]:
    """Return the tables of a page, and the states in which episodes begin.

    `rows` and `table` are those of `rows_of`. `possible` has a bit for each action; of several
    robots, for each action of the first, then of the second, and so on.

    Args:
        level: the level; a maze needs a seed.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
        TooLargeError: the tables are too large for a page.
    """
    mdp = level.compile()
    rows, table = rows_of(level)
    if (numbers := sum(map(len, rows))) > MAX_NUMBERS:
        raise TooLargeError(
            f"the tables of the level are too large for a page: their rows have {numbers:,} "
            f"numbers, and the limit is {MAX_NUMBERS:,}"
        )
    return {
        "starts": mdp.starts.tolist(),
        "rows": rows,
        "table": table,
        "possible": _possible(mdp).tolist(),
    }


def _possible(mdp: Mdp) -> Ints:
    """Return which actions are possible in each state, as bits."""
    if mdp.num_robots == 1:
        return mdp.action_mask.astype(np.int64) @ (1 << np.arange(mdp.num_actions))
    masks = mdp.action_mask.reshape(mdp.num_states, *[NUM_ACTIONS] * mdp.num_robots)
    bits = np.zeros(mdp.num_states, np.int64)
    for robot in range(mdp.num_robots):
        others = tuple(axis for axis in range(1, masks.ndim) if axis != robot + 1)
        bits |= masks.max(axis=others) @ (1 << np.arange(NUM_ACTIONS)) << NUM_ACTIONS * robot
    return bits


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
    outcomes = [[short(value) for value in values] for values in zip(*listed, strict=True)]
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


def _columns(level: GridWorld, mdp: Mdp, state: Ints) -> Iterator[NDArray[Any]]:
    """Yield the six numbers of outcomes, each `[states, actions, outcomes]`."""
    next_state = mdp.next_state[state]
    yield mdp.probability[state]
    yield next_state - state[:, None, None]
    yield mdp.reward[state]
    yield mdp.terminal[state]
    kind, shift = events_of(mdp)[state], _displacements(mdp, state, next_state)
    # The pose is that of the first robot.
    action = mdp.robot_actions(np.arange(mdp.num_actions))[:, :1]
    event = np.where(shift == action, EVENTS.index("move"), EVENTS.index("carried"))
    event[shift == Action.STAY] = EVENTS.index("stay")
    for code, name in ((Event.BUMPED, "bump"), (Event.SKIDDED, "skid"), (Event.BOUNCED, "bounce")):
        event[kind == code] = EVENTS.index(name)
    yield event + len(EVENTS) * _hits(level, mdp)[state]
    yield _POSE_NUMBERS[shift, action, (kind == Event.SKIDDED).astype(int)]


def _displacements(mdp: Mdp, state: Ints, next_state: NDArray[np.int32]) -> Ints:
    """Return the move from cell to cell, as an `Action`; `_FAR` for none of them."""
    before_y, before_x = np.divmod(state[:, None, None] % mdp.cells, mdp.width)
    y, x = np.divmod(next_state % mdp.cells, mdp.width)
    shift = np.full(next_state.shape, _FAR)
    shift[(x == before_x) & (y == before_y)] = Action.STAY
    for action, (dx, dy) in DELTAS.items():
        shift[(x - before_x == dx) & (y - before_y == dy)] = action
    return shift


def _hits(level: GridWorld, mdp: Mdp) -> NDArray[np.int32]:
    """Return the number of the mover that hits the robot, counted from 1; 0 for none."""
    numbers = np.zeros(mdp.next_state.shape, np.int32)
    for mover, is_hit in enumerate(hits_by_mover(level, mdp), 1):
        numbers[is_hit & (numbers == 0)] = mover
    return numbers


def _pose_numbers() -> Ints:
    """Return the indices of poses by displacement, action and whether the robot skidded."""
    width = 5
    centre = 2 * width + 2
    return np.array(
        [
            [
                [
                    POSES.index(pose_of(centre, end, action, width, skidded=skidded))
                    for skidded in (False, True)
                ]
                for action in Action
            ]
            for end in [centre + dx + width * dy for dx, dy in ((0, 0), *DELTAS.values(), (2, 0))]
        ]
    )


_POSE_NUMBERS = _pose_numbers()
