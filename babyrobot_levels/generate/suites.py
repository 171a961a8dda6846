"""Suites: sequences of generated levels."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, overload

from babyrobot_levels.generate.candidates import Maker
from babyrobot_levels.generate.locks import GUARD_CELLS
from babyrobot_levels.generate.search import find_level
from babyrobot_levels.language.documents import check_suite, suite_from_mapping
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.language.ranges import bounds
from babyrobot_levels.language.suite import SuiteFields
from babyrobot_levels.library.catalogue import find_suite
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.emitter import emit
from babyrobot_levels.text.reader import open_document
from babyrobot_levels.text.words import did_you_mean


class Suite(Sequence[Level]):
    """The levels of a suite, or some of them.

    `suite[i]` is generated from the suite's seed and the level's number alone, and is the same
    in every version. A slice is a suite, too.

    Args:
        fields: the fields of the suite.
        folder: the folder that may have `themes/` in it.
        numbers: the numbers of the levels; all of them by default.
        split: the split that they are, if any.
    """

    __module__ = "babyrobot_levels"

    def __init__(
        self,
        fields: SuiteFields,
        folder: Path | None = None,
        numbers: range | None = None,
        split: str | None = None,
    ) -> None:
        self.fields, self.folder = fields, folder
        self.numbers = range(fields.count) if numbers is None else numbers
        self._split = split
        self._maker = Maker(fields, name_pattern(fields), folder)

    @property
    def name(self) -> str | None:
        """The suite's name."""
        return self.fields.name

    @property
    def splits(self) -> tuple[str, ...]:
        """The names of the splits."""
        return tuple(self.fields.splits)

    @property
    def largest(self) -> tuple[int, int]:
        """The largest width and height of the levels, in cells."""
        return self.fields.largest

    @property
    def most_items(self) -> int:
        """The most items that a level can have."""
        return int(bounds(self.fields.keys)[1] + bounds(self.fields.coins)[1])

    @property
    def has_guards(self) -> bool:
        """Whether a level can have guards."""
        return bool(bounds(self.fields.guards)[1])

    @property
    def radices(self) -> tuple[int, ...]:
        """For each thing that a level can have, the most values that it can have in any level.

        They are in the order of `Things.radices`. In a level with fewer items, guards come earlier.
        """
        fewest = bounds(self.fields.keys)[0] + bounds(self.fields.coins)[0]
        most, guards = self.most_items, bounds(self.fields.guards)[1]
        held_or_not, phases = 2, 2 * (max(GUARD_CELLS) - 1)
        return (
            *(phases if guards and item >= fewest else held_or_not for item in range(most)),
            *(phases for _ in range(guards)),
        )

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
            return Suite(self.fields, self.folder, self.numbers[index], self._split)
        try:
            number = self.numbers[index]
        except IndexError:
            raise IndexError(f"there is no level {index}: the suite has {len(self):,}") from None
        return find_level(self._maker, number).level

    def __iter__(self) -> Iterator[Level]:
        return (self[index] for index in range(len(self)))

    def split(self, name: str) -> Suite:
        """Return the levels of a split. No maze occurs in two splits.

        Raises:
            ValueError: the suite has no such split.
        """
        parts = self._maker.splits
        if name not in parts:
            known = ", ".join(map(repr, parts)) or "none"
            raise ValueError(
                f"there is no split {name!r} (there are: {known}){did_you_mean(str(name), parts)}"
            )
        if not self._is_whole:
            raise ValueError("a slice of a suite has no splits")
        return Suite(self.fields, self.folder, parts[name], name)

    @property
    def _is_whole(self) -> bool:
        return self.numbers == range(self.fields.count)

    def to_arguments(self) -> dict[str, Any] | None:
        """Return the arguments of environments, `suite` and maybe `split`, as plain data.

        None for a slice, which cannot be given by them.
        """
        if self._is_whole:
            return {"suite": self.to_dict(whole=True)}
        if self._split is not None and self.numbers == self._maker.splits[self._split]:
            return {"suite": self.to_dict(whole=True), "split": self._split}
        return None

    def to_dict(self, *, whole: bool = False) -> dict[str, Any]:
        """Return the fields of the suite as plain data.

        Args:
            whole: whether to include a theme from a file, so that the data does not depend on it.
        """
        data: dict[str, Any] = plain(self.fields)
        if whole and "theme" in data:
            level = {"version": 1, "size": [2, 1], "theme": data["theme"]}
            data["theme"] = Level.from_fields(level, folder=self.folder).to_dict(whole=True)[
                "theme"
            ]
        return {name: data[name] for name in SuiteFields.model_fields if name in data}

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
        return (self.fields, self.numbers) == (other.fields, other.numbers)

    def __reduce__(self) -> tuple[type[Suite], tuple[Any, ...]]:
        return Suite, (self.fields, self.folder, self.numbers, self._split)


def load_suite(suite: str | os.PathLike[str] | Mapping[str, Any] | Suite) -> Suite:
    """Return a suite.

    Args:
        suite: a name (`"small-mazes"`), the path of a file, a mapping of the fields of a suite,
            or a suite, which is returned unchanged.

    Raises:
        SuiteNotFoundError: nothing has that name; the error names the nearest ones.
        LevelError: the suite is found, but not valid.
    """
    if isinstance(suite, Suite):
        return suite
    if isinstance(suite, Mapping):
        return Suite(suite_from_mapping(suite))
    if not isinstance(suite, str | os.PathLike):
        raise TypeError(
            f"a suite is a name, a path, a mapping or a Suite, not {type(suite).__name__}"
        )
    path = find_suite(suite)
    return Suite(check_suite(open_document(path), path).valid(), path.parent)


def name_pattern(fields: SuiteFields) -> str:
    """Return the pattern of the levels' names: the suite's name and their number."""
    return f"{fields.name or 'level'}-{{index:05}}"
