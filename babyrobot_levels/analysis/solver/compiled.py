"""Loading the compiled sweeps, where Numba is installed."""

from functools import cache
from types import ModuleType

MANY_STATES = 3_000
"""From so many states on, they are worth loading Numba."""


def kernel_for(states: int) -> ModuleType | None:
    """Return the kernel for so many states, None for few of them or without Numba."""
    return _load() if states >= MANY_STATES else None


@cache
def _load() -> ModuleType | None:
    try:
        import numba

        if numba.config.DISABLE_JIT:  # type: ignore[attr-defined]
            return None
        from babyrobot_levels.analysis.solver import kernel
    except (ImportError, RuntimeError):
        # Numba raises the latter where it finds no folder to keep what it compiles.
        return None
    return kernel
