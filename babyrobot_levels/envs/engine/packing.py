"""What compiled loops read, in one array."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.envs.engine.tables import Tables


def packed(tables: Tables, observations: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return all that loops read, in one array, of which `loops.unpacked` makes the arrays again.

    To hand an array over to compiled code takes as long as several robots' steps.

    Args:
        tables: what the robots walk in.
        observations: what each state shows, int64 `[states, numbers]`.
    """
    arrays = [
        array.astype(np.int64) if array.dtype == np.bool_ else array.ravel().view(np.int64)
        for array in arrays_of(tables, observations)
    ]
    ends = len(arrays) + np.cumsum([array.size for array in arrays])
    return np.concatenate([ends, *arrays])


def arrays_of(tables: Tables, observations: NDArray[np.int64]) -> tuple[NDArray[Any], ...]:
    """Return all that loops read, in the order in which `packed` has it."""
    return (
        tables.next_state,
        tables.reward,
        tables.arrival,
        tables.chance,
        tables.first,
        tables.threshold,
        tables.over,
        tables.standing,
        tables.starts,
        tables.first_start,
        tables.limit,
        observations,
        tables.offset,
        np.array([tables.num_actions, tables.draws_levels, tables.draws_starts]),
    )


SPANS = {
    0: ("rows", "outcomes"),
    1: ("rows", "outcomes"),
    2: ("rows", "outcomes"),
    3: ("rows",),
    5: ("chances",),
    6: ("states",),
    7: ("states",),
    8: ("starts",),
    11: ("states",),
}
"""Which of the arrays change when a level is written into a slot, and which parts of them."""
