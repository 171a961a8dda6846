"""Where suites have their levels from: mazes that are grown, or levels that are listed."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, groupby
from math import prod
from operator import itemgetter
from pathlib import Path
from typing import Any, Protocol, Self

import numpy as np

from babyrobot_levels.generation.candidates import Maker
from babyrobot_levels.generation.locks import GUARD_CELLS
from babyrobot_levels.generation.search import find_level
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.language.suite import SuiteFields, bounds
from babyrobot_levels.language.suite_list import AnySuite, SuiteListFields
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.configurations import MAX_STATES, largest_radices
from babyrobot_levels.suites.members import Member

Numbers = range | tuple[int, ...]
"""Numbers of levels, all rising or all falling."""

Groups = tuple[tuple[int, float], ...]
"""Levels one after the other: how many there are, and the weight of each of them."""

_HEX_DIGITS = 13
"""How many digits of a digest decide on its split: 52 bits, which a float has exactly."""


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
    """

    size: tuple[int, int] = (0, 0)
    radices: tuple[int, ...] = ()
    configurations: int = 1
    num_items: int = 0
    num_starts: int = 1
    has_movers: bool = False
    has_wind: bool = False

    @classmethod
    def of(cls, level: Level) -> Self:
        """Return the bounds of one level."""
        has_wind = level.wind is not None
        if not level.has_things:
            return cls(level.size, num_starts=len(level.starts), has_wind=has_wind)
        mdp = level.compile()
        return cls(
            level.size,
            level.things().radices,
            mdp.num_configurations,
            len(level.items),
            int(np.count_nonzero(mdp.start)),
            bool(level.movers),
            has_wind,
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
            )
        return joined


class Others(Protocol):
    """What a listed suite asks of another `Suite` in it, or of a part of one."""

    @property
    def max_steps(self) -> int | None:
        """The time limit of all levels."""

    @property
    def bounds(self) -> Bounds:
        """How much a level has at most."""

    @property
    def groups(self) -> Groups:
        """The weights of the levels."""

    def __len__(self) -> int: ...

    def __getitem__(self, index: int) -> Level: ...

    def whole(self) -> Self:
        """Return the suite of which this is a part."""

    def to_dict(self, *, whole: bool = False) -> dict[str, Any]:
        """Return the fields."""


class Source(Protocol):
    """The levels of a whole suite, by their numbers from 0 on.

    Attributes:
        count: how many levels there are.
        max_steps: the time limit of all of them, None for none.
    """

    count: int
    max_steps: int | None

    @property
    def bounds(self) -> Bounds:
        """How much the levels have at most."""

    @property
    def groups(self) -> Groups:
        """The weights of the levels."""

    def level(self, number: int) -> Level:
        """Return a level."""

    def part(self, split: str) -> Numbers:
        """Return the numbers of the levels of a split, which the suite has."""

    def whole_fields(self) -> dict[str, Any]:
        """Return the fields that are different where the data must not depend on files."""


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
        return Bounds(
            fields.largest,
            radices,
            configurations,
            num_items=most,
            has_movers=guards > 0,
            has_wind=bounds(fields.wind)[1] > 0,
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
        whole = Level.from_fields(level, folder=self._folder).to_dict(whole=True)
        return {"theme": whole["theme"]}

    def __eq__(self, other: object) -> bool:
        return isinstance(other, GrownLevels) and self._fields == other._fields

    __hash__ = None  # type: ignore[assignment]


class ListedLevels:
    """Levels that a suite lists, one entry after the other.

    Args:
        fields: the fields of the suite.
        entries: for each entry, what it lists, and its levels.
    """

    def __init__(
        self, fields: SuiteListFields, entries: Sequence[tuple[Member, Others | None]]
    ) -> None:
        self._fields, self._entries = fields, entries
        self._parts: list[tuple[Level, ...] | Others] = [
            member.levels if suite is None else suite for member, suite in entries
        ]
        self._ends = [*accumulate(len(part) for part in self._parts)]
        self.count = self._ends[-1]
        self.max_steps = fields.max_steps or self._longest()
        self._own: dict[tuple[int, int], Level] = {}

    def _longest(self) -> int | None:
        limits: list[int | None] = []
        for member, suite in self._entries:
            limits += [level.max_steps for level in member.levels]
            limits += [] if suite is None else [suite.max_steps]
        return None if None in limits else max(limit for limit in limits if limit is not None)

    @cached_property
    def bounds(self) -> Bounds:
        """How much a level has at most."""
        return Bounds.joined(
            bounds
            for member, suite in self._entries
            for bounds in ([suite.bounds] if suite else map(Bounds.of, member.levels))
        )

    @property
    def groups(self) -> Groups:
        """The levels of each entry, and their weights."""
        found: list[tuple[int, float]] = []
        for (member, suite), part in zip(self._entries, self._parts, strict=True):
            groups: Groups = ((len(part), 1.0),) if suite is None else suite.groups
            total = sum(count * weight for count, weight in groups)
            scale = (len(part) if member.weight is None else member.weight) / total
            found += [(count, weight * scale) for count, weight in groups]
        same = groupby(found, itemgetter(1))
        return tuple((sum(count for count, _ in each), weight) for weight, each in same)

    def level(self, number: int) -> Level:
        """Return a level, with the time limit of the suite."""
        place = bisect_right(self._ends, number)
        index = number - (self._ends[place - 1] if place else 0)
        level = self._parts[place][index]
        if level.max_steps == self.max_steps:
            return level
        other = level.model_copy(update={"max_steps": self.max_steps})
        # Of another suite, levels are made when they are asked for, and not kept.
        return other if self._entries[place][1] else self._own.setdefault((place, index), other)

    def part(self, split: str) -> tuple[int, ...]:
        """Return the numbers of a split: those whose digests are in its share of all digests."""
        return self._splits[split]

    @cached_property
    def _splits(self) -> dict[str, tuple[int, ...]]:
        names = [*self._fields.splits]
        ends = [*accumulate(self._fields.splits.values())][:-1]
        found: dict[str, list[int]] = {name: [] for name in names}
        for number in range(self.count):
            place = digest_share(self.level(number).digest)
            found[names[bisect_right(ends, place)]].append(number)
        return {name: tuple(numbers) for name, numbers in found.items()}

    def whole_fields(self) -> dict[str, Any]:
        """Return the entries, with the fields of all levels."""
        entries: list[dict[str, Any]] = []
        for member, suite in self._entries:
            weight = member.weight
            if suite is not None:
                given = {"split": member.split, "count": member.count, "weight": weight}
                stated = {name: value for name, value in given.items() if value is not None}
                entries.append({"suite": suite.whole().to_dict(whole=True), **stated})
            for level in member.levels:
                share = {} if weight is None else {"weight": weight / len(member.levels)}
                entries.append({"level": level.to_dict(whole=True), **share})
        named = {} if self._fields.name is None else {"name": self._fields.name}
        return {"levels": entries, **named}

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, ListedLevels):
            return False
        mine, theirs = (
            (each.max_steps, each._fields.splits, each.groups, each._flat())
            for each in (self, other)
        )
        return mine == theirs

    __hash__ = None  # type: ignore[assignment]

    def _flat(self) -> list[dict[str, Any] | Others]:
        """Return the fields of the levels that are listed, and the other suites."""
        found: list[dict[str, Any] | Others] = []
        for member, suite in self._entries:
            found += [level.to_dict(whole=True) for level in member.levels]
            found += [] if suite is None else [suite]
        return found


def digest_share(digest: str) -> float:
    """Return the place of a digest among all digests, from 0 up to but not including 1."""
    share: float = int(digest.rpartition(":")[2][:_HEX_DIGITS], 16) / 16**_HEX_DIGITS
    return share


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
