"""The files of an order: what is there already, what is written, and in which folders."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from babyrobot_levels.generate.order import Order, origin_of
from babyrobot_levels.generate.workers import Task, made_levels
from babyrobot_levels.language.suite import split_ranges
from babyrobot_levels.text.errors import BabyRobotError
from babyrobot_levels.text.files import SUFFIXES, write_text

HEAD = 200
"""So many characters at the beginning of a file say of which order it is."""


class FolderError(BabyRobotError):
    """The folder holds files that must not be written over. `help` says what can be done."""

    def __init__(self, message: str, help_text: str):
        self.help = help_text
        super().__init__(message)


@dataclass(frozen=True)
class Target:
    """Where the levels of an order go: a folder, with one inside for each split.

    Attributes:
        order: what is ordered.
        folder: where to.
        resume: whether levels of this order that are there stay as they are.
        force: whether files that are there are written over.
    """

    order: Order
    folder: Path
    resume: bool = False
    force: bool = False

    @cached_property
    def _folders(self) -> dict[range, Path]:
        splits = split_ranges(self.order.suite)
        if not splits:
            return {range(self.order.suite.count): self.folder}
        return {numbers: self.folder / name for name, numbers in splits.items()}

    def sizes(self) -> dict[str, int]:
        """Return how many levels each split has, empty if there are none."""
        return {name: len(part) for name, part in split_ranges(self.order.suite).items()}

    def path(self, number: int) -> Path:
        """Return a level's file."""
        folder = next(path for numbers, path in self._folders.items() if number in numbers)
        return folder / f"{self.order.names.format(index=number)}.yaml"

    def there(self) -> int:
        """Return how many of the files are there."""
        return sum(self.path(number).exists() for number in range(self.order.suite.count))

    def tasks(self) -> list[Task]:
        """Return what there is to do for each level, and which of them are there.

        Raises:
            FolderError: there are files that must not be written over.
        """
        heads = {path: _head(path) for folder in self._folders.values() for path in _files(folder)}
        if not self.force:
            self._check(heads)
        tasks: list[Task] = []
        for number in range(self.order.suite.count):
            origin = origin_of(heads.get(self.path(number), "")) if self.resume else None
            is_ours = origin is not None and origin[:2] == (self.order.mark, number)
            tasks.append((number, origin[2] if origin is not None and is_ours else None))
        return tasks

    def _check(self, heads: dict[Path, str]) -> None:
        paths = map(self.path, range(self.order.suite.count))
        there = [path for path in paths if path in heads or path.exists()]
        for path, head in heads.items():
            origin = origin_of(head)
            if origin is not None and origin[0] != self.order.mark:
                raise FolderError(
                    f"{path} is a level of another order ({origin[0]}; this one is "
                    f"{self.order.mark})",
                    "choose another folder, or write into this one with --force",
                )
        strange = [path for path in there if origin_of(heads.get(path, "")) is None]
        if strange:
            raise FolderError(
                f"{strange[0]} is there already, and not of this order",
                "choose another folder, or write it anew with --force",
            )
        if there and not self.resume:
            raise FolderError(
                f"{len(there):,} level{'s' * (len(there) != 1)} of this order "
                f"{'are' if len(there) != 1 else 'is'} in {self.folder} already",
                "--resume makes what is missing, --force writes all of them anew",
            )

    def write(self, jobs: int = 1) -> Iterator[bool]:
        """Make all levels, in order, and write those that are missing.

        Each file is written whole or not at all, and no later one before it.

        Args:
            jobs: the number of processes; the files do not depend on it.

        Yields:
            For each level whether it was written; if not, it is there already.

        Raises:
            FolderError: there are files that must not be written over.
            StarvedError: no level meets the conditions. Those before it are written.
            OSError: a file cannot be written.
        """
        for made in made_levels(self.order, self.tasks(), jobs):
            path, is_there = self.path(made.number), False
            if self.resume:
                with suppress(OSError, UnicodeDecodeError):
                    is_there = path.read_text(encoding="utf-8") == made.text
            if not is_there:
                if self.resume and not self.force and path.exists():
                    raise FolderError(
                        f"{path} is not what this order gives",
                        "take it away, or write it anew with --force",
                    )
                write_text(path, made.text, sync=False)
            yield not is_there


def _files(folder: Path) -> Iterator[Path]:
    if folder.is_dir():
        yield from (path for path in sorted(folder.iterdir()) if path.suffix in SUFFIXES)


def _head(path: Path) -> str:
    try:
        with path.open("rb") as file:
            return file.read(HEAD).decode("utf-8", errors="replace")
    except OSError:
        return ""
