"""Suites: sequences of levels that are generated or listed."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, overload

from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.language.suite import SuiteFields
from babyrobot_levels.language.suite_list import AnySuite
from babyrobot_levels.library.catalogue import find_suite
from babyrobot_levels.library.level import Level
from babyrobot_levels.suites.members import (
    Member,
    OpenedSuite,
    open_suite,
    suite_of_mapping,
)
from babyrobot_levels.suites.sources import (
    Bounds,
    Groups,
    GrownLevels,
    ListedLevels,
    Numbers,
    Source,
    groups_of,
)
from babyrobot_levels.text.emitter import emit
from babyrobot_levels.text.words import did_you_mean


class Suite(Sequence[Level]):
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

    __module__ = "babyrobot_levels"

    def __init__(
        self,
        fields: AnySuite,
        folder: Path | None = None,
        numbers: Numbers | None = None,
        split: str | None = None,
        members: Sequence[Member] = (),
    ) -> None:
        self.fields, self.folder = fields, folder
        self._members, self._split = members, split
        self._source = _source_of(fields, folder, members)
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
    def radices(self) -> tuple[int, ...]:
        """For each thing that a level can have, the most values that it can have in any level.

        They are in the order of `Things.radices`.
        """
        return self.bounds.radices

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
            UnsatisfiableError: no level meets the suite's conditions.
        """
        if isinstance(index, slice):
            return self._part(self.numbers[index], self._split)
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
        parts = self.splits
        if name not in parts:
            known = ", ".join(map(repr, parts)) or "none"
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


def _source_of(fields: AnySuite, folder: Path | None, members: Sequence[Member]) -> Source:
    if isinstance(fields, SuiteFields):
        return GrownLevels(fields, folder)
    return ListedLevels(fields, [(member, _suite_in(member)) for member in members])


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
    if not isinstance(suite, str | os.PathLike):
        raise TypeError(
            f"a suite is a name, a path, a mapping or a Suite, not {type(suite).__name__}"
        )
    return _suite_of(open_suite(find_suite(suite)))
