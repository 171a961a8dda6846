"""Uniform draws, made in blocks: generators are fastest when they fill an array."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from numpy.random import Generator


class Draws:
    """Draws from a generator, in its order, each used once.

    They are made ahead of time: a generator has then gone further than what was used.

    Attributes:
        block: float64 `[draws]`, from 0 up to but not including 1.
        position: how many draws of the block have been used.
    """

    def __init__(self, most: int) -> None:
        """Make room for the draws of a step.

        Args:
            most: how many of them one call of `reserve` asks for at most.
        """
        self.block = np.empty(max(1024, 2 * most) if most else 0)
        self.position = self.block.size
        self._source: Generator | None = None

    def reserve(self, source: Generator, count: int) -> None:
        """See to it that the block holds `count` draws that are not used yet.

        Another generator than that of the last time begins anew.
        """
        if source is not self._source:
            self._source, self.position = source, self.block.size
        left = self.block.size - self.position
        if left < count:
            self.block[:left] = self.block[self.position :].copy()
            source.random(out=self.block[left:])
            self.position = 0

    def take(self, count: int) -> NDArray[np.float64]:
        """Return the next draws, `[count]`, of those that were reserved, as a view."""
        begin = self.position
        self.position = begin + count
        return self.block[begin : self.position]
