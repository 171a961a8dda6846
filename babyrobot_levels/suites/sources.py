"""Where suites have their levels from: mazes that are grown, or levels that are listed."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import dataclass
from math import comb, prod
from pathlib import Path
from typing import Any, Self

import numpy as np

from babyrobot_levels.generation.candidates import Maker
from babyrobot_levels.generation.locks import GUARD_CELLS
from babyrobot_levels.generation.search import find_level
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.language.ranges import bounds
from babyrobot_levels.language.suite import SuiteFields
from babyrobot_levels.language.suite_list import AnySuite
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import NUM_MOVES
from babyrobot_levels.mdp.configurations import MAX_STATES, largest_radices

Numbers = range | tuple[int, ...]
"""Numbers of levels, all rising or all falling."""

Groups = tuple[tuple[int, float], ...]
"""Levels one after the other: how many there are, and the weight of each of them."""


@dataclass(frozen=True, slots=True)
class Bounds:
    """How much levels have at most.

    Attributes:
        size: the largest width and height, in cells.
        radices: for each thing that a level can have, the most values that it can have in any
            level, in the order of `Things.radices`.
        configurations: the most configurations.
        num_items: the most items.
        num_starts: the most starts.
        has_movers: whether a level can have movers.
        has_wind: whether a level can have wind.
        has_boxes: whether a level can have boxes or targets.
        moves: the most directions in which a robot moves.
    """

    size: tuple[int, int] = (0, 0)
    radices: tuple[int, ...] = ()
    configurations: int = 1
    num_items: int = 0
    num_starts: int = 1
    has_movers: bool = False
    has_wind: bool = False
    has_boxes: bool = False
    moves: int = NUM_MOVES

    @classmethod
    def of(cls, level: Level) -> Self:
        """Return the bounds of one level."""
        has_wind = level.wind is not None
        if not level.has_things:
            starts = sum(level.weights_of_starts)
            return cls(level.size, num_starts=starts, has_wind=has_wind, moves=level.moves)
        mdp = level.compile()
        return cls(
            level.size,
            level.things().radices,
            mdp.num_configurations,
            len(level.items),
            int(np.count_nonzero(mdp.start)),
            bool(level.movers),
            has_wind,
            bool(level.boxes or level.targets),
            level.moves,
        )

    @classmethod
    def joined(cls, parts: Iterable[Bounds]) -> Self:
        """Return the bounds of all levels together."""
        joined = cls()
        for part in parts:
            joined = cls(
                (max(joined.size[0], part.size[0]), max(joined.size[1], part.size[1])),
                largest_radices(joined.radices, part.radices),
                max(joined.configurations, part.configurations),
                max(joined.num_items, part.num_items),
                max(joined.num_starts, part.num_starts),
                joined.has_movers or part.has_movers,
                joined.has_wind or part.has_wind,
                joined.has_boxes or part.has_boxes,
                max(joined.moves, part.moves),
            )
        return joined


class GrownLevels:
    """Levels that are generated from the seed of the suite and their number.

    Args:
        fields: the fields of the suite.
        folder: the folder that may have `themes/` in it.
    """

    def __init__(self, fields: SuiteFields, folder: Path | None) -> None:
        self._fields, self._folder = fields, folder
        self._maker = Maker(fields, name_pattern(fields), folder)
        self.count, self.max_steps = fields.count, fields.max_steps

    @property
    def bounds(self) -> Bounds:
        """How much a level can have at most; in one with fewer items, guards come earlier."""
        fields = self._fields
        items = [bounds(getattr(fields, name)) for name in ("keys", "coins")]
        fewest, most = (int(sum(ends)) for ends in zip(*items, strict=True))
        guards = int(bounds(fields.guards)[1])
        held_or_not, phases = 2, 2 * (max(GUARD_CELLS) - 1)
        radices = (
            *(phases if guards and item >= fewest else held_or_not for item in range(most)),
            *(phases for _ in range(guards)),
        )
        configurations = min(prod(radices), MAX_STATES // prod(bounds(fields.size)[0]))
        boxes, cells = int(bounds(fields.boxes)[1]), prod(fields.largest)
        if boxes:
            # In a level with fewer boxes, targets come earlier.
            radices, configurations = (cells,) * boxes + (2,) * boxes, comb(cells, boxes)
        return Bounds(
            fields.largest,
            radices,
            configurations,
            num_items=most,
            has_movers=guards > 0,
            has_wind=bounds(fields.wind)[1] > 0,
            has_boxes=boxes > 0,
        )

    @property
    def groups(self) -> Groups:
        """All levels have the same weight."""
        return ((self.count, 1.0),)

    def level(self, number: int) -> Level:
        """Return a level.

        Raises:
            UnsatisfiableError: no level meets the suite's conditions.
        """
        return find_level(self._maker, number).level

    def part(self, split: str) -> range:
        """Return the numbers of a split: consecutive ones."""
        return self._maker.splits[split]

    def whole_fields(self) -> dict[str, Any]:
        """Return the theme, which may be a file."""
        theme = self._fields.theme
        if "theme" not in self._fields.model_fields_set:
            return {}
        level = {"version": 1, "size": [2, 1], "theme": plain(theme)}
        return {"theme": Level.from_fields(level, folder=self._folder).to_dict(whole=True)["theme"]}

    def __eq__(self, other: object) -> bool:
        return isinstance(other, GrownLevels) and self._fields == other._fields

    __hash__ = None  # type: ignore[assignment]


def groups_of(groups: Groups, numbers: Numbers) -> Groups:
    """Return the groups that some of the levels have, in their order."""
    if len(numbers) > 1 and numbers[0] > numbers[-1]:
        return groups_of(groups, numbers[::-1])[::-1]
    found, end, before = [], 0, 0
    for count, weight in groups:
        end += count
        after = bisect_right(numbers, end - 1)
        if after > before:
            found.append((after - before, weight))
        before = after
    return tuple(found)


def name_pattern(fields: AnySuite) -> str:
    """Return the pattern of the levels' names: the suite's name and their number."""
    return f"{fields.name or 'level'}-{{index:05}}"
