"""Level and grid to the exact tables.

Every chance becomes a branch: a row (state and action), a probability, and where it comes to
stand. Rows without chance have one branch and are filled in as whole columns; only the others are
expanded, merged and sorted. All arithmetic is in the same order on every platform.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.mdp.actions import NUM_ACTIONS
from babyrobot_levels.mdp.compiler.moves import build_moves, build_warps
from babyrobot_levels.mdp.compiler.obstructions import obstructions
from babyrobot_levels.mdp.compiler.outcomes import (
    Arrivals,
    Branches,
    Floats,
    Ints,
    ended,
    plain_branches,
    stochastic_branches,
    stochastic_rows,
)
from babyrobot_levels.mdp.compiler.terrain import Terrain, build_terrain
from babyrobot_levels.mdp.grid import Grid
from babyrobot_levels.mdp.tables import REFUSED, Mdp


def compile_cells(level: LevelFields, grid: Grid) -> Mdp:
    """Compile a level without things, whose states are the cells, into its exact tables."""
    terrain = build_terrain(level, grid)
    moves = build_moves(level, grid)
    warps = build_warps(level, grid)
    arrivals = Arrivals(level.rewards, terrain, warps)
    starts = np.array([y * grid.width + x for x, y in level.starts])

    plain = plain_branches(moves, terrain, warps)
    next_state = arrivals.next_states(plain)
    # A plain row that leads to one of several starts is a chance too.
    lost = next_state == terrain.over.size
    stochastic = stochastic_rows(moves, terrain, warps)
    by_chance = [
        *stochastic_branches(moves, terrain, stochastic),
        plain.select(lost & ~stochastic.ravel()),
    ]
    branches = by_chance[0].joined(*by_chance[1:])
    branches = branches.select(branches.probability > 0)
    next_state[lost] = 0
    tables: dict[str, Any] = _plain_tables(
        next_state, arrivals.rewards_of(plain, next_state), terrain
    )
    if branches.row.size:
        tables = _with_outcomes(tables, _merged(branches, arrivals, starts), terrain)

    obstruction, intended = obstructions(moves, terrain, warps)
    action_mask = (obstruction != REFUSED).astype(np.int8)
    action_mask[terrain.over, 1:] = 0
    start = np.zeros(terrain.over.size)
    start[starts] = 1.0 / starts.size
    return Mdp(
        width=grid.width,
        height=grid.height,
        start=start,
        is_terminal=terrain.over,
        action_mask=action_mask,
        intended_next_state=intended,
        obstruction=obstruction,
        **tables,
    ).freeze()


@dataclass(slots=True)
class _Outcomes:
    """Distinct outcomes, sorted by row, next state and reward."""

    row: Ints
    probability: Floats
    next_state: Ints
    reward: Floats


def _plain_tables(next_state: Ints, reward: Floats, terrain: Terrain) -> dict[str, NDArray[Any]]:
    """Return tables with one outcome a row, as if there were no chance."""
    shape = (terrain.over.size, NUM_ACTIONS, 1)
    return {
        "probability": np.ones(shape),
        "next_state": next_state.astype(np.int32).reshape(shape),
        "reward": reward.reshape(shape),
        "terminal": terrain.over[next_state].reshape(shape),
    }


def _merged(branches: Branches, arrivals: Arrivals, starts: Ints) -> _Outcomes:
    """Return what branches come to, those with the same end and reward as one."""
    branches, next_state = ended(branches, arrivals, starts)
    reward = arrivals.rewards_of(branches, next_state)
    order = np.lexsort((reward, next_state, branches.row))
    row, next_state, reward = branches.row[order], next_state[order], reward[order]
    is_new = np.ones(row.size, bool)
    is_new[1:] = (
        (row[1:] != row[:-1]) | (next_state[1:] != next_state[:-1]) | (reward[1:] != reward[:-1])
    )
    first = np.flatnonzero(is_new)
    probability = np.add.reduceat(branches.probability[order], first)
    return _Outcomes(row[first], probability, next_state[first], reward[first])


def _with_outcomes(
    tables: dict[str, NDArray[Any]], outcomes: _Outcomes, terrain: Terrain
) -> dict[str, NDArray[Any]]:
    """Return the tables with the outcomes in their rows, as wide as the longest row needs."""
    begins = np.ones(outcomes.row.size, bool)
    begins[1:] = outcomes.row[1:] != outcomes.row[:-1]
    first = np.flatnonzero(begins)
    length = np.diff(np.append(first, outcomes.row.size))
    slot = np.arange(outcomes.row.size) - np.repeat(first, length)
    width = int(length.max())
    values = {
        "probability": outcomes.probability,
        "next_state": outcomes.next_state,
        "reward": outcomes.reward,
        "terminal": terrain.over[outcomes.next_state],
    }
    wide = {}
    for name, plain in tables.items():
        table = np.zeros((*plain.shape[:2], width), plain.dtype)
        table[:, :, :1] = plain
        table.reshape(-1, width)[outcomes.row, slot] = values[name]
        wide[name] = table
    return wide
