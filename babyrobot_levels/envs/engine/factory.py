"""Making an engine: its name, and the numbers of environments and steps that it is made for."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.envs.engine.plain import PlainEngine
from babyrobot_levels.envs.engine.state import Engine
from babyrobot_levels.envs.engine.tables import NO_LIMIT, Tables
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.errors import how_to_install
from babyrobot_levels.text.words import did_you_mean

ENGINES = ("numpy", "compiled")


def make_engine(
    name: str | None, tables: Tables, observations: NDArray[np.int64], num_envs: int
) -> Engine:
    """Return an engine.

    Args:
        name: one of `ENGINES`, or None for `"compiled"` where Numba can be used, else `"numpy"`.
        tables: the tables of the levels.
        observations: the observation of each state, int64 `[states, numbers]`.
        num_envs: how many environments there are.

    Raises:
        ValueError: there is no such engine.
        ImportError: an engine is required whose library is missing or cannot be used.
    """
    if name not in (None, *ENGINES):
        known = ", ".join(map(repr, ENGINES))
        guess = did_you_mean(name, ENGINES) if isinstance(name, str) else ""
        raise ValueError(f"engine must be {known} or None, not {name!r}{guess}")
    if name != "numpy":
        try:
            from babyrobot_levels.envs.engine.compiled import CompiledEngine
        except (ImportError, RuntimeError) as reason:
            # Numba raises the latter if it finds no folder for its cache.
            if name == "compiled":
                raise ImportError(
                    "engine='compiled' needs Numba, with compiling enabled and a cache folder: "
                    + how_to_install("fast")
                ) from reason
        else:
            return CompiledEngine(tables, observations, num_envs)
    return PlainEngine(tables, observations, num_envs)


def checked_count(name: str, value: Any) -> int:
    """Return an argument that is a number of things.

    Raises:
        ValueError: it is not a whole number above 0.
    """
    number = whole_number(value)
    if number is None or number < 1:
        raise ValueError(f"{name} must be a whole number, at least 1, not {value!r}")
    return number


def limits_of(levels: Sequence[Level], max_episode_steps: Any) -> list[int]:
    """Return the time limit of each level, in steps.

    Args:
        levels: the levels.
        max_episode_steps: the limit of all of them, -1 for none; None for each level's own.

    Raises:
        ValueError: it is anything else.
    """
    if max_episode_steps is None:
        return [level.max_steps or NO_LIMIT for level in levels]
    number = whole_number(max_episode_steps)
    if number is None or (number < 1 and number != -1):
        raise ValueError(
            f"max_episode_steps must be at least 1, or -1 for no limit, not {max_episode_steps!r}"
        )
    return [NO_LIMIT if number == -1 else min(number, NO_LIMIT)] * len(levels)


def whole_number(value: Any) -> int | None:
    """Return a value as an int, None if it is not a whole number."""
    try:
        return operator.index(value)
    except TypeError:
        return None
