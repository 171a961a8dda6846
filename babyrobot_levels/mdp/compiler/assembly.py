"""The tables of all compilers, put together from what each of them finds."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.mdp.grid import Grid
from babyrobot_levels.mdp.tables import REFUSED, Flags, Floats, Ints, Mdp


def assembled(
    grid: Grid,
    *,
    start: Floats,
    over: Flags,
    intended: Ints,
    obstruction: NDArray[np.int8],
    tables: dict[str, Any],
    **more: Any,
) -> Mdp:
    """Return the tables, with the rows of states in which the episode is over, and action masks.

    Args:
        grid: the grid, which tells width and height.
        start: the probability of each state at reset, `[states]`.
        over: whether the episode is over there, `[states]`.
        intended: where each action leads without chance, `[states, actions]`.
        obstruction: what hinders each action, `[states, actions]`.
        tables: `probability`, `next_state`, `reward` and `terminal`, `[states, actions, outcomes]`,
            in which the rows of ended states may be empty.
        more: other attributes of `Mdp`.
    """
    ended = np.flatnonzero(over)
    tables["probability"][ended, :, 0] = 1.0
    tables["next_state"][ended, :, 0] = ended[:, None]
    tables["terminal"][ended, :, 0] = True
    mask = (obstruction != REFUSED).astype(np.int8)
    mask[over, 1:] = 0
    return Mdp(
        width=grid.width,
        height=grid.height,
        start=start,
        is_terminal=over,
        action_mask=mask,
        intended_next_state=intended.astype(np.int32, copy=False),
        obstruction=obstruction,
        **tables,
        **more,
    ).freeze()
