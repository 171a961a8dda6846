"""Batches of levels: generated in one process or in several, and written as files."""

from __future__ import annotations

import json
import re
import signal
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from hashlib import sha256
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

from babyrobot_levels.generate.candidates import Maker
from babyrobot_levels.generate.search import Found, UnsatisfiableError, find_level
from babyrobot_levels.language.base import SLUG
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.language.suite import SuiteFields, split_ranges
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.errors import BabyRobotError
from babyrobot_levels.text.files import SUFFIXES, write_text

if TYPE_CHECKING:
    from concurrent.futures import Future
    from multiprocessing.synchronize import Event

    _Chunks = deque[Future[list["Made | UnsatisfiableError"]]]

FORMAT_VERSION = 1
"""Increases when the same options would generate other files."""

DEFAULT_NAMES = "level-{index:05}"

_NAMES = re.compile(r"([a-z0-9-]*)\{index(:0[1-9])?\}([a-z0-9-]*)")
_HEADER = re.compile(r"# Level (\d+) of the order ([0-9a-f]{12}), try (\d+):\n")
_FOR_PEOPLE = ("name", "title", "description", "author", "license", "source", "tags")


@dataclass(frozen=True)
class Batch:
    """Levels to generate.

    Attributes:
        suite: what the levels are like, and how many there are.
        names: their names: a text with `{index}` or `{index:05}` in it.
        description: one line that describes the batch, for its files.
        excluded: the digests of levels that must not be among them.
        first: the index of the first level in its name and title.
        title: their titles, a text that may have `{index}` in it; None for no titles.
    """

    suite: SuiteFields
    names: str
    description: str
    excluded: frozenset[str] = field(default_factory=frozenset)
    first: int = 0
    title: str | None = None

    @cached_property
    def mark(self) -> str:
        """Twelve hex digits that identify the batch in its files."""
        stated = {
            name: value for name, value in plain(self.suite).items() if name not in _FOR_PEOPLE
        }
        if not self.suite.splits:
            # Level 7 is the same of ten levels and of a thousand.
            stated.pop("count")
        whole = [FORMAT_VERSION, stated, self.names, sorted(self.excluded)]
        if self.first or self.title is not None:
            whole += [self.first, self.title]
        return sha256(json.dumps(whole, sort_keys=True).encode("utf-8")).hexdigest()[:12]

    def maker(self) -> Maker:
        """Return the maker of the levels."""
        return Maker(self.suite, self.names, first=self.first)

    def name(self, number: int) -> str:
        """Return the name of a level, which is that of its file."""
        return self.names.format(index=self.first + number)

    def text(self, number: int, attempt: int, level: Level) -> str:
        """Return the text of a level's file, with comments that say how it was generated."""
        if self.title is not None:
            title = self.title.format(index=self.first + number)
            level = level.model_copy(update={"title": title})
        # `origin_of` reads these words in files of all versions.
        return (
            f"# Level {number} of the order {self.mark}, try {attempt}:\n"
            f"# {self.description}\n{level.to_yaml()}"
        )


def origin_of(text: str) -> tuple[str, int, int] | None:
    """Return the mark of the batch, the number and the attempt of a generated file, else None."""
    match = _HEADER.match(text)
    return (match[2], int(match[1]), int(match[3])) if match else None


def is_title(title: str) -> bool:
    """Return whether a text is a pattern of titles: at most `{index}` is in braces."""
    return not re.search(r"[{}]", re.sub(r"\{index(:0[1-9])?\}", "", title)) and bool(title.strip())


def is_pattern(names: str) -> bool:
    """Return whether a text is a pattern of names that differ for each index."""
    return bool(_NAMES.fullmatch(names)) and bool(re.fullmatch(SLUG, names.format(index=0)))


Task = tuple[int, int | None]
"""A level's number, and the attempt that is known to be it, if any."""

CHUNK = 16
AHEAD = 4
"""The number of chunks per process that wait to be worked on."""


@dataclass(frozen=True, slots=True)
class Made:
    """A generated level: its number, its attempt, the text of its file, and its digest."""

    number: int
    attempt: int
    text: str
    digest: str


def made_levels(batch: Batch, tasks: Sequence[Task], jobs: int) -> Iterator[Made]:
    """Yield the levels of a batch, in the order of the tasks, without duplicates.

    Args:
        batch: the levels to generate.
        tasks: all levels, from number 0 on.
        jobs: the number of processes. The result does not depend on it.

    Raises:
        UnsatisfiableError: no level meets the conditions. The ones before it have been yielded.
    """
    maker = batch.maker()
    digests = set(batch.excluded)
    each = _alone(batch, maker, tasks) if jobs <= 1 else _spread(batch, tasks, jobs)
    for made in each:
        if isinstance(made, UnsatisfiableError):
            raise made
        if made.digest in digests:
            found = find_level(
                maker,
                made.number,
                first=made.attempt + 1,
                is_new=lambda level: level.digest not in digests,
            )
            made = _written(batch, found)
        digests.add(made.digest)
        yield made


def _alone(
    batch: Batch, maker: Maker, tasks: Sequence[Task]
) -> Iterator[Made | UnsatisfiableError]:
    return (_make(batch, maker, task) for task in tasks)


def _spread(batch: Batch, tasks: Sequence[Task], jobs: int) -> Iterator[Made | UnsatisfiableError]:
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor

    stop = multiprocessing.Event()
    chunks = (tasks[first : first + CHUNK] for first in range(0, len(tasks), CHUNK))
    with ProcessPoolExecutor(jobs, initializer=_begin, initargs=(batch, stop)) as pool:
        try:
            waiting: _Chunks = deque(pool.submit(_work, c) for c in islice(chunks, jobs * AHEAD))
            while waiting:
                made = waiting.popleft().result()
                waiting.extend(pool.submit(_work, chunk) for chunk in islice(chunks, 1))
                yield from made
        finally:
            stop.set()
            pool.shutdown(cancel_futures=True)


_worker: tuple[Batch, Maker, Event]
"""The state of a worker process."""


def _begin(batch: Batch, stop: Event) -> None:
    global _worker
    # Ctrl-C is for the process that writes files; it stops the others by the event.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _worker = batch, batch.maker(), stop


def _work(tasks: Sequence[Task]) -> list[Made | UnsatisfiableError]:
    batch, maker, stop = _worker
    made: list[Made | UnsatisfiableError] = []
    for task in tasks:
        if stop.is_set():
            break
        made.append(_make(batch, maker, task))
    return made


def _make(batch: Batch, maker: Maker, task: Task) -> Made | UnsatisfiableError:
    number, attempt = task
    if attempt is not None:
        return _written(batch, Found(number, attempt, maker.draw(number, attempt).level))
    try:
        return _written(batch, find_level(maker, number))
    except UnsatisfiableError as error:
        return error


def _written(batch: Batch, found: Found) -> Made:
    text = batch.text(found.number, found.attempt, found.level)
    return Made(found.number, found.attempt, text, found.level.digest)


HEAD = 200
"""The number of characters at the beginning of a file that hold its origin."""


class FolderError(BabyRobotError):
    """The folder holds files that must not be overwritten. `help` says what to do."""

    def __init__(self, message: str, help_text: str):
        self.help = help_text
        super().__init__(message)


@dataclass(frozen=True)
class Target:
    """The folder that a batch is written to, with a folder inside for each split.

    Attributes:
        batch: the levels to generate.
        folder: the folder.
        resume: whether to keep levels of this batch that exist.
        force: whether to overwrite files.
    """

    batch: Batch
    folder: Path
    resume: bool = False
    force: bool = False

    @cached_property
    def _folders(self) -> dict[range, Path]:
        splits = split_ranges(self.batch.suite)
        if not splits:
            return {range(self.batch.suite.count): self.folder}
        return {numbers: self.folder / name for name, numbers in splits.items()}

    def sizes(self) -> dict[str, int]:
        """Return the number of levels in each split; empty without splits."""
        return {name: len(part) for name, part in split_ranges(self.batch.suite).items()}

    def path(self, number: int) -> Path:
        """Return the path of a level's file."""
        folder = next(path for numbers, path in self._folders.items() if number in numbers)
        return folder / f"{self.batch.name(number)}.yaml"

    def there(self) -> int:
        """Return how many of the files exist."""
        return sum(self.path(number).exists() for number in range(self.batch.suite.count))

    def tasks(self) -> list[Task]:
        """Return the task for each level.

        Raises:
            FolderError: there are files that must not be overwritten.
        """
        heads = {path: _head(path) for folder in self._folders.values() for path in _files(folder)}
        if not self.force:
            self._check(heads)
        tasks: list[Task] = []
        for number in range(self.batch.suite.count):
            origin = origin_of(heads.get(self.path(number), "")) if self.resume else None
            is_ours = origin is not None and origin[:2] == (self.batch.mark, number)
            tasks.append((number, origin[2] if origin is not None and is_ours else None))
        return tasks

    def _check(self, heads: dict[Path, str]) -> None:
        paths = map(self.path, range(self.batch.suite.count))
        there = [path for path in paths if path in heads or path.exists()]
        for path, head in heads.items():
            origin = origin_of(head)
            if origin is not None and origin[0] != self.batch.mark:
                raise FolderError(
                    f"{path} was generated with other options",
                    "choose another folder, or use --force to write into this one",
                )
        strange = [path for path in there if origin_of(heads.get(path, "")) is None]
        if strange:
            raise FolderError(
                f"{strange[0]} already exists and was not generated",
                "choose another folder, or use --force to overwrite it",
            )
        if there and not self.resume:
            raise FolderError(
                f"{self.folder} already contains {len(there):,} of these levels",
                "use --resume to generate the missing ones, or --force to overwrite all",
            )

    def write(self, jobs: int = 1) -> Iterator[bool]:
        """Generate all levels, in order, and write the missing ones.

        Files are written atomically and one after the other.

        Args:
            jobs: the number of processes. The files do not depend on it.

        Yields:
            For each level whether it was written; if not, it existed already.

        Raises:
            FolderError: there are files that must not be overwritten.
            UnsatisfiableError: no level meets the conditions. The ones before it are written.
            OSError: a file cannot be written.
        """
        for made in made_levels(self.batch, self.tasks(), jobs):
            path, is_there = self.path(made.number), False
            if self.resume:
                with suppress(OSError, UnicodeDecodeError):
                    is_there = path.read_text(encoding="utf-8") == made.text
            if not is_there:
                if self.resume and not self.force and path.exists():
                    raise FolderError(
                        f"{path} differs from the generated level",
                        "remove it, or use --force to overwrite it",
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
