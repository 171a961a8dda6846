"""Suites: sequences of levels that are generated or listed; what levels and suites are named by."""

from __future__ import annotations

import os
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import accumulate, groupby
from operator import itemgetter
from pathlib import Path
from typing import Any, overload

from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.language.share_code import is_code
from babyrobot_levels.language.suite import SuiteFields
from babyrobot_levels.language.suite_list import AnySuite, SuiteListFields
from babyrobot_levels.library.catalogue import (
    LevelLike,
    find_suite,
    folder_named,
    is_suite_file,
    level_path,
    suite_path,
)
from babyrobot_levels.library.level import Level
from babyrobot_levels.library.search_path import yaml_files
from babyrobot_levels.suites.members import Member, OpenedSuite, open_suite, suite_of_mapping
from babyrobot_levels.suites.sources import Bounds, Groups, GrownLevels, Numbers, groups_of
from babyrobot_levels.text.emitter import emit
from babyrobot_levels.text.files import is_folder
from babyrobot_levels.text.words import Telling, did_you_mean

_HEX_DIGITS = 13
"""How many digits of a digest decide on its split: 52 bits, which a float has exactly."""


class Suite(Telling, Sequence[Level], public=True):
    """The levels of a suite, or some of them.

    Of a suite that grows mazes, `suite[i]` is generated from the suite's seed and the level's
    number alone, and is the same in every version. A suite that lists levels has them one after
    the other. A slice is a suite, too.

    Args:
        fields: the fields of the suite.
        folder: the folder that may have `themes/` in it.
        numbers: the numbers of the levels; all of them by default.
        split: the split that they are, if any.
        members: what the suite lists, if it lists levels.
    """

    def __init__(
        self,
        fields: AnySuite,
        folder: Path | None = None,
        numbers: Numbers | None = None,
        split: str | None = None,
        members: Sequence[Member] = (),
    ) -> None:
        if not isinstance(fields, SuiteFields | SuiteListFields):
            raise TypeError(f"a suite is loaded by `brl.load_suite({fields!r})`")
        self.fields, self.folder = fields, folder
        self._members, self._split = members, split
        self._source: GrownLevels | ListedLevels
        if isinstance(fields, SuiteFields):
            self._source = GrownLevels(fields, folder)
        else:
            self._source = ListedLevels(fields, [(each, _suite_in(each)) for each in members])
        self.numbers: Numbers = range(self._source.count) if numbers is None else numbers

    @property
    def name(self) -> str | None:
        """The suite's name."""
        return self.fields.name

    @property
    def splits(self) -> tuple[str, ...]:
        """The names of the splits."""
        return tuple(self.fields.splits)

    @property
    def max_steps(self) -> int | None:
        """The time limit of all levels, in steps; None for none.

        Of a suite that lists levels and states none, the largest limit of its levels.
        """
        return self._source.max_steps

    @property
    def bounds(self) -> Bounds:
        """How much a level can have at most, in the whole suite."""
        return self._source.bounds

    @property
    def largest(self) -> tuple[int, int]:
        """The largest width and height of the levels, in cells."""
        return self.bounds.size

    @property
    def most_items(self) -> int:
        """The most items that a level can have."""
        return self.bounds.num_items

    @property
    def has_guards(self) -> bool:
        """Whether a level can have guards, or other movers."""
        return self.bounds.has_movers

    @property
    def groups(self) -> Groups:
        """How many levels follow one another, and the weight of each: how often it is drawn."""
        return groups_of(self._source.groups, self.numbers)

    def __len__(self) -> int:
        return len(self.numbers)

    @overload
    def __getitem__(self, index: int) -> Level: ...

    @overload
    def __getitem__(self, index: slice) -> Suite: ...

    def __getitem__(self, index: int | slice) -> Level | Suite:
        """Return a level, or a suite for a slice.

        Raises:
            IndexError: there is no such level.
            TypeError: it is a text, such as the name of a split.
            UnsatisfiableError: no level meets the suite's conditions.
        """
        if isinstance(index, slice):
            return self._part(self.numbers[index], self._split)
        if isinstance(index, str):
            raise TypeError(f"levels have numbers; `suite.split({index!r})` has those of a split")
        try:
            number = self.numbers[index]
        except IndexError:
            raise IndexError(f"there is no level {index}: the suite has {len(self):,}") from None
        return self._source.level(number)

    def __iter__(self) -> Iterator[Level]:
        return (self[index] for index in range(len(self)))

    def split(self, name: str) -> Suite:
        """Return the levels of a split.

        No maze occurs in two splits of a suite that grows mazes, and no MDP in two splits of one
        that lists levels: there, the digest of a level decides to which split it belongs.

        Raises:
            ValueError: the suite has no such split, or no level is in it.
        """
        if name not in (parts := self.splits):
            if not parts:
                raise ValueError(f"there is no split {name!r}: the suite has none")
            known = ", ".join(map(repr, parts))
            raise ValueError(
                f"there is no split {name!r} (there are: {known}){did_you_mean(str(name), parts)}"
            )
        if not self._is_whole:
            raise ValueError("a slice of a suite has no splits")
        numbers = self._source.part(name)
        if not numbers:
            raise ValueError(
                f"the split {name!r} is empty: none of the {len(self):,} levels is in it; "
                "add levels, or change the shares"
            )
        return self._part(numbers, name)

    def split_sizes(self) -> dict[str, int]:
        """Return how many levels each split of the whole suite has, also of empty ones."""
        return {name: len(self._source.part(name)) for name in self.splits}

    def whole(self) -> Suite:
        """Return the suite of which this one is a part."""
        return self._part(range(self._source.count), None)

    def _part(self, numbers: Numbers, split: str | None) -> Suite:
        part = Suite.__new__(Suite)
        part.__dict__ |= {**self.__dict__, "numbers": numbers, "_split": split}
        return part

    @property
    def _is_whole(self) -> bool:
        return self.numbers == range(self._source.count)

    def to_arguments(self) -> dict[str, Any] | None:
        """Return the arguments of environments, `suite` and maybe `split`, as plain data.

        None for a slice, which cannot be given by them.
        """
        if self._is_whole:
            return {"suite": self.to_dict(whole=True)}
        if self._split is not None and self.numbers == self._source.part(self._split):
            return {"suite": self.to_dict(whole=True), "split": self._split}
        return None

    def to_dict(self, *, whole: bool = False) -> dict[str, Any]:
        """Return the fields of the suite as plain data.

        Args:
            whole: whether to include a theme from a file, and the fields of all levels that are
                listed, so that the data does not depend on files.
        """
        data: dict[str, Any] = plain(self.fields)
        if whole:
            data |= self._source.whole_fields()
        return {name: data[name] for name in type(self.fields).model_fields if name in data}

    def to_yaml(self) -> str:
        """Return the suite as canonical YAML."""
        return emit(self.to_dict())

    def __repr__(self) -> str:
        name = "" if self.name is None else f" {self.name!r}"
        part = "" if self._split is None else f", split {self._split!r}"
        return f"<Suite{name}: {len(self):,} levels{part}>"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Suite):
            return NotImplemented
        return self.numbers == other.numbers and self._source == other._source

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[type[Suite], tuple[Any, ...]]:
        return Suite, (self.fields, self.folder, self.numbers, self._split, self._members)


class ListedLevels:
    """Levels that a suite lists, one entry after the other.

    Args:
        fields: the fields of the suite.
        entries: for each entry, what it lists, and its levels.
    """

    def __init__(
        self, fields: SuiteListFields, entries: Sequence[tuple[Member, Suite | None]]
    ) -> None:
        self._fields, self._entries = fields, entries
        self._parts: list[tuple[Level, ...] | Suite] = [
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
            found[names[bisect_right(ends, digest_share(self.level(number).digest))]].append(number)
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

    def _flat(self) -> list[dict[str, Any] | Suite]:
        """Return the fields of the levels that are listed, and the other suites."""
        found: list[dict[str, Any] | Suite] = []
        for member, suite in self._entries:
            found += [level.to_dict(whole=True) for level in member.levels]
            found += [] if suite is None else [suite]
        return found


def digest_share(digest: str) -> float:
    """Return the place of a digest among all digests, from 0 up to but not including 1."""
    share: float = int(digest.rpartition(":")[2][:_HEX_DIGITS], 16) / 16**_HEX_DIGITS
    return share


def _suite_in(member: Member) -> Suite | None:
    """Return the levels of another suite that an entry stands for."""
    if member.suite is None:
        return None
    suite = _suite_of(member.suite)
    part = suite if member.split is None else suite.split(member.split)
    return part if member.count is None else part[: member.count]


def _suite_of(opened: OpenedSuite) -> Suite:
    return Suite(opened.fields, opened.folder, members=opened.members)


def load_suite(suite: str | os.PathLike[str] | Mapping[str, Any] | Suite) -> Suite:
    """Return a suite.

    Args:
        suite: a name (`"small-mazes"`), the path of a file, a mapping of the fields of a suite,
            or a suite, which is returned unchanged.

    Raises:
        SuiteNotFoundError: nothing has that name; the error names the nearest ones.
        LevelError: the suite is found, but not valid, or something that it lists is not.
        ValueError: the suite lists a split of another one that has no levels.
    """
    if isinstance(suite, Suite):
        return suite
    if isinstance(suite, Mapping):
        return _suite_of(suite_of_mapping(suite))
    return _suite_of(open_suite(find_suite(suite)))


# -- what levels are named by ------------------------------------------------------------------

Levels = LevelLike | Suite | Iterable[LevelLike]
"""A level, several, or what `named_levels` finds by a name or a path."""


def named_levels(levels: Levels) -> Suite | Iterable[LevelLike]:
    """Return a suite, or what `load` takes for each level.

    Args:
        levels: the name, the path, or a mapping of a level or a suite; the path of a folder of
            level files; the name of a pack; a `Level`, a `Suite`, or several levels, which are
            returned unchanged.

    Raises:
        LevelNotFoundError: nothing has that name; the error names the nearest ones.
        LevelError: it is a suite, and not valid.
        ValueError: there are no level files in the folder.
        OSError: the folder cannot be read.
    """
    if isinstance(levels, Mapping):
        return load_suite(levels) if levels.get("kind") == "suite" else [levels]
    if isinstance(levels, Level):
        return [levels]
    if not isinstance(levels, str | os.PathLike):
        # What is no level, `load` refuses.
        return levels if isinstance(levels, Iterable) else [levels]
    if isinstance(levels, str) and is_code(levels):
        return [levels]
    if (suite := suite_path(levels)) is not None:
        return load_suite(suite)
    folder = folder_named(levels)
    if folder is None:
        return [level_path(levels)]
    # The files of packs may be links: some installers of packages make them so.
    is_pack = not is_folder(Path(levels)) and not str(levels).startswith("~")
    found = yaml_files(folder, all_of_them=not is_pack)
    files = [path for path in found if not is_suite_file(path)]
    if not files:
        raise ValueError(f"no level files (.yaml) in {levels}")
    return files
