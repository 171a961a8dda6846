"""Uniform random draws, made in blocks, because generators are fastest when they fill an array."""

from typing import Any, Protocol

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from babyrobot_levels.envs.engine.tables import Floats, Ints, Tables

NONE = -1
"""Marks that no half of a word is left over."""

MOST_WORDS = 10
"""The most words that an environment takes in a step.

One for its outcome, one for its next level, one for its start. The rest is for halves that `below`
rejects, each with a probability of usually one in billions.
"""

_HALF = 2**32


class Draws(Protocol):
    """A source of randomness. Draws are made ahead of their use.

    Attributes:
        memory: the draws, as the compiled loops read them.
        position: how many draws of `memory` have been used, if environments share them.
    """

    memory: NDArray[Any]
    position: int

    def reserve(self) -> None:
        """Make sure that there are draws for a step."""

    def enlarge(self, most: int) -> None:
        """Make room for so many draws in a step."""

    def uniform(self, which: Ints) -> Floats:
        """Return a draw for each of these environments, from 0 up to but not including 1."""

    def starts(self, which: Ints, level: Ints, tables: Tables) -> Ints:
        """Draw a start for each of these environments, after its level if levels are drawn.

        Args:
            which: the indices of the environments.
            level: intp `[envs]`: the levels of all environments; drawn levels are written into it.
            tables: the tables of the levels.

        Returns:
            An index into the tables' `starts` for each of them.
        """


class SharedDraws:
    """Draws that environments take one after the other from one generator.

    Attributes:
        memory: float64 `[draws]`, from 0 up to but not including 1.
        position: how many of them have been used.
    """

    def __init__(self, source: Generator, most: int) -> None:
        """Reserve memory for the draws of a step.

        Args:
            source: the generator.
            most: how many draws a step takes at most.
        """
        self.memory = np.empty(max(1024, 2 * most) if most else 0)
        self.position = self.memory.size
        self._source = source
        self._last = self.memory.size - most

    def reserve(self) -> None:
        """Make sure that there are draws for a step."""
        if self.position > self._last:
            left = self.memory.size - self.position
            self.memory[:left] = self.memory[self.position :].copy()
            self._source.random(out=self.memory[left:])
            self.position = 0

    def enlarge(self, most: int) -> None:
        """Make room for so many draws in a step; those that were made come first."""
        made = self.memory[self.position :].copy()
        if most > self.memory.size - self._last:
            self.memory = np.empty(max(1024, 2 * most, made.size + most))
            self.position = self.memory.size - made.size
            self.memory[self.position :] = made
            self._last = self.memory.size - most
            self.reserve()

    def take(self, count: int) -> Floats:
        """Return the next draws, `[count]`, as a view."""
        begin = self.position
        self.position = begin + count
        return self.memory[begin : self.position]

    def uniform(self, which: Ints) -> Floats:
        """Return a draw for each of these environments, from 0 up to but not including 1."""
        begin = self.position
        self.position = end = begin + which.size
        return self.memory[begin:end]

    def starts(self, which: Ints, level: Ints, tables: Tables) -> Ints:
        """Draw starts; see `Draws`. If any level has several starts, all environments draw one."""
        drawn = self.take(which.size * tables.draws_per_reset).reshape(which.size, -1)
        if tables.draws_levels:
            level[which] = drawn[:, 0] * tables.limit.size
        here = level.take(which)
        start: Ints = tables.first_start.take(here)
        if tables.draws_starts:
            count = tables.first_start.take(here + 1) - start
            start += (drawn[:, -1] * count).astype(np.intp)
        return start


class OwnDraws:
    """Draws that each environment takes from a generator of its own.

    The words of a generator are used exactly as NumPy's `Generator` of PCG64 uses them: for
    `random()` when an action has several outcomes or a level is drawn, and for `integers(count)`
    to choose one of several starts. Single environments make the same calls.

    Attributes:
        memory: int64 `[envs, 2 + words]`, for each environment: the column of the next word; half
            a word that is left over from the last choice, or `NONE`; and words of 64 bits.
    """

    def __init__(self, num_envs: int) -> None:
        """Reserve memory for the words of each environment."""
        # Two kilobytes for each of few environments, about eight megabytes for many.
        words = min(256, max(4 * MOST_WORDS, 2**20 // num_envs))
        self.memory: NDArray[Any] = np.empty((num_envs, 2 + words), np.int64)
        self.position = 0
        self._sources: dict[int, Generator] = {}
        self._steps_left = 0

    def follow(self, number: int, source: Generator) -> None:
        """Give an environment this generator, a new one of PCG64."""
        self._sources[number] = source
        self.memory[number, :2] = self.memory.shape[1], NONE
        self._steps_left = 0

    def reserve(self) -> None:
        """Make sure that there are words for a step."""
        self._steps_left -= 1
        if self._steps_left >= 0:
            return
        width = self.memory.shape[1]
        column = self.memory[:, 0]
        for number in (column > width - MOST_WORDS).nonzero()[0].tolist():
            row, used = self.memory[number], int(column[number])
            left = 2 + width - used
            row[2:left] = row[used:].copy()
            row[left:] = self._sources[number].bit_generator.random_raw(width - left).view(np.int64)
            row[0] = 2
        self._steps_left = (width - int(column.max())) // MOST_WORDS - 1

    def enlarge(self, most: int) -> None:
        """Do nothing: there is always room for `MOST_WORDS` of each environment."""

    def uniform(self, which: Ints) -> Floats:
        """Return a draw for each of these environments, from 0 up to but not including 1."""
        words = self._words(which).view(np.uint64)
        return (words >> np.uint64(11)).astype(np.float64) * 2.0**-53

    def below(self, which: Ints, count: Ints) -> NDArray[np.int64]:
        """Return a uniform whole number below its `count` for each of these environments."""
        number = np.zeros(which.size, np.int64)
        # Where there is no choice, nothing is drawn.
        asking = (count > 1).nonzero()[0]
        while asking.size:
            product = self._halves(which[asking]) * count[asking]
            number[asking] = product // _HALF
            # Smaller remainders are rejected, because they would favour some numbers.
            asking = asking[product % _HALF < _HALF % count[asking]]
        return number

    def starts(self, which: Ints, level: Ints, tables: Tables) -> Ints:
        """Draw starts; see `Draws`. Where a level has one start, none is drawn."""
        if tables.draws_levels:
            level[which] = self.uniform(which) * tables.limit.size
        here = level.take(which)
        start: Ints = tables.first_start.take(here)
        start += self.below(which, tables.first_start.take(here + 1) - start)
        return start

    def _words(self, which: Ints) -> NDArray[np.int64]:
        """Take a word for each of these environments."""
        column = self.memory[which, 0]
        self.memory[which, 0] = column + 1
        words: NDArray[np.int64] = self.memory[which, column]
        return words

    def _halves(self, which: Ints) -> NDArray[np.int64]:
        """Take half a word for each of these environments: the lower half, then the upper one."""
        half: NDArray[np.int64] = self.memory[which, 1]
        without = half == NONE
        words = self._words(which[without])
        half[without] = words % _HALF
        self.memory[which, 1] = NONE
        self.memory[which[without], 1] = words >> 32 & (_HALF - 1)
        return half
