"""The extent of levels that share a space of observations: the most that any of them has."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import prod
from typing import Self

from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import HEADINGS
from babyrobot_levels.mdp.configurations import MAX_STATES, largest_radices

Size = tuple[int, int]
"""Width and height in cells."""


@dataclass(frozen=True, slots=True)
class Extent:
    """How much the levels have that share a space of observations, and a way to move.

    Attributes:
        size: the largest width and height, in cells.
        radices: how many values a thing has: in each column of configurations the most of any
            level, for as many columns as the level with the most things has.
        configurations: the most configurations of a level.
        headings: 4 with `actions="turns"`, where states have a heading, else 1.
        has_items: whether a level has items: pictures then have a row below the cells for what is
            held.
        has_wind: whether a level has wind.
    """

    size: Size
    radices: tuple[int, ...] = ()
    configurations: int = 1
    headings: int = 1
    has_items: bool = False
    has_wind: bool = False

    @classmethod
    def of(cls, levels: Iterable[Level], *, turns: bool = False) -> Self:
        """Return the extent of some levels, at least one.

        A level whose mazes grow at resets counts as having all configurations that its things
        could have.

        Args:
            levels: the levels.
            turns: whether the robot turns.
        """
        size, configurations, has_items, has_wind = (0, 0), 1, False, False
        radices: tuple[int, ...] = ()
        for level in levels:
            size = max(size[0], level.size[0]), max(size[1], level.size[1])
            has_items = has_items or bool(level.items)
            has_wind = has_wind or level.wind is not None
            if level.has_things:
                radices = largest_radices(radices, level.things().radices)
                configurations = max(configurations, _configurations(level))
        headings = HEADINGS if turns else 1
        return cls(size, radices, configurations, headings, has_items, has_wind)

    @property
    def picture(self) -> Size:
        """The width and height of the largest picture, in cells."""
        return self.size[0], self.size[1] + self.has_items

    @property
    def cells(self) -> int:
        """The number of cells of a level of the largest width and height."""
        return self.size[0] * self.size[1]

    @property
    def has_things(self) -> bool:
        """Whether a level has things."""
        return bool(self.radices)


def _configurations(level: Level) -> int:
    if level.has_random_maze:
        return min(prod(level.things().radices), MAX_STATES // prod(level.size))
    return level.compile().num_configurations
