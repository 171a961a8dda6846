"""Which engine walks the robots."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.envs.engine.plain import PlainEngine
from babyrobot_levels.envs.engine.robots import Engine
from babyrobot_levels.envs.engine.tables import Tables
from babyrobot_levels.text.words import did_you_mean

ENGINES = ("numpy", "compiled")


def make_engine(
    name: str | None, tables: Tables, observations: NDArray[np.int64], num_robots: int
) -> Engine:
    """Return an engine.

    Args:
        name: one of `ENGINES`, or None for the fastest that is installed.
        tables: what the robots walk in.
        observations: what each state shows, int64 `[states, numbers]`.
        num_robots: how many there are.

    Raises:
        ValueError: there is no such engine.
        ImportError: the compiled engine is asked for, and Numba cannot be imported.
    """
    if name not in (None, *ENGINES):
        known = ", ".join(map(repr, ENGINES))
        guess = did_you_mean(name, ENGINES) if isinstance(name, str) else ""
        raise ValueError(f"engine must be {known} or None, not {name!r}{guess}")
    if name != "numpy":
        try:
            from babyrobot_levels.envs.engine.compiled import CompiledEngine
        except (ImportError, RuntimeError) as reason:
            # Numba raises the latter where it finds no folder to keep what it compiles.
            if name == "compiled":
                raise ImportError(
                    "engine='compiled' needs Numba, free to compile and to keep what it compiles: "
                    "pip install 'babyrobot-levels[fast]'"
                ) from reason
        else:
            return CompiledEngine(tables, observations, num_robots)
    return PlainEngine(tables, observations, num_robots)
