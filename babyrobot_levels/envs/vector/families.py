"""Levels that are made when an episode begins in them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from babyrobot_levels.envs.single import MAX_MAZE_SEED
from babyrobot_levels.generate.suites import Suite
from babyrobot_levels.library.level import Level


class Family(Protocol):
    """Levels, each of which is made from its number alone.

    All have the same limit of steps, and the same number of starts.
    """

    word: str
    """What `info` calls the number of a level."""
    option: str
    """What the option of `reset` is called that asks for a number."""
    count: int
    """Numbers are drawn from 0 up to but not including this."""
    kept: int
    """How many levels to keep at most, because they may come again."""
    largest: tuple[int, int]
    """The largest width and height of a level, in cells."""
    levels: Sequence[Level]
    """The levels, as they were given."""

    def level(self, number: int) -> Level:
        """Return the level of a number."""


class SuiteLevels:
    """The levels of a suite, or of a part of it."""

    word = "level_index"
    option = "index"

    def __init__(self, suite: Suite) -> None:
        self.levels: Sequence[Level] = suite
        self.largest = suite.largest
        self.count = self.kept = len(suite)

    def level(self, number: int) -> Level:
        """Return a level by its number in the suite, or in the part of it."""
        return self.levels[number]


class GrownMazes:
    """The mazes of a level that grows another one each time."""

    word = option = "maze_seed"
    count = MAX_MAZE_SEED
    kept = 0

    def __init__(self, level: Level) -> None:
        self.levels: Sequence[Level] = (level,)
        self.largest = level.size

    def level(self, number: int) -> Level:
        """Return the level with the maze that grows from a seed."""
        return self.levels[0].with_maze_seed(number)
