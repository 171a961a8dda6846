"""Variants of a level: what a part of it does, by compiling the level without that part.

Compiling takes time, so rules use variants only where simpler checks are inconclusive, and only a
limited number of them.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.compiler import compile_mdp
from babyrobot_levels.mdp.states import occurring
from babyrobot_levels.mdp.tables import Mdp, digest
from babyrobot_levels.text.budget import OverBudgetError
from babyrobot_levels.text.errors import LevelError

MAX_VARIANTS = 50
"""The maximum number of variants that a rule compiles."""

MAX_STATES = 1 << 21
"""The maximum number of states in all variants together, except for the first one."""


def max_variants(level: Level) -> int:
    """Return how many variants of a level a rule may compile."""
    return max(1, min(MAX_VARIANTS, MAX_STATES // level.compile().num_states))


def variant(level: Level, **fields: Any) -> Mdp | None:
    """Return the tables of a level with other values for fields that do not affect the grid.

    Values are not validated: a reward may be NaN, to see where it occurs. None if the tables would
    be too large, as they may be where more configurations can be reached than in the level.
    """
    try:
        return compile_mdp(level.model_copy(update=fields), level.grid())
    except (LevelError, OverBudgetError):
        return None


def cells_reached(level: Level, **fields: Any) -> NDArray[np.bool_]:
    """Return which cells can be reached with other values for some fields, `[cells]`.

    A cell counts as reached in any configuration. If the tables would be too large, all cells do.
    """
    mdp = variant(level, **fields)
    if mdp is None:
        return np.ones(level.size[0] * level.size[1], bool)
    reached: NDArray[np.bool_] = occurring(mdp).reshape(-1, mdp.cells).max(axis=0)
    return reached


def with_rewards(level: Level, **fields: Any) -> Mdp:
    """Return the tables of a level with other rewards, which are never too large."""
    return compile_mdp(level.model_copy(update=fields), level.grid())


def is_equivalent(level: Level, mdp: Mdp | None) -> bool:
    """Return whether tables on a level's grid are equal to the level's tables."""
    return mdp is not None and digest(level, level.grid(), mdp) == level.digest


def has_equal_outcomes(one: Mdp, other: Mdp, states: NDArray[np.intp]) -> bool:
    """Return whether two MDPs have the same outcomes in some states."""
    if not np.array_equal(one.configurations, other.configurations):
        return False
    return all(map(np.array_equal, _outcomes(one, states), _outcomes(other, states)))


def _outcomes(mdp: Mdp, states: NDArray[np.intp]) -> tuple[NDArray[Any], ...]:
    probability = mdp.probability[states]
    happens = probability > 0
    tables = (mdp.next_state[states], mdp.reward[states])
    return happens.sum(axis=2), probability[happens], *(table[happens] for table in tables)


def gives(level: Level, field: str) -> bool:
    """Return whether any outcome of a level includes one of its `rewards`."""
    rewards = level.rewards.model_copy(update={field: np.nan})
    return bool(np.isnan(with_rewards(level, rewards=rewards).reward).any())


def rewarded_cells(level: Level) -> NDArray[np.bool_]:
    """Return the cells whose own reward some outcome includes, `[height, width]`.

    A cell's own reward is that of its puddle, its area, or the level's `step`.
    """
    types = {
        size: getattr(level.puddle_types, size).model_copy(update={"reward": np.nan})
        for size in ("small", "large")
    }
    mdp = with_rewards(
        level,
        areas=tuple(area.model_copy(update={"reward": None}) for area in level.areas),
        puddle_types=level.puddle_types.model_copy(update=types),
        rewards=level.rewards.model_copy(update={"step": np.nan}),
    )
    given = np.zeros(mdp.num_states, bool)
    given[mdp.next_state[np.isnan(mdp.reward)]] = True
    return given.reshape(mdp.height, mdp.width)
