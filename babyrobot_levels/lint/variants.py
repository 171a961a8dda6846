"""The level with something else in the place of a field: what a part of it does, by proof.

Compiling takes time, so that rules do it last, where nothing simpler tells, and not too often.
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
"""A rule compiles no more variants of a level than this."""

MAX_CELLS = 1 << 21
"""Nor more cells in all its variants, but for the first one."""


def max_variants(level: Level) -> int:
    """Return how many variants of a level a rule may compile."""
    cells = level.size[0] * level.size[1]
    return max(1, min(MAX_VARIANTS, MAX_CELLS // cells))


def variant(level: Level, **fields: Any) -> Mdp:
    """Return the tables with other values for some fields, none of which shapes the grid.

    Values are not validated: a reward may be nan, to see where it goes.
    """
    return compile_mdp(level.model_copy(update=fields), level.grid())


def is_same_game(level: Level, mdp: Mdp) -> bool:
    """Tell whether tables on a level's grid are those of the level."""
    return digest(level.grid(), mdp) == level.digest


def is_same_play(one: Mdp, other: Mdp, states: NDArray[np.intp]) -> bool:
    """Tell whether the same can happen in some of the states."""
    return all(map(np.array_equal, _outcomes(one, states), _outcomes(other, states)))


def _outcomes(mdp: Mdp, states: NDArray[np.intp]) -> tuple[NDArray[Any], ...]:
    probability = mdp.probability[states]
    happens = probability > 0
    tables = (mdp.next_state[states], mdp.reward[states])
    return happens.sum(axis=2), probability[happens], *(table[happens] for table in tables)


def gives(level: Level, field: str) -> bool:
    """Tell whether any outcome of a level has one of its `rewards`."""
    rewards = level.rewards.model_copy(update={field: np.nan})
    return bool(np.isnan(variant(level, rewards=rewards).reward).any())


def rewarded_cells(level: Level) -> NDArray[np.bool_]:
    """Return the cells whose own reward some outcome has, `[height, width]`.

    That is the reward of a puddle, an area, or the level's step.
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
