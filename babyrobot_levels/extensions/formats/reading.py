"""Worlds of other programs: recognised by what files hold, and read."""

import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path, PurePath
from typing import Any

from babyrobot_levels.extensions.formats import frozen_lake
from babyrobot_levels.extensions.formats.conversion import (
    ConversionError,
    ConversionWarning,
    World,
    file_text,
    level_of,
    looks_like_data,
    read_data,
)
from babyrobot_levels.extensions.formats.formats import FORMATS, Format
from babyrobot_levels.extensions.formats.sources import Found, found_in, is_archive, opened, single
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.names import slug
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.errors import LevelError, warn
from babyrobot_levels.text.files import SUFFIXES as SUFFIXES_OF_LEVELS
from babyrobot_levels.text.files import is_folder, schema_for, write_new
from babyrobot_levels.text.reader import read as read_yaml
from babyrobot_levels.text.source import SourceFile
from babyrobot_levels.text.words import no_format

_PLAIN = ("", ".txt", ".json", ".py", *SUFFIXES_OF_LEVELS)
"""Suffixes that say nothing of a format."""

_FIELDS = LevelFields.model_fields.keys()


def guess(source: SourceFile) -> list[str]:
    """Return the names of the formats that a text may be in, by its suffix or its content.

    Raises:
        ConversionError: it is blank, or looks like JSON or Python but is malformed.
    """
    suffix = PurePath(source.name).suffix.lower()
    others = () if suffix in _PLAIN else FORMATS.added()
    for formats in (FORMATS.own.items(), others):
        if by_suffix := [name for name, each in formats if suffix in each.suffixes]:
            return by_suffix
    return _by_content(source, FORMATS.own) or [*_by_extensions(source)]


def _by_extensions(source: SourceFile) -> Iterator[str]:
    for name, each in FORMATS.added():
        # What fails does not have the others fail.
        with suppress(Exception):
            yield from _by_content(source, {name: each})


def _by_content(source: SourceFile, formats: Mapping[str, Format]) -> list[str]:
    letters = set(source.text) - set("\r\n")
    if not letters - {" "}:
        raise ConversionError("the text is blank")
    drawn = [name for name, each in formats.items() if each.codec.draws(source, letters)]
    if drawn or not looks_like_data(source.text):
        return drawn
    try:
        data = read_data(source)
    except ConversionError:
        # Sentences may begin with brackets or quotes as well, and lists of names as settings.
        first, is_text = source.text.lstrip()[0], source.name.lower().endswith((".txt", ".md"))
        if first in "('\"" or (is_text and first not in "[{"):
            return []
        raise
    return [name for name, each in formats.items() if each.codec.holds(data)][-1:]


class UnknownFormatError(ConversionError):
    """A text that is in none of the formats, or may be in several of them (`found`)."""

    def __init__(self, source: SourceFile, found: Sequence[str]):
        self.found = tuple(found)
        super().__init__(*_why_unknown(source, self.found))


def is_level(source: SourceFile) -> bool:
    """Return whether a YAML file has fields of levels, most of all: others have a version, too."""
    data: Any = None
    if source.name.lower().endswith(SUFFIXES_OF_LEVELS):
        with suppress(LevelError):
            data = read_yaml(source).data
    has_version = isinstance(data, dict) and data.get("version") == 1
    return has_version and 2 * len(data.keys() & _FIELDS) > len(data)


def _why_unknown(source: SourceFile, found: tuple[str, ...]) -> tuple[str, str]:
    """Return why the format of a text is unknown, and what to do about it."""
    name = one_line(source.name)
    if found:
        titles = " or a ".join(FORMATS[each].title for each in found)
        return f"{name} may be a {titles}", f"give its format: {' or '.join(found)}"
    if is_level(source):
        help_text = "use `babyrobot export` to convert it for other programs"
        return f"{name} is already a level file", help_text
    if source.name.lower().endswith(SUFFIXES_OF_LEVELS):
        return f"{name} is YAML, but no level", f"formats that are read: {', '.join(FORMATS)}"
    if source.text.lstrip().startswith("<"):
        return f"{name} is XML, but no map of Tiled", "write a level of it as a text"
    return f"the format of {name} is unknown", f"give its format, one of {', '.join(FORMATS)}"


def format_of(source: SourceFile) -> str:
    """Return the name of the format of a text, by its suffix or its content.

    Raises:
        UnknownFormatError: it is in none, or may be in several.
        ConversionError: it is blank, or looks like JSON or Python but is malformed.
    """
    found = guess(source)
    if len(found) != 1:
        raise UnknownFormatError(source, found)
    return found[0]


_ENVIRONMENT = re.compile(r"([\w.]+:)?(MiniGrid-|BabyAI-|FrozenLake)[\w./-]*-v\d+")


def is_environment(name: str) -> bool:
    """Return whether a name is the id of an environment that is imported, and no file's."""
    return _ENVIRONMENT.fullmatch(name) is not None and not Path(name).exists()


def world_of_id(env_id: str, seed: int, kwargs: Mapping[str, Any] | None) -> World:
    """Return the world of an environment: of MiniGrid, or a FrozenLake of Gymnasium.

    Raises:
        ComparisonError: it cannot be made.
        ConversionError: it cannot be a level.
    """
    from babyrobot_levels.analysis.environments import made, made_minigrid

    if "FrozenLake" in env_id:
        return frozen_lake.world_of_environment(made(env_id.rpartition(":")[2], kwargs))
    # Imported here as it needs NumPy.
    from babyrobot_levels.extensions.formats.minigrid import world_of_environment

    env = made_minigrid(env_id, seed, kwargs)
    try:
        return world_of_environment(env, env_id, seed)
    finally:
        env.close()


def _world_of_made(env: Any, seed: int) -> World:
    from babyrobot_levels.analysis.environments import is_minigrid

    inner = env.unwrapped
    if is_minigrid(inner):
        from babyrobot_levels.extensions.formats.minigrid import world_of_environment

        inner.reset(seed=seed)
        return world_of_environment(inner, env.spec.id, seed)
    if type(inner).__name__ == "FrozenLakeEnv":
        return frozen_lake.world_of_environment(env)
    name = type(inner).__name__
    raise ConversionError(f"{name} is neither an environment of MiniGrid nor a FrozenLake")


def _literal_of(data: Any) -> SourceFile:
    """Return data as a text: as a literal, as JSON has no bytes, which maps of lakes consist of."""
    data = data.tolist() if hasattr(data, "tolist") else data
    with suppress(LevelError):
        data = plain(data)
    return SourceFile("the data", repr(data), is_made=True)


def import_(
    source: Any,
    path: str | os.PathLike[str] | None = None,
    *,
    format: str | None = None,  # noqa: A002
    number: int | None = None,
    robots: int | None = None,
    name: str | None = None,
    seed: int = 0,
    kwargs: Mapping[str, Any] | None = None,
    slippery: bool | None = None,
    force: bool = False,
) -> Level:
    """Return the level of a file or of data of another program, as `babyrobot import` converts it.

    What a level cannot express is told in `ConversionWarning`s.

    Args:
        source: the path of the file; or what it would hold, as lists and mappings; or the id of an
            environment of MiniGrid or of a FrozenLake, or the environment itself.
        path: a level file to write.
        format: the format of the file, such as `"frozen-lake"`; by default it is detected.
        number: which world of a file with several, counted from 1; `read` returns all.
        robots: how many robots, of scenarios of MovingAI: the first so many are one level.
        name: the name of the level; by default that of the file.
        seed: the seed of the reset of an environment.
        kwargs: the keyword arguments of an environment.
        slippery: whether a FrozenLake map is slippery, if it does not say so; by default it is.
        force: whether to replace an existing file.

    Raises:
        ConversionError: the source is not in the format, or not in a known one.
        LevelError: the file cannot be read, or is no valid level.
        ValueError: there is no such format.
        FileExistsError: there is a file, and `force` is not given.
    """
    _check_format(format)
    file = single(Path(source)) if isinstance(source, str | os.PathLike) else None
    if isinstance(source, str) and is_environment(source):
        world = _world_of_id(source, seed, kwargs)
    elif file is None and hasattr(source, "unwrapped"):
        world = _world_of_made(source, seed)
    else:
        found, folder = (opened(file), file.folder) if file else (_literal_of(source), None)
        entry, given = FORMATS[format or format_of(found)], {"slippery": slippery, "folder": folder}
        world = entry.read(found, number=number, robots=robots, **given)
    own = name or (slug(Path(source).stem) if file else None)
    if path is not None:
        title = (own or "imported").replace("-", " ").capitalize()
        text = file_text(world, schema=schema_for(Path(path)), name=name, title=title)
        write_new(Path(path), text, force=force)
    return level_of(world, name=own)


def read(
    path: str | os.PathLike[str],
    *,
    format: str | None = None,  # noqa: A002
    slippery: bool | None = None,
) -> list[Level]:
    """Return all levels of a file, a folder or a zip file of other programs.

    What a level cannot express is told in `ConversionWarning`s, and so is what is in no known
    format, or is refused, in folders and zip files.

    Args:
        path: the file or folder.
        format: the format of the files, such as `"sokoban"`; by default each one's is detected.
        slippery: whether FrozenLake maps are slippery, if they do not say so; by default they are.

    Raises:
        ConversionError: a single file is not in the format, or not in a known one.
        LevelError: it cannot be read, or holds no valid level.
        ValueError: there is no such format.
    """
    _check_format(format)
    path = Path(path)
    is_many = is_folder(path) or is_archive(path)
    files = found_in(path) if is_many else [single(path)]
    levels: list[Level] = []
    for file in files:
        try:
            for place, world in worlds_of(file, format, slippery):
                try:
                    levels.append(level_of(world(), name=place.name))
                except LevelError as error:
                    if not is_many:
                        raise
                    warn(str(error), ConversionWarning)
        except LevelError as error:
            if not is_many:
                raise
            warn(str(error), ConversionWarning)
    return levels


def worlds_of(
    file: Found, chosen: str | None, slippery: bool | None = None
) -> Iterator[tuple[Path, Callable[[], World]]]:
    """Yield the worlds of a file, each with the path for its level, below that of all.

    A world is read when its function is called, so that one that is refused is no loss of others.

    Raises:
        ConversionError: the format is unknown, or not that of the file.
    """
    source = opened(file)
    entry = FORMATS[chosen or format_of(source)]
    parts = entry.parts(source)
    digits = len(str(len(parts)))
    for number, part in enumerate(parts, 1):
        numbered = f"{file.place.name}-{number:0{digits}}" if len(parts) > 1 else file.place.name
        read_it = partial(entry.read_part, source, part, slippery=slippery, folder=file.folder)
        yield file.place.with_name(numbered), read_it


def foreign_level(path: Path) -> Level | None:
    """Return the level of a file of another program; None if no format is that of the file.

    Raises:
        ConversionError: the file may be in several formats, or its world cannot be a level.
    """
    file = single(path)
    try:
        source = opened(file)
        found = guess(source)
    except LevelError:
        return None
    if not found:
        return None
    if len(found) > 1:
        message = str(UnknownFormatError(source, found)).partition("\n")[0]
        raise ConversionError(message, f"convert it: `babyrobot import FILE --from {found[0]}`")
    return level_of(FORMATS[found[0]].read(source, folder=path.parent), name=file.place.name)


def _check_format(chosen: str | None) -> None:
    if chosen is not None and chosen not in FORMATS:
        raise ValueError(no_format(chosen, FORMATS))


def _world_of_id(env_id: str, seed: int, kwargs: Mapping[str, Any] | None) -> World:
    from babyrobot_levels.analysis.environments import ComparisonError

    try:
        return world_of_id(env_id, seed, kwargs)
    except ComparisonError as error:
        raise ConversionError(str(error)) from error
