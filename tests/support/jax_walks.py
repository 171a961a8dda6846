"""Walks through levels in JAX and with the NumPy engine, both from the same words."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import jax
import numpy as np
from numpy.typing import NDArray

import babyrobot_levels as brl
from babyrobot_levels.envs.engine.tables import Tables

_ALL = [brl.load(info.name) for info in brl.levels()]
GALLERY = [
    level for level in _ALL if not level.has_random_maze and not level.robots and level.moves == 4
]
"""All levels of the gallery that have one maze, and one robot with four moves."""

KINGS = [level for level in _ALL if level.moves == 8]
"""The levels of the gallery whose robot moves diagonally."""

SEVERAL_STARTS = brl.Level.from_fields(
    {
        "version": 1,
        "size": [4, 3],
        "start": [[0, 0], [2, 1], [3, 0]],
        "exit": [3, 2],
        "puddles": [{"at": [1, 1], "size": "large"}],
    }
)
"""A level with several starts, and no time limit."""

POOL = [*GALLERY, SEVERAL_STARTS]


@contextmanager
def bits_64() -> Iterator[None]:
    """Let JAX have numbers of 64 bits."""
    before = jax.config.read("jax_enable_x64")
    jax.config.update("jax_enable_x64", True)
    try:
        yield
    finally:
        jax.config.update("jax_enable_x64", before)


class WordDraws:
    """In the place of the NumPy engine's draws: words, in the order in which JAX takes them."""

    def __init__(self) -> None:
        self.memory, self.position = np.empty(0), 0
        self._outcome: NDArray[np.float64] = np.empty(0)
        self._reset: NDArray[np.float64] = np.empty((0, 0))

    def give(self, words: Any, step_words: int) -> None:
        """Give the words of a step, uint32 `[envs, words]`: those of the step, then the reset."""
        draws = np.asarray(words) / 2.0**32
        self._outcome, self._reset = draws[:, 0] if step_words else draws, draws[:, step_words:]

    def reserve(self) -> None:
        """Do nothing."""

    def enlarge(self, most: int) -> None:
        """Do nothing."""

    def uniform(self, which: Any) -> Any:
        """Return the draws for outcomes."""
        return self._outcome[which]

    def starts(self, which: Any, level: Any, tables: Tables) -> Any:
        """Draw levels and starts."""
        draws = self._reset[which]
        if tables.draws_levels:
            level[which] = draws[:, 0] * tables.limit.size
        first = tables.first_start[level[which]]
        if not tables.draws_starts:
            return first
        count = tables.first_start[level[which] + 1] - first
        return first + (draws[:, -1] * count).astype(np.intp)
