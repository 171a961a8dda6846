"""Finds levels by name: in the gallery, the user's folders, and packages that carry packs."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from babyrobot_levels.language.documents import slug
from babyrobot_levels.language.share_code import is_code
from babyrobot_levels.library.level import Level
from babyrobot_levels.library.reading import load_code, load_file
from babyrobot_levels.library.search_path import Place, places, yaml_files
from babyrobot_levels.text.errors import LevelError, LevelNotFoundError, SuiteNotFoundError
from babyrobot_levels.text.files import SUFFIXES, is_file, read_source
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.words import nearest

MAX_NEAREST = 3
_LINES = {
    key: re.compile(rf"^{key}:[ \t]*([\"']?)([a-z0-9-]+)\1(?:[ \t]+#.*)?[ \t]*$", re.MULTILINE)
    for key in ("name", "kind")
}
"""How a file usually states its name, or that it is a suite."""


@dataclass(frozen=True, slots=True)
class LevelFile:
    """A level file that the catalogue knows. `name` is the file's, with its pack's before it."""

    name: str
    path: Path
    place: Place


@dataclass(frozen=True, slots=True)
class LevelInfo:
    """The catalogue entry of a level. `size` is width and height in cells."""

    name: str
    title: str | None
    size: tuple[int, int]
    tags: tuple[str, ...]
    source: str | None
    path: Path

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data."""
        return {
            "name": self.name,
            "title": self.title,
            "size": list(self.size),
            "tags": list(self.tags),
            "source": self.source,
            "path": str(self.path),
        }


def load(level: str | os.PathLike[str] | Mapping[str, Any] | Level) -> Level:
    """Return a level.

    Args:
        level: a name from the catalogue (`"final-maze"`), `"pack/name"`, the path of a file, a
            share code (`"brl1.…"`), a mapping of the language's fields, or a level, which is
            returned as it is.

    Raises:
        LevelNotFoundError: nothing has that name; the error names the nearest ones.
        LevelError: the level is found, but not valid.
    """
    if isinstance(level, Level):
        return level
    if isinstance(level, Mapping):
        return Level.from_fields(level)
    if not isinstance(level, str | os.PathLike):
        raise TypeError(
            f"a level is a name, a path, a mapping or a Level, not {type(level).__name__}"
        )
    if not isinstance(level, str):
        return _load_path(Path(level))
    if is_code(level):
        return load_code(level)
    if "\n" in level:
        raise LevelError(message="this is the text of a level; `loads` reads it")
    if _looks_like_path(level):
        return _load_path(Path(level))
    return load_file(find(level))


def find(name: str) -> Path:
    """Return the file of the level that has a name, or `pack/name`.

    The places are searched in the order of `places`: a name of the gallery always means the
    gallery's level.

    Raises:
        LevelNotFoundError: nothing has that name.
    """
    for path in _named(name):
        return path
    known = {file.name: file.path for file in level_files()}
    near = _nearest_names(name, [*known])
    raise LevelNotFoundError(name, [other for other in near if not is_suite_file(known[other])])


def levels() -> list[LevelInfo]:
    """Return what the catalogue knows of each level that is valid, by name."""
    return catalogue()[0]


def catalogue() -> tuple[list[LevelInfo], list[Path]]:
    """Return what is known of each level, by name, and the files that are no valid levels."""
    found: dict[str, LevelInfo] = {}
    broken = []
    for file in level_files():
        try:
            level = load_file(file.path)
        except LevelError:
            if not is_suite_file(file.path):
                broken.append(file.path)
            continue
        # The first place in which a name stands wins, as in `find`.
        name = file.place.named(str(level.name))
        found.setdefault(
            name,
            LevelInfo(name, level.title, level.size, level.tags, level.source, file.path),
        )
    return sorted(found.values(), key=lambda info: info.name), broken


def level_files() -> Iterator[LevelFile]:
    """Yield all level files, place by place, and by path within each."""
    for place in places():
        yield from files_in(place)


def files_in(place: Place) -> Iterator[LevelFile]:
    """Yield the level files of one place, by path; suites are among them."""
    for path in yaml_files(place.folder):
        stem = slug(path.stem)
        if stem is not None:
            yield LevelFile(place.named(stem), path, place)


def suite_files() -> dict[str, Path]:
    """Return the files of all suites by their names, the first place that has a name winning."""
    found: dict[str, Path] = {}
    for file in level_files():
        if is_suite_file(file.path):
            own = _stated(file.path, "name")
            name = file.name if own is None else file.place.named(own)
            found.setdefault(name, file.path)
    return found


def find_suite(suite: str | os.PathLike[str]) -> Path:
    """Return the file of a suite, which is given by its name or its path.

    Raises:
        SuiteNotFoundError: nothing has that name.
    """
    if not isinstance(suite, str) or _looks_like_path(suite):
        path = Path(suite)
        if not is_file(path):
            raise SuiteNotFoundError(str(path), _nearest_files(path), is_file=True)
        return path
    for path in _named(suite):
        if is_suite_file(path):
            return path
    raise SuiteNotFoundError(suite, _nearest_names(suite, [*suite_files()]))


def is_suite_file(path: Path) -> bool:
    """Tell, from a look at its text, whether a file is a suite."""
    return _stated(path, "kind") == "suite"


def _named(name: str) -> Iterator[Path]:
    """Yield the files that a name means: those that are called so, then those that say so."""
    files = []
    for file in _files_of_pack(_pack_in(name)):
        if file.name == name:
            yield file.path
        files.append(file)
    for file in files:
        own = _stated(file.path, "name")
        if own is not None and file.place.named(own) == name:
            yield file.path


def _pack_in(name: str) -> str | None:
    """Return the pack that a name names, None where it names none."""
    return name.rpartition("/")[0] or None


def _files_of_pack(pack: str | None) -> Iterator[LevelFile]:
    """Yield the level files of a pack; for None, of all places that are no packs."""
    for place in places():
        if place.pack == pack:
            yield from files_in(place)


def _looks_like_path(text: str) -> bool:
    path = Path(text)
    if path.suffix in SUFFIXES or text.startswith((".", "~")) or path.is_absolute():
        return True
    # `pack/name` looks like a path too; a file of that very name is meant where there is one.
    return len(path.parts) > 1 and is_file(path)


def _load_path(path: Path) -> Level:
    # Without a home directory, `~` is an ordinary name.
    with suppress(RuntimeError):
        path = path.expanduser()
    if not _is_there(path):
        raise LevelNotFoundError(str(path), _nearest_files(path), is_file=True)
    return load_file(path)


def _is_there(path: Path) -> bool:
    """Tell whether there is something; where that may not be asked, reading it says so."""
    try:
        path.stat()
    except PermissionError:
        return True
    except (OSError, ValueError):
        return False
    return True


def _nearest_names(name: str, known: Sequence[str]) -> list[str]:
    """Return the likeliest of the known names: the same one in a pack, or like it."""
    own = name.rpartition("/")[2]
    same = [other for other in known if other.rpartition("/")[2] == own]
    return list(dict.fromkeys([*same, *nearest(name, known)]))[:MAX_NEAREST]


def _nearest_files(path: Path) -> list[str]:
    """Return the level files beside a missing one whose names are like its name."""
    try:
        stems = {other.stem: other for other in path.parent.iterdir() if other.suffix in SUFFIXES}
    except OSError:
        return []
    stems.pop(path.stem, None)
    return [str(stems[stem]) for stem in nearest(path.stem, stems)]


def _stated(path: Path, key: str) -> str | None:
    """Return what a file states under a key, without checking it."""
    try:
        source = read_source(path)
        match = _LINES[key].search(source.text)
        if match is not None:
            return match[2]
        # YAML has other forms, which are rare.
        data = read(source).data if key in source.text else None
    except LevelError:
        return None
    told = data.get(key) if isinstance(data, dict) else None
    return told if isinstance(told, str) else None
