"""The next levels of environments: drawn ones, mazes that are grown, and exchanged ones."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.envs.samplers import UniformSampler, sampled
from babyrobot_levels.envs.single import MAX_MAZE_SEED

if TYPE_CHECKING:
    from babyrobot_levels.envs.engine.draws import Draws
    from babyrobot_levels.envs.engine.tables import Ints
    from babyrobot_levels.envs.samplers import Sampler
    from babyrobot_levels.library.level import Level

Numbers = NDArray[np.int64]


class Family(Protocol):
    """Levels that are made from their numbers."""

    @property
    def key(self) -> str:
        """The name of a level's number in infos."""

    @property
    def option(self) -> str | None:
        """The name of the option of `reset` that selects a number, None for no option."""

    @property
    def count(self) -> int:
        """Numbers are below this."""

    @property
    def kept(self) -> int:
        """How many levels to keep at most for later episodes."""

    @property
    def most_starts(self) -> int:
        """The most starts of a level, as far as it is known."""

    @property
    def levels(self) -> Sequence[Level]:
        """The levels, as they were given."""

    def level(self, number: int) -> Level:
        """Return the level of a number."""

    def next_numbers(self, which: Ints, draws: Draws) -> Numbers:
        """Return the number of the next level of each of these environments, int64 `[which]`."""


class DrawnLevels:
    """A suite, a part of it, or a list of levels; a sampler selects the level of each episode."""

    key, option = "level_index", "index"

    def __init__(self, levels: Sequence[Level], sampler: Sampler, most_starts: int) -> None:
        self.levels, self._sampler = levels, sampler
        self.count = self.kept = len(levels)
        self.most_starts = most_starts

    def level(self, number: int) -> Level:
        """Return a level by its number in the suite, or in the part of it."""
        return self.levels[number]

    def next_numbers(self, which: Ints, draws: Draws) -> Numbers:
        """Return numbers that the sampler selects."""
        return sampled(self._sampler, draws.uniform(which), self.count)


class GrownMazes:
    """The mazes of a level with `maze: {seed: random}`."""

    key = option = "maze_seed"
    count = MAX_MAZE_SEED
    kept = 0

    def __init__(self, level: Level) -> None:
        self.levels: Sequence[Level] = (level,)
        self.most_starts = 1

    def level(self, number: int) -> Level:
        """Return the level with the maze of a seed."""
        return self.levels[0].with_maze_seed(number)

    def next_numbers(self, which: Ints, draws: Draws) -> Numbers:
        """Return seeds, drawn uniformly."""
        return UniformSampler(self.count).sample(draws.uniform(which))


class ExchangedLevels:
    """Levels that environments keep until they are given others.

    The number of a level is its place in `levels`. Numbers that no environment has any more are
    given to new levels, so that there are never more than two for each environment.
    """

    key, option = "level_index", None

    def __init__(self, levels: Sequence[Level], level: Ints) -> None:
        """Keep the levels that environments have: `level`, intp `[envs]`, is the number of each."""
        self.levels: Sequence[Level] = tuple(levels)
        self.next_level = level.astype(np.int64)
        self.most_starts = 1

    @property
    def count(self) -> int:
        """How many numbers there are."""
        return len(self.levels)

    @property
    def kept(self) -> int:
        """All levels."""
        return len(self.levels)

    def level(self, number: int) -> Level:
        """Return a level."""
        return self.levels[number]

    def next_numbers(self, which: Ints, draws: Draws) -> Numbers:
        """Return the numbers of the levels that the environments were given."""
        return self.next_level[which]

    def exchange(self, levels: Sequence[Level], which: Ints, playing: Numbers) -> list[int]:
        """Give levels to environments, from their next episodes on.

        Args:
            levels: the level of each of these environments.
            which: the indices of the environments.
            playing: int64 `[envs]`: the numbers of the levels in which episodes are.

        Returns:
            The numbers that stand for other levels than before.
        """
        staying = np.delete(self.next_level, which)
        busy = {*playing.tolist(), *staying.tolist()}
        known = [*self.levels]
        number_of = {id(known[number]): number for number in busy}
        free = iter([number for number in range(len(known)) if number not in busy])
        changed = []
        for level in levels:
            if id(level) not in number_of:
                number = next(free, len(known))
                if number == len(known):
                    known.append(level)
                known[number] = level
                number_of[id(level)] = number
                changed.append(number)
        self.levels = tuple(known)
        self.next_level[which] = [number_of[id(level)] for level in levels]
        return changed
