"""Loading the compiled sweeps, where Numba is installed."""

from types import ModuleType

from babyrobot_levels.mdp.mazes.compiled import load

MANY_STATES = 3_000
"""From so many states on, they are worth loading Numba."""


def kernel_for(states: int) -> ModuleType | None:
    """Return the kernel for so many states, None for few of them or without Numba."""
    return load("babyrobot_levels.analysis.solver.kernel") if states >= MANY_STATES else None
