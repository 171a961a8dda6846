"""Solving large levels with machine code, where Numba is installed."""

from functools import cache

from babyrobot_levels.mdp.mazes.compiled import load

MANY_STATES = 3_000
"""From so many states on, it is worth loading Numba."""


def is_compiled(states: int) -> bool:
    """Return whether so many states are solved with machine code."""
    return states >= MANY_STATES and _has_numba()


MANY_LEVELS = 500
"""From so many small levels on, it is worth loading Numba, too."""


def are_compiled(levels: int) -> bool:
    """Return whether so many small levels are solved with machine code, one after the other."""
    return levels >= MANY_LEVELS and _has_numba()


@cache
def _has_numba() -> bool:
    return load("babyrobot_levels.analysis.solver.compiled.rows") is not None
