"""Finds levels by name: in the gallery, the user's folders, and packages that carry packs."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from babyrobot_levels.errors import LevelError, LevelNotFoundError, SuiteNotFoundError
from babyrobot_levels.files import SUFFIXES, ReadFault, read_source
from babyrobot_levels.level import Level, slug
from babyrobot_levels.reading import from_mapping, load_file
from babyrobot_levels.share import is_code, load_code
from babyrobot_levels.suggest import nearest

PACK_GROUP = "babyrobot_levels.packs"
"""The entry-point group of packs: an entry's name is the pack's, its value an import path."""

PATH_VARIABLE = "BABYROBOT_LEVELS"
MAX_DEPTH = 6
_NAME_LINE = re.compile(r"^name:[ \t]*[\"']?([a-z0-9-]+)", re.MULTILINE)
_SUITE_LINE = re.compile(r"^kind:[ \t]*[\"']?suite\b", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Place:
    """A folder of levels, and the pack that it is, if it is one."""

    folder: Path
    label: str
    pack: str | None = None


@dataclass(frozen=True, slots=True)
class LevelFile:
    """A level file that the catalogue knows. `name` is the file's, with its pack's before it."""

    name: str
    path: Path
    place: Place


@dataclass(frozen=True, slots=True)
class LevelInfo:
    """What the catalogue says of a level. `size` is width and height in cells."""

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
    """Return a level, however it is told.

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
        return from_mapping(level)
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
    files = []
    for file in level_files():
        if file.name == name:
            return file.path
        files.append(file)
    # Nobody's file is called so; perhaps a file's own `name` field is.
    for file in files:
        own = _own_name(file)
        if own is not None and name == (f"{file.place.pack}/{own}" if file.place.pack else own):
            return file.path
    raise LevelNotFoundError(name, nearest(name, [file.name for file in files]))


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
            if not _is_suite(file):
                broken.append(file.path)
            continue
        # The first place in which a name stands wins, as in `find`.
        name = f"{file.place.pack}/{level.name}" if file.place.pack else str(level.name)
        found.setdefault(
            name,
            LevelInfo(name, level.title, level.size, level.tags, level.source, file.path),
        )
    return sorted(found.values(), key=lambda info: info.name), broken


def level_files() -> Iterator[LevelFile]:
    """Yield all level files, place by place, and by path within each."""
    for place in places():
        for path in yaml_files(place.folder):
            stem = slug(path.stem)
            if stem is not None:
                yield LevelFile(f"{place.pack}/{stem}" if place.pack else stem, path, place)


def suite_files() -> dict[str, Path]:
    """Return the files of all suites by their names, the first place that has a name winning."""
    found: dict[str, Path] = {}
    for file in level_files():
        if _is_suite(file):
            found.setdefault(file.name, file.path)
    return found


def find_suite(suite: str | os.PathLike[str]) -> Path:
    """Return the file of a suite, which is given by its name or its path.

    Raises:
        SuiteNotFoundError: nothing has that name.
    """
    if not isinstance(suite, str) or _looks_like_path(suite):
        path = Path(suite)
        if not path.is_file():
            raise SuiteNotFoundError(str(path), _nearest_files(path), is_file=True)
        return path
    for file in level_files():
        if file.name == suite and _is_suite(file):
            return file.path
    raise SuiteNotFoundError(suite, nearest(suite, suite_files()))


def yaml_files(folder: Path) -> Iterator[Path]:
    """Yield the YAML files below a folder, sorted; not those of themes, nor hidden ones."""
    for here, folders, names in os.walk(folder):
        depth = len(Path(here).relative_to(folder).parts)
        folders[:] = sorted(
            name
            for name in folders
            if name != "themes" and not name.startswith(".") and depth < MAX_DEPTH
        )
        for name in sorted(names):
            path = Path(here, name)
            if path.suffix in SUFFIXES and not name.startswith(".") and name != "pack.yaml":
                yield path


def places() -> list[Place]:
    """Return where levels are looked for, the first that has a name winning.

    In this order: the gallery, the user's own folder, `levels/` of the current folder, the
    folders of `BABYROBOT_LEVELS`, the user's packs, the packs of installed packages.
    """
    found = [Place(gallery_folder(), "gallery"), Place(user_folder() / "levels", "user")]
    found.append(Place(Path("levels"), "levels/"))
    listed = os.environ.get(PATH_VARIABLE, "").split(os.pathsep)
    found += [Place(Path(name), PATH_VARIABLE) for name in listed if name]
    packs = user_folder() / "packs"
    if packs.is_dir():
        found += [Place(path, "pack", path.name) for path in sorted(packs.iterdir())]
    from importlib.metadata import entry_points

    for entry in entry_points(group=PACK_GROUP):
        carried = _package_folder(entry.value.partition(":")[0].strip())
        if carried is not None:
            found.append(Place(carried, "pack", entry.name))
    real: dict[Path, Place] = {}
    for place in found:
        if place.folder.is_dir():
            real.setdefault(place.folder.resolve(), place)
    return list(real.values())


def gallery_folder() -> Path:
    """Return the gallery's folder: inside the installed package, or beside it in a checkout."""
    package = Path(__file__).parent
    inside = package / "data" / "levels"
    return inside if inside.is_dir() else package.parent / "levels"


def user_folder() -> Path:
    """Return the user's own folder for levels and packs, which need not be there."""
    from platformdirs import user_data_path

    return user_data_path("babyrobot-levels", appauthor=False)


def _looks_like_path(text: str) -> bool:
    path = Path(text)
    if path.suffix in SUFFIXES or text.startswith((".", "~")) or path.is_absolute():
        return True
    # `pack/name` looks like a path too; a file of that very name is meant where there is one.
    return len(path.parts) > 1 and path.is_file()


def _load_path(path: Path) -> Level:
    try:
        path = path.expanduser()
        is_there = path.exists()
    except (OSError, RuntimeError, ValueError):
        is_there = False
    if not is_there:
        raise LevelNotFoundError(str(path), _nearest_files(path), is_file=True)
    return load_file(path)


def _nearest_files(path: Path) -> list[str]:
    """Return the level files beside a missing one whose names are like its name."""
    try:
        stems = {other.stem: other for other in path.parent.iterdir() if other.suffix in SUFFIXES}
    except OSError:
        return []
    stems.pop(path.stem, None)
    return [str(stems[stem]) for stem in nearest(path.stem, stems)]


def _own_name(file: LevelFile) -> str | None:
    """Return the name that a file gives itself, from a look at its text."""
    try:
        match = _NAME_LINE.search(read_source(file.path).text)
    except ReadFault:
        return None
    return match[1] if match else None


def _is_suite(file: LevelFile) -> bool:
    """Tell, from a look at its text, whether a file is a suite."""
    try:
        return _SUITE_LINE.search(read_source(file.path).text) is not None
    except ReadFault:
        return False


def _package_folder(module: str) -> Path | None:
    """Return a package's folder without running the package, or None if there is none."""
    name, *rest = module.split(".")
    try:
        # Only the outermost package: looking for an inner one would run its parents.
        spec = find_spec(name)
    except (ImportError, ValueError):
        return None
    locations = list(spec.submodule_search_locations or ()) if spec else []
    return Path(locations[0], *rest) if locations else None
