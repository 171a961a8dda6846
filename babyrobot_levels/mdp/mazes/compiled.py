"""Depth-first mazes as machine code, where Numba is installed and gains more than it costs."""

from collections.abc import Sequence
from functools import cache
from importlib import import_module
from types import ModuleType

WORTH_LOADING = 500_000
"""So many cells are carved in plain Python in about the time that loading the kernel takes."""

_asked_for = 0


def depth_first(
    width: int, height: int, blocked: bytes, start: int, seed: int
) -> tuple[bytes, int] | None:
    """Return a maze's open sides, row by row, and how many words of 32 bits were drawn for it.

    It is None where plain Python has to do: without Numba (the extra `fast`), and in a process
    that has not asked for enough mazes yet to make up for loading.
    """
    kernel = _kernel_for(width * height)
    if kernel is None:
        return None
    seed = abs(seed)
    length = 4 * max(1, (seed.bit_length() + 31) // 32)
    sides = bytearray(width * height)
    key = seed.to_bytes(length, "little")
    words = kernel.depth_first(width, height, blocked, start, key, sides)
    return bytes(sides), words


def depth_first_many(
    width: int, height: int, blocked: bytes, start: int, seeds: Sequence[int]
) -> list[bytes] | None:
    """Return the open sides of the mazes of many seeds, twice as fast as one by one.

    It is None where `depth_first` would be, and for seeds of more than 64 bits.
    """
    keys = [abs(seed) for seed in seeds]
    size = width * height
    if max(keys, default=0) >> 64:
        return None
    kernel = _kernel_for(size * len(keys))
    if kernel is None:
        return None
    import numpy as np

    sides = bytearray(size * len(keys))
    kernel.depth_first_many(width, height, blocked, start, np.array(keys, np.uint64), sides)
    return [bytes(sides[begin : begin + size]) for begin in range(0, len(sides), size)]


def _kernel_for(cells: int) -> ModuleType | None:
    """Return the kernel if so many more cells justify loading it."""
    global _asked_for
    if _asked_for < WORTH_LOADING:
        _asked_for += cells
        if _asked_for < WORTH_LOADING:
            return None
    return load("babyrobot_levels.mdp.mazes.kernel")


@cache
def load(kernel: str) -> ModuleType | None:
    """Return a module of loops, None without Numba, which keeps what it compiles for others."""
    try:
        import numba

        return None if numba.config.DISABLE_JIT else import_module(kernel)  # type: ignore[attr-defined]
    except (ImportError, RuntimeError):
        # Numba raises the latter where it finds no folder to keep what it compiles.
        return None
