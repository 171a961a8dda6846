"""Variants of a level: what a part of it does, by compiling the level without that part.

Compiling takes time, so rules use variants only where simpler checks are inconclusive, and only a
limited number of them.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.compiler import compile_mdp
from babyrobot_levels.mdp.digest import digest
from babyrobot_levels.mdp.tables import Mdp

MAX_VARIANTS = 50
"""The maximum number of variants that a rule compiles."""

MAX_CELLS = 1 << 21
"""The maximum number of cells in all variants together, except for the first one."""


def max_variants(level: Level) -> int:
    """Return how many variants of a level a rule may compile."""
    cells = level.size[0] * level.size[1]
    return max(1, min(MAX_VARIANTS, MAX_CELLS // cells))


def variant(level: Level, **fields: Any) -> Mdp:
    """Return the tables of a level with other values for fields that do not affect the grid.

    Values are not validated: a reward may be NaN, to see where it occurs.
    """
    return compile_mdp(level.model_copy(update=fields), level.grid())


def is_equivalent(level: Level, mdp: Mdp) -> bool:
    """Return whether tables on a level's grid are equal to the level's tables."""
    return digest(level, level.grid(), mdp) == level.digest


def has_equal_outcomes(one: Mdp, other: Mdp, states: NDArray[np.intp]) -> bool:
    """Return whether two MDPs have the same outcomes in some states."""
    return all(map(np.array_equal, _outcomes(one, states), _outcomes(other, states)))


def _outcomes(mdp: Mdp, states: NDArray[np.intp]) -> tuple[NDArray[Any], ...]:
    probability = mdp.probability[states]
    happens = probability > 0
    tables = (mdp.next_state[states], mdp.reward[states])
    return happens.sum(axis=2), probability[happens], *(table[happens] for table in tables)


def gives(level: Level, field: str) -> bool:
    """Return whether any outcome of a level includes one of its `rewards`."""
    rewards = level.rewards.model_copy(update={field: np.nan})
    return bool(np.isnan(variant(level, rewards=rewards).reward).any())


def rewarded_cells(level: Level) -> NDArray[np.bool_]:
    """Return the cells whose own reward some outcome includes, `[height, width]`.

    A cell's own reward is that of its puddle, its area, or the level's `step`.
    """
    types = {
        size: getattr(level.puddle_types, size).model_copy(update={"reward": np.nan})
        for size in ("small", "large")
    }
    mdp = variant(
        level,
        areas=tuple(area.model_copy(update={"reward": None}) for area in level.areas),
        puddle_types=level.puddle_types.model_copy(update=types),
        rewards=level.rewards.model_copy(update={"step": np.nan}),
    )
    given = np.zeros(mdp.num_states, bool)
    given[mdp.next_state[np.isnan(mdp.reward)]] = True
    return given.reshape(mdp.height, mdp.width)
