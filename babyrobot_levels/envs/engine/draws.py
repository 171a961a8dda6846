"""Uniform draws, made in blocks: generators are fastest when they fill an array."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from numpy.random import Generator

    from babyrobot_levels.envs.engine.tables import Floats, Ints, Tables

NONE = -1
"""In the place of half a word: none is left over."""

MOST_WORDS = 10
"""How many words a robot takes in a step at most.

One for its outcome, one for its next level, one for the start there. The rest is for halves that
`below` throws away, each with a probability of mostly one in billions.
"""

_HALF = 2**32


class Draws(Protocol):
    """Where chance comes from. They are made ahead of time: generators have gone further.

    Attributes:
        memory: what has been drawn, as the compiled loops read it.
        position: how many draws of `memory` have been used, if robots share them.
    """

    memory: NDArray[Any]
    position: int

    def reserve(self) -> None:
        """See to it that there are draws for a step."""

    def uniform(self, which: Ints) -> Floats:
        """Return a draw for each of these robots, from 0 up to but not including 1."""

    def starts(self, which: Ints, level: Ints, tables: Tables) -> Ints:
        """Draw where robots begin: for each its level, into `level`, and then its start.

        Returns:
            Which of the tables' `starts` each of them has.
        """


class SharedDraws:
    """Draws that robots take one after the other from one generator, each used once.

    Attributes:
        memory: float64 `[draws]`, from 0 up to but not including 1.
        position: how many of them have been used.
    """

    def __init__(self, source: Generator, most: int) -> None:
        """Make room for the draws of a step.

        Args:
            source: the generator.
            most: how many draws a step takes at most.
        """
        self.memory = np.empty(max(1024, 2 * most) if most else 0)
        self.position = self.memory.size
        self._source = source
        self._last = self.memory.size - most

    def reserve(self) -> None:
        """See to it that there are draws for a step."""
        if self.position > self._last:
            left = self.memory.size - self.position
            self.memory[:left] = self.memory[self.position :].copy()
            self._source.random(out=self.memory[left:])
            self.position = 0

    def take(self, count: int) -> Floats:
        """Return the next draws, `[count]`, as a view."""
        begin = self.position
        self.position = begin + count
        return self.memory[begin : self.position]

    def uniform(self, which: Ints) -> Floats:
        """Return a draw for each of these robots, from 0 up to but not including 1."""
        begin = self.position
        self.position = end = begin + which.size
        return self.memory[begin:end]

    def starts(self, which: Ints, level: Ints, tables: Tables) -> Ints:
        """Draw where robots begin; see `Draws`. If any level has several starts, all draw one."""
        drawn = self.take(which.size * tables.draws_to_begin).reshape(which.size, -1)
        if tables.draws_levels:
            level[which] = drawn[:, 0] * tables.limit.size
        here = level.take(which)
        start: Ints = tables.first_start.take(here)
        if tables.draws_starts:
            count = tables.first_start.take(here + 1) - start
            start += (drawn[:, -1] * count).astype(np.intp)
        return start


class OwnDraws:
    """Draws that each robot takes from a generator of its own.

    What is used of a generator's words, and how, is what a NumPy `Generator` of PCG64 does that is
    asked for `random()` when an action has several outcomes or a level is drawn, and for
    `integers(count)` to choose one of several starts, as single environments ask for it.

    Attributes:
        memory: int64 `[robots, 2 + words]`, for each robot: the column of the next word; half a
            word that is left over from the last choice, or `NONE`; and words of 64 bits.
    """

    def __init__(self, num_robots: int) -> None:
        """Make room for the words of each robot."""
        # Two kilobytes for each of few robots, about eight megabytes for many.
        words = min(256, max(4 * MOST_WORDS, 2**20 // num_robots))
        self.memory: NDArray[Any] = np.empty((num_robots, 2 + words), np.int64)
        self.position = 0
        self._sources: dict[int, Generator] = {}
        self._steps_left = 0

    def follow(self, number: int, source: Generator) -> None:
        """Have a robot draw from this generator, a new one of PCG64, from now on."""
        self._sources[number] = source
        self.memory[number, :2] = self.memory.shape[1], NONE
        self._steps_left = 0

    def reserve(self) -> None:
        """See to it that there are words for a step."""
        self._steps_left -= 1
        if self._steps_left >= 0:
            return
        width = self.memory.shape[1]
        column = self.memory[:, 0]
        for number in (column > width - MOST_WORDS).nonzero()[0].tolist():
            row, used = self.memory[number], int(column[number])
            left = 2 + width - used
            row[2:left] = row[used:].copy()
            words = self._sources[number].bit_generator.random_raw(width - left)
            row[left:] = words.view(np.int64)
            row[0] = 2
        self._steps_left = (width - int(column.max())) // MOST_WORDS - 1

    def uniform(self, which: Ints) -> Floats:
        """Return a draw for each of these robots, from 0 up to but not including 1."""
        words = self._words(which).view(np.uint64)
        return (words >> np.uint64(11)).astype(np.float64) * 2.0**-53

    def below(self, which: Ints, count: Ints) -> NDArray[np.int64]:
        """Return a whole number below its `count` for each of these robots, all equally likely."""
        number = np.zeros(which.size, np.int64)
        # Where there is no choice, nothing is drawn.
        asking = (count > 1).nonzero()[0]
        while asking.size:
            product = self._halves(which[asking]) * count[asking]
            number[asking] = product // _HALF
            # The rest of the products below this would favour some numbers.
            asking = asking[product % _HALF < _HALF % count[asking]]
        return number

    def starts(self, which: Ints, level: Ints, tables: Tables) -> Ints:
        """Draw where robots begin; see `Draws`. Where a level has one start, none is drawn."""
        if tables.draws_levels:
            level[which] = self.uniform(which) * tables.limit.size
        here = level.take(which)
        start: Ints = tables.first_start.take(here)
        start += self.below(which, tables.first_start.take(here + 1) - start)
        return start

    def _words(self, which: Ints) -> NDArray[np.int64]:
        """Take a word for each of these robots."""
        column = self.memory[which, 0]
        self.memory[which, 0] = column + 1
        words: NDArray[np.int64] = self.memory[which, column]
        return words

    def _halves(self, which: Ints) -> NDArray[np.int64]:
        """Take half a word for each of these robots: first lower halves, then the upper ones."""
        half: NDArray[np.int64] = self.memory[which, 1]
        without = half == NONE
        words = self._words(which[without])
        half[without] = words % _HALF
        self.memory[which, 1] = NONE
        self.memory[which[without], 1] = words >> 32 & (_HALF - 1)
        return half
