"""What suites list: the levels of names, files, folders and packs, and other suites.

Files of strangers are read: a suite names files in its own folder only, and everything that it
lists is counted, at whatever depth.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Any

from babyrobot_levels.language.checks import MAX_PROBLEMS
from babyrobot_levels.language.documents import check_suite, error_in_mapping, suite_from_mapping
from babyrobot_levels.language.share_code import is_code
from babyrobot_levels.language.suite import SuiteFields, split_ranges
from babyrobot_levels.language.suite_list import MAX_ENTRIES, AnySuite, SuiteEntry, SuiteListFields
from babyrobot_levels.library.catalogue import find, find_suite, is_suite_file, load
from babyrobot_levels.library.level import Level, load_file
from babyrobot_levels.library.search_path import (
    GALLERY,
    Place,
    gallery_place,
    pack_places,
    yaml_files,
)
from babyrobot_levels.text.diagnostics import Issue, Route
from babyrobot_levels.text.errors import LevelError, LevelNotFoundError
from babyrobot_levels.text.files import (
    MAX_DEPTH,
    PACK_FILE,
    SUFFIXES,
    is_file,
    is_folder,
    is_within,
    nearest_files,
)
from babyrobot_levels.text.reader import open_document
from babyrobot_levels.text.words import did_you_mean, shortened

MAX_NESTING = 8
"""How deep suites can be nested."""

MAX_DIGESTS = 10_000
"""Of so many grown levels, splits compute the digests, which takes about ten seconds."""


@dataclass(frozen=True, slots=True)
class Member:
    """An entry of a suite with its levels, or with the other suite that it is.

    Attributes:
        levels: the levels, empty for another suite.
        suite: the other suite.
        split: the split of it, None for all its levels.
        count: how many levels of it, None for all.
        weight: the weight of all the levels together, None for their number.
    """

    levels: tuple[Level, ...] = ()
    suite: OpenedSuite | None = None
    split: str | None = None
    count: int | None = None
    weight: float | None = None


@dataclass(frozen=True, slots=True)
class OpenedSuite:
    """A suite with everything that it lists.

    Attributes:
        fields: its fields.
        folder: the folder of its file, None if it has none.
        members: what it lists; empty if it grows mazes.
    """

    fields: AnySuite
    folder: Path | None = None
    members: tuple[Member, ...] = ()

    @property
    def most_grown(self) -> int:
        """How many levels it grows at most, in suites at whatever depth."""
        if isinstance(self.fields, SuiteFields):
            return self.fields.count
        return sum(_most_grown(member) for member in self.members)


def open_suite(path: Path) -> OpenedSuite:
    """Return the suite of a file.

    Raises:
        LevelError: it is not valid, or something that it lists is not.
    """
    document = open_document(path)
    opened, issues = _Opener(path).suite(check_suite(document, path).valid(), path.parent)
    if issues:
        raise LevelError([document.diagnostic(issue) for issue in issues])
    return opened


def suite_of_mapping(data: Mapping[str, Any]) -> OpenedSuite:
    """Return the suite of a mapping of its fields; files are looked for in the current folder.

    Raises:
        LevelError: it is not valid, or something that it lists is not.
    """
    opened, issues = _Opener().suite(suite_from_mapping(data), None)
    if issues:
        raise error_in_mapping(data, issues)
    return opened


def member_issues(fields: AnySuite, path: Path | None) -> list[Issue]:
    """Return what is wrong with what a suite lists, which `path` is the file of."""
    return _Opener(path).suite(fields, path.parent if path is not None else None)[1]


def _most_grown(member: Member) -> int:
    suite = member.suite
    if suite is None:
        return 0
    grown = suite.most_grown
    if isinstance(suite.fields, SuiteFields):
        if member.split is not None:
            grown = len(split_ranges(suite.fields)[member.split])
        return min(grown, member.count or grown)
    return grown


class _UnusableError(Exception):
    """What is wrong with one entry."""

    def __init__(self, code: str, message: str, help_text: str | None = None) -> None:
        self.code, self.message, self.help = code, message, help_text
        super().__init__(message)


class _Opener:
    """Opens a suite, and the suites in it.

    Attributes:
        left: how many more levels and suites may be listed.
    """

    def __init__(self, path: Path | None = None) -> None:
        self.left = MAX_ENTRIES
        self._levels: dict[Path, Level] = {}
        # Names are looked for in many files, and may be listed many times.
        self._found = cache(_found)
        self._around: list[Path] = [] if path is None else [path]

    def suite(self, fields: AnySuite, folder: Path | None) -> tuple[OpenedSuite, list[Issue]]:
        """Return a suite with everything that it lists, and what is wrong with that."""
        if isinstance(fields, SuiteFields):
            return OpenedSuite(fields, folder), []
        members: list[Member] = []
        issues: list[Issue] = []
        own = _own_pack(folder)
        for number, entry in enumerate(fields.entries()):
            try:
                members.append(self._member(entry, folder or Path(), own))
            except _UnusableError as error:
                issues.append(Issue(error.code, _route(fields, number), error.message, error.help))
                if len(issues) == MAX_PROBLEMS or self.left < 0:
                    break
        opened = OpenedSuite(fields, folder, tuple(members))
        if fields.splits and opened.most_grown > MAX_DIGESTS and not issues:
            message = (
                f"splits need the digest of every level, and {opened.most_grown:,} levels are "
                f"grown, more than {MAX_DIGESTS:,}"
            )
            advice = "use splits of the suites that grow them: `{suite: …, split: …, count: …}`"
            issues.append(Issue("BR205", ("splits",), message, advice))
        return opened, issues

    def _member(self, entry: SuiteEntry, folder: Path, own: tuple[Place, ...]) -> Member:
        levels: Iterable[Level] = ()
        if entry.level is not None:
            levels = [self._level(entry.level, folder, own)]
        elif entry.folder is not None:
            inner = _inside(folder, entry.folder)
            if not is_folder(inner):
                raise _UnusableError("BR208", f"there is no folder `{shortened(entry.folder)}`")
            levels = self._levels_in(inner, entry.folder, folder)
        elif entry.pack is not None:
            place = _pack(entry.pack, own)
            within = place.folder if place in own else None
            levels = self._levels_in(place.folder, entry.pack, within)
        else:
            suite = self._suite(entry.suite, folder, own)
            known = [*suite.fields.splits]
            if entry.split is not None and entry.split not in known:
                guess = did_you_mean(entry.split, known)
                message = f"the suite has no split `{entry.split}`{guess}"
                splits = ", ".join(known) or "none"
                raise _UnusableError("BR208", message, f"its splits: {splits}")
            self._count()
            return Member((), suite, entry.split, entry.count, entry.weight)
        return Member(tuple(levels), weight=entry.weight)

    # -- levels ----------------------------------------------------------------------------

    def _level(self, level: str | dict[str, Any], folder: Path, own: tuple[Place, ...]) -> Level:
        if isinstance(level, dict) or is_code(level):
            with _explained("the level"):
                return self._usable(load(level), "the level")
        if _is_path(level):
            path = _inside(folder, level)
            if not is_file(path):
                guess = did_you_mean(path.name, [Path(name).name for name in nearest_files(path)])
                message = f"there is no file `{shortened(level)}`{guess}"
                raise _UnusableError("BR208", message, "files are in the folder of the suite")
        else:
            path = self._found(find, level, own)
        if is_suite_file(path):
            advice = f"write `suite: {shortened(level)}`"
            raise _UnusableError("BR209", f"`{shortened(level)}` is a suite, not a level", advice)
        return self._usable(self._load(path, level), f"`{shortened(level)}`")

    def _usable(self, level: Level, shown: str) -> Level:
        self._count()
        if level.has_random_maze:
            advice = "give the maze a seed, such as `maze: {seed: 1}`"
            message = f"{shown} has another maze in each episode: its seed is random"
            raise _UnusableError("BR209", message, advice)
        return level

    def _levels_in(self, folder: Path, name: str, within: Path | None = None) -> Iterator[Level]:
        """Yield the levels in a folder, without suites and levels whose maze is random."""
        is_empty = True
        for path in yaml_files(folder):
            shown = path.relative_to(folder).as_posix()
            if within is not None and not is_within(path, within):
                raise _UnusableError("BR209", f"`{shown}` is a link that leads out of the folder")
            if is_suite_file(path):
                continue
            level = self._load(path, shown)
            if not level.has_random_maze:
                is_empty = False
                yield self._usable(level, shown)
        if is_empty:
            raise _UnusableError("BR209", f"there is no level in `{shortened(name)}`")

    def _load(self, path: Path, shown: str) -> Level:
        if path not in self._levels:
            with _explained(f"`{shortened(shown)}`"):
                self._levels[path] = load_file(path)
        return self._levels[path]

    # -- suites ----------------------------------------------------------------------------

    def _suite(
        self, suite: str | dict[str, Any] | None, folder: Path, own: tuple[Place, ...]
    ) -> OpenedSuite:
        if len(self._around) > MAX_NESTING:
            raise _UnusableError("BR209", f"suites are nested more than {MAX_NESTING} deep")
        if isinstance(suite, dict):
            with _explained("the suite"):
                fields = suite_from_mapping(suite)
            return self._opened(fields, folder, Path("the suite itself"), "the suite")
        name = str(suite)
        if _is_path(name):
            path = _inside(folder, name)
            if not is_file(path):
                raise _UnusableError("BR208", f"there is no file `{shortened(name)}`")
        else:
            path = self._found(find_suite, name, own)
        for number, other in enumerate(self._around):
            if _is_same(path, other):
                names = " → ".join(f"`{each.name}`" for each in [*self._around[number:], path])
                raise _UnusableError("BR209", f"the suite lists itself: {names}")
        with _explained(f"`{shortened(name)}`"):
            fields = check_suite(open_document(path), path).valid()
        return self._opened(fields, path.parent, path, f"`{shortened(name)}`")

    def _opened(self, fields: AnySuite, folder: Path, path: Path, shown: str) -> OpenedSuite:
        self._around.append(path)
        opened, issues = self.suite(fields, folder)
        self._around.pop()
        for issue in issues:
            raise _UnusableError("BR209", f"{shown} is not valid: {issue.message}", issue.help)
        return opened

    def _count(self) -> None:
        self.left -= 1
        if self.left < 0:
            message = f"the suite lists more than {MAX_ENTRIES:,} levels"
            raise _UnusableError("BR205", message, "use fewer, or a suite that grows mazes")


def _route(fields: SuiteListFields, number: int) -> Route:
    entry = fields.levels[number]
    if isinstance(entry, str):
        return ("levels", number)
    given = next(name for name in ("level", "folder", "pack", "suite") if getattr(entry, name))
    return ("levels", number, given)


@contextmanager
def _explained(shown: str) -> Iterator[None]:
    """Turn the error of what an entry lists into an error of the entry."""
    try:
        yield
    except LevelError as error:
        for found in error.diagnostics:
            # Of a mapping there are no lines.
            line = f"line {found.line}: " if is_file(Path(found.file)) else ""
            message = f"{shown} is not valid: {line}{found.message}"
            raise _UnusableError("BR209", message, found.help) from None
        raise _UnusableError("BR209", f"{shown} is not valid: {error}") from None


# -- files -----------------------------------------------------------------------------------


def _is_path(name: str) -> bool:
    return name.lower().endswith(SUFFIXES)


def _inside(folder: Path, name: str) -> Path:
    """Return the path of a file or a folder that has to be in the folder of the suite."""
    parts = PurePosixPath(name).parts
    is_outside = ".." in parts or "\\" in name or "\0" in name or not name
    is_absolute = PurePosixPath(name).is_absolute() or PureWindowsPath(name).anchor
    path = folder / name if not (is_outside or is_absolute) else None
    if path is None or not is_within(path, folder):
        message = f"`{shortened(name)}` is not in the folder of the suite"
        advice = "use paths from the folder of the suite on, with `/` and without `..`"
        raise _UnusableError("BR209", message, advice)
    return path


def _is_same(path: Path, other: Path) -> bool:
    try:
        return path.resolve() == other.resolve()
    except (OSError, RuntimeError):
        return False


def _found(finder: Any, name: str, own: tuple[Place, ...]) -> Path:
    """Return the file of a name, looked for in the suite's own pack first."""
    try:
        path: Path = finder(name, own)
    except LevelNotFoundError as error:
        guess = f"; did you mean `{error.nearest[0]}`?" if error.nearest else ""
        message = f"there is no {error.what} called `{shortened(name)}`{guess}"
        raise _UnusableError("BR208", message, "names of files end in `.yaml`") from None
    for place in own:
        if path.is_relative_to(place.folder) and not is_within(path, place.folder):
            message = f"`{shortened(name)}` is a link that leads out of its pack"
            raise _UnusableError("BR209", message)
    return path


def _own_pack(folder: Path | None) -> tuple[Place, ...]:
    """Return the pack around a folder, which need not be installed; none if there is none."""
    if folder is None:
        return ()
    from babyrobot_levels.library.packs import fields

    here = Path(os.path.abspath(folder))  # noqa: PTH100  (names, not links, as for themes)
    for each in (here, *here.parents[:MAX_DEPTH]):
        if os.path.lexists(each / PACK_FILE):
            found = fields(each)
            return () if found is None else (Place(each, found.name, f"pack {found.name}"),)
    return ()


def _pack(name: str, own: tuple[Place, ...]) -> Place:
    """Return the place of a pack, or of the gallery."""
    known: dict[str, Place] = {}
    for place in (*own, gallery_place(), *pack_places()):
        known.setdefault(place.pack or GALLERY, place)
    if name not in known:
        guess = did_you_mean(name, known)
        message = f"there is no pack called `{name}`{guess}"
        raise _UnusableError("BR208", message, "`babyrobot list --packs` shows all packs")
    return known[name]
