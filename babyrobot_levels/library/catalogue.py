"""Finds levels and suites by name, and loads them."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import chain, islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, SupportsIndex, cast, overload

from babyrobot_levels.language.looks import BUILTIN_THEMES
from babyrobot_levels.language.names import slug
from babyrobot_levels.language.share_code import is_code
from babyrobot_levels.library.level import Level, load_code, load_file, load_source
from babyrobot_levels.library.search_path import (
    GALLERY,
    Place,
    gallery_place,
    pack_places,
    places,
    yaml_files,
)
from babyrobot_levels.registry.later import Shown, later
from babyrobot_levels.registry.own import own
from babyrobot_levels.text.errors import LevelError, LevelNotFoundError, SuiteNotFoundError
from babyrobot_levels.text.files import (
    SUFFIXES,
    is_file,
    is_folder,
    nearest_files,
    read_source,
    schema_for,
    write_new,
)
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import MAX_BYTES, SourceFile, with_schema
from babyrobot_levels.text.words import nearest

if TYPE_CHECKING:
    import gymnasium

    Env = gymnasium.Env[Any, Any]

LevelLike = str | os.PathLike[str] | Mapping[str, Any] | Level
"""A level, as `load` takes it."""

MAX_NEAREST = 3
MAX_LISTED = 20
"""How many levels the text of a list names."""

_LINES = {
    key: re.compile(rf"^{key}:[ \t]*([\"']?)([a-z0-9-]+)\1(?:[ \t]+#.*)?[ \t]*$", re.MULTILINE)
    for key in ("name", "kind")
}
"""The usual form of the lines with a file's name and kind."""


@dataclass(frozen=True, slots=True)
class LevelFile:
    """A level file in one of the search folders; `name` is its stem, `PACK/STEM` in a pack."""

    name: str
    path: Path
    place: Place


@dataclass(frozen=True, slots=True, repr=False)
class LevelInfo(Shown, public=True):
    """A level in the catalogue.

    Attributes:
        name: the name under which `load` finds it.
        title: its title.
        size: width and height in cells.
        tags: its tags.
        source: where it comes from.
        path: its file.
        origin: the folder in which it was found, such as `"gallery"` or `"levels/"`.
    """

    name: str
    title: str | None
    size: tuple[int, int]
    tags: tuple[str, ...]
    source: str | None
    path: Path
    origin: str = ""

    def __repr__(self) -> str:
        title = "" if self.title is None else f" {self.title!r}"
        return f"<LevelInfo {self.name!r}: {self.size[0]}x{self.size[1]}{title}>"

    _html = later("babyrobot_levels.library.notebooks:info_html")

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data."""
        return {
            "name": self.name,
            "title": self.title,
            "size": list(self.size),
            "tags": list(self.tags),
            "source": self.source,
            "path": str(self.path),
            "from": self.origin,
        }


class LevelList(Shown, list[LevelInfo]):
    """A list of levels, which shows itself as a table. Its slices are such lists, too."""

    _html = later("babyrobot_levels.library.notebooks:list_html")

    @overload
    def __getitem__(self, index: SupportsIndex) -> LevelInfo: ...
    @overload
    def __getitem__(self, index: slice) -> LevelList: ...
    def __getitem__(self, index: SupportsIndex | slice) -> LevelInfo | LevelList:
        found = super().__getitem__(index)
        return LevelList(found) if isinstance(found, list) else found

    def __repr__(self) -> str:
        lines = [
            f"  {info.name}  {info.size[0]}x{info.size[1]}  {info.title or ''}".rstrip()
            for info in self[:MAX_LISTED]
        ]
        more = [f"  … and {len(self) - MAX_LISTED} more"] if len(self) > MAX_LISTED else []
        return "\n".join([f"{len(self)} level{'s' * (len(self) != 1)}", *lines, *more])


def load(level: LevelLike) -> Level:
    """Return a level.

    Args:
        level: a name (`"final-maze"`), `"pack/name"`, `"gallery/name"`, the path of a file, also of
            one of another program that `import_` recognises, a share code (`"brl1.…"`), a mapping
            of the language's fields, or a level, which is returned unchanged.

    Raises:
        LevelNotFoundError: nothing has that name; the error names the nearest ones.
        LevelError: the level is found, but not valid.
    """
    if isinstance(level, Level):
        return level
    if isinstance(level, Mapping):
        return Level.from_fields(level)
    if not isinstance(level, str | os.PathLike):
        kind, told = type(level).__name__, ""
        if hasattr(level, "reset"):
            told = "; of an environment it is `env.unwrapped.level`"
        elif kind == "list":
            told = "; load each of several, and the map of another program by `brl.import_`"
        raise TypeError(f"a level is a name, a path, a mapping or a Level, not {kind}{told}")
    if isinstance(level, str) and is_code(level):
        return load_code(level)
    path = level_path(level)
    try:
        return load_file(path)
    except LevelError:
        # It may be the file of another program.
        found = None if path.suffix in SUFFIXES else own("foreign_level")(path)
        if found is None:
            raise
        return cast(Level, found)


def make(level: LevelLike, **kwargs: Any) -> Env:
    """Return a level as a Gymnasium environment; its `max_steps` becomes the time limit.

    Args:
        level: what `load` takes.
        kwargs: the arguments of `level.make`: `observation`, `actions`, `render_mode`, …

    Errors are those of `load`.
    """
    return load(level).make(**kwargs)


def level_path(level: str | os.PathLike[str]) -> Path:
    """Return the file of a level.

    Args:
        level: a name, or the path of a file.

    Raises:
        LevelNotFoundError: nothing has that name; the error names the nearest ones.
        LevelError: it is the text of a level.
    """
    if isinstance(level, str):
        if "\n" in level:
            raise LevelError(message="this is the text of a level; `loads` reads it")
        if not looks_like_path(level):
            return find(level)
    path = Path(level)
    # Without a home directory, `~` is a name like any other.
    with suppress(RuntimeError):
        path = path.expanduser()
    if not _is_there(path):
        names = [path.stem for _ in islice(_named(path.stem), 1)]
        raise LevelNotFoundError(str(path), [*names, *nearest_files(path)], is_file=True)
    return path


def folder_named(name: str | os.PathLike[str]) -> Path | None:
    """Return the folder of levels that a name or a path stands for, None if there is none.

    A level of that name comes before a folder, and a folder before a pack.
    """
    if isinstance(name, str) and (is_code(name) or "\n" in name):
        return None
    try:
        path = level_path(name)
    except LevelNotFoundError:
        if is_folder(Path(name)):
            return Path(name)
        packs = (gallery_place(), *pack_places()) if isinstance(name, str) else ()
        return next((each.folder for each in packs if name == (each.pack or GALLERY)), None)
    return path if is_folder(path) else None


def find(name: str, first: Sequence[Place] = ()) -> Path:
    """Return the file of the level with a name, which may be `pack/name` or `gallery/name`.

    The folders are searched in the order of `places`: a level in `levels/` of the current folder
    comes before one of the gallery with the same name.

    Args:
        name: the name.
        first: places that are searched before all others.

    Raises:
        LevelNotFoundError: nothing has that name.
    """
    for path in _named(name, first):
        return path
    # A pack that is not installed is a folder.
    folder, _, stem = name.rpartition("/")
    found = (str(path) for path in yaml_files(Path(folder)) if path.stem == stem)
    files = [*islice(found, MAX_NEAREST)]
    known = {file.name: file.path for file in level_files()}
    if name in ("levels", "all", "gallery") and not files:
        raise LevelNotFoundError(name, help_text="`brl.levels()` returns all levels")
    near = [each for each in _nearest_names(name, [*known]) if not is_suite_file(known[each])]
    raise LevelNotFoundError(name, files or near)


def levels() -> LevelList:
    """Return all valid levels that have names, sorted by name."""
    return LevelList(catalogue()[0])


def catalogue() -> tuple[list[LevelInfo], list[Path]]:
    """Return all levels that have names, sorted by name, and the files that are not valid."""
    found: dict[str, LevelInfo] = {}
    others: dict[str, LevelInfo] = {}
    broken = []
    for file in level_files():
        try:
            level = load_file(file.path)
        except LevelError:
            if not is_suite_file(file.path):
                broken.append(file.path)
            continue
        name = file.place.named(str(level.name))
        info = LevelInfo(
            name, level.title, level.size, level.tags, level.source, file.path, file.place.origin
        )
        # As in `find`: the first place wins, and files called so win over those that say so.
        (found if file.name == name else others).setdefault(name, info)
    return sorted({**others, **found}.values(), key=lambda info: info.name), broken


def level_files() -> Iterator[LevelFile]:
    """Yield all level files, in the order in which they are searched."""
    for place in places():
        yield from files_in(place)


def files_in(place: Place) -> Iterator[LevelFile]:
    """Yield the level and suite files of one folder, sorted by path."""
    for path in yaml_files(place.folder):
        if (stem := slug(path.stem)) is not None:
            yield LevelFile(place.named(stem), path, place)


def suite_files() -> dict[str, Path]:
    """Return the files of all suites by name; the first folder that has a name wins."""
    found: dict[str, Path] = {}
    for file in level_files():
        if is_suite_file(file.path):
            own = _stated(file.path, "name")
            found.setdefault(file.name if own is None else file.place.named(own), file.path)
    return found


def find_suite(suite: str | os.PathLike[str], first: Sequence[Place] = ()) -> Path:
    """Return the file of a suite.

    Args:
        suite: a name, or the path of a file.
        first: places that are searched before all others.

    Raises:
        SuiteNotFoundError: nothing has that name.
    """
    if not isinstance(suite, str) or looks_like_path(suite):
        path = Path(suite)
        if not is_file(path):
            raise SuiteNotFoundError(str(path), nearest_files(path), is_file=True)
        return path
    for path in _named(suite, first):
        if is_suite_file(path):
            return path
    if next(_named(suite, first), None) is not None:
        raise SuiteNotFoundError(
            suite, help_text=f"it is a level: `brl.load({suite!r})`, `--from {suite}`"
        )
    raise SuiteNotFoundError(suite, _nearest_names(suite, [*suite_files()]))


def suite_path(name: str | os.PathLike[str]) -> Path | None:
    """Return the file of the suite that a name or a path stands for, None if there is none."""
    if isinstance(name, str) and (is_code(name) or "\n" in name):
        return None
    try:
        is_path = not isinstance(name, str) or looks_like_path(name)
        path = Path(name) if is_path else find(str(name))
    except LevelNotFoundError:
        return None
    return path if is_file(path) and is_suite_file(path) else None


def is_suite_file(path: Path) -> bool:
    """Return whether a file is a suite, judging by its text."""
    return _stated(path, "kind") == "suite"


def _named(name: str, first: Sequence[Place] = ()) -> Iterator[Path]:
    """Yield the files that a name means: those with that stem, then those with that `name`."""
    files = []
    pack, _, own = name.rpartition("/")
    if pack == GALLERY:
        name, candidates = own, files_in(gallery_place())
    else:
        candidates = _files_of_pack(pack or None, first)
    for file in candidates:
        if file.name == name:
            yield file.path
        files.append(file)
    for file in files:
        stated = _stated(file.path, "name")
        if stated is not None and file.place.named(stated) == name:
            yield file.path


def _files_of_pack(pack: str | None, first: Sequence[Place]) -> Iterator[LevelFile]:
    """Yield the level files of a pack; for None, of all folders that are no packs."""
    for place in chain(first, places()):
        if place.pack == pack:
            yield from files_in(place)


def looks_like_path(text: str) -> bool:
    """Tell whether an argument is the path of a file, and not the name of a level."""
    path = Path(text)
    if path.suffix in SUFFIXES or text.startswith((".", "~")) or path.is_absolute():
        return True
    # `pack/name` looks like a path too; a file of that very name is meant where there is one. Names
    # of levels have no suffix, but files may have any, such as `.json`.
    return (len(path.parts) > 1 or path.suffix != "") and is_file(path)


def _is_there(path: Path) -> bool:
    """Return whether a path exists; True if that may not be asked, as reading it reports why."""
    try:
        path.stat()
    except PermissionError:
        return True
    except (OSError, ValueError):
        return False
    return True


def _nearest_names(name: str, known: Sequence[str]) -> list[str]:
    """Return the most similar known names: the same one in a pack, or one like it."""
    own = name.rpartition("/")[2]
    same = [other for other in known if other.rpartition("/")[2] == own]
    return list(dict.fromkeys([*same, *nearest(name, known)]))[:MAX_NEAREST]


def _stated(path: Path, key: str) -> str | None:
    """Return the text that a file has under a key, without validating the file."""
    try:
        source = read_source(path)
        if (match := _LINES[key].search(source.text)) is not None:
            return match[2]
        # YAML has other forms, which are rare.
        data = read(source).data if key in source.text else None
    except LevelError:
        return None
    stated = data.get(key) if isinstance(data, dict) else None
    return stated if isinstance(stated, str) else None


def resolve(
    level: LevelLike,
    path: str | os.PathLike[str] | None = None,
    *,
    maze_seed: int | None = None,
    force: bool = False,
) -> Level:
    """Return a level with its maze written out as walls, as `babyrobot resolve` does.

    A level without a maze is returned as it is.

    Args:
        level: a name, a path, a share code, a mapping, or a level.
        path: a file to write it to; it keeps the level's comments.
        maze_seed: the seed of the maze of a level with a random maze.
        force: whether to replace an existing file.

    Raises:
        LevelNotFoundError: nothing has that name.
        LevelError: the level is not valid, or its maze is random and there is no seed.
        ValueError: the level's maze is not random, or its walls do not fit into a file.
        FileExistsError: there is a file, and `force` is not given.
    """
    found = load(level)
    if maze_seed is not None:
        if not found.has_random_maze:
            raise ValueError("the level's maze is not random: leave out maze_seed")
        found = found.with_maze_seed(maze_seed)
    resolved = found.resolve()
    if path is not None:
        text = text_for(resolved, resolved.to_yaml(comments=True), Path(path))
        if len(text.encode("utf-8")) > MAX_BYTES:
            raise ValueError("the walls of this maze do not fit into a level file of 1 MiB")
        write_new(Path(path), text, force=force)
    return resolved


def text_for(level: Level, text: str, path: Path) -> str:
    """Return the text for a file; it includes a theme that is not found from there."""
    if isinstance(level.theme, str) and level.theme not in BUILTIN_THEMES:
        try:
            theme = load_source(SourceFile(str(path), text), path).resolved_theme
        except LevelError:
            theme = None
        if theme != level.resolved_theme:
            text = level.replace(theme=level.resolved_theme).to_yaml(comments=True)
    return with_schema(text, schema_for(path))
