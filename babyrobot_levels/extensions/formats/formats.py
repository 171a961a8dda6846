"""The formats of other programs, one entry each; levels from and to them, and what is lost."""

import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import Any

from babyrobot_levels.extensions.formats import block_maps, drawings, frozen_lake, setups, tiled
from babyrobot_levels.extensions.formats.conversion import (
    Codec,
    Conversion,
    ConversionError,
    Lost,
    World,
    file_text,
    level_of,
    looks_like_data,
    read_data,
)
from babyrobot_levels.language.fields import Role, fields_with
from babyrobot_levels.language.names import slug
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.library.catalogue import LevelLike, load
from babyrobot_levels.library.level import Level
from babyrobot_levels.registry.entries import Entries
from babyrobot_levels.registry.own import own
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import SUFFIXES as SUFFIXES_OF_LEVELS
from babyrobot_levels.text.files import read_source, schema_for, write_new
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile
from babyrobot_levels.text.words import no_format


@dataclass(frozen=True, slots=True)
class Format:
    """A format.

    Attributes:
        title: what one text is: "FrozenLake map".
        texts: what is read, for the help of the command line: "FrozenLake maps".
        codec: how it is read, written and recognised.
        suffixes: suffixes of files that are in this format, whatever they contain.
        written_suffixes: suffixes of files that levels are written to in this format.
        keywords: the keywords that reading takes: `slippery`, whether moves slip if the text does
            not say so, and `folder`, the folder of the file, of which others are read.
    """

    title: str
    texts: str
    codec: Codec
    suffixes: tuple[str, ...] = ()
    written_suffixes: tuple[str, ...] = ()
    keywords: tuple[str, ...] = ()

    @property
    def is_written(self) -> bool:
        """Whether levels are written in it."""
        return self.codec.write is not None

    def read(self, source: SourceFile, **given: Any) -> World:
        """Return the world of a text; of what is given, those that are not its keywords are left.

        Raises:
            ConversionError: the text is not in this format.
        """
        keywords = {name: each for name, each in given.items() if name in self.keywords}
        return self.codec.read(source, **keywords)

    def write(self, level: Level) -> Conversion:
        """Return a level in this format, without a check of what is lost; see `export`."""
        if self.codec.write is None:
            raise ValueError(f"levels are not written as a {self.title}")
        return self.codec.write(level)


_OWN = {
    "babyrobot": Format(
        "keyword setup of PyPI babyrobot", "setups of PyPI babyrobot", setups.CODEC
    ),
    "drawing": Format("drawing of a level", "drawings of levels", drawings.CODEC),
    "frozen-lake": Format(
        "FrozenLake map", "FrozenLake maps", frozen_lake.CODEC, keywords=("slippery",)
    ),
    "maze-map": Format(
        "Gymnasium-Robotics maze_map", "Gymnasium-Robotics' maze maps", block_maps.MAZE_MAP
    ),
    "maze-dataset": Format("maze-dataset ASCII", "maze-dataset's ASCII", block_maps.MAZE_DATASET),
    "minigrid": Format("MiniGrid text", "MiniGrid's text", block_maps.MINIGRID),
    "sokoban": Format(
        "map of # and blanks",
        "Sokoban maps (# and blanks)",
        block_maps.SOKOBAN,
        suffixes=(".xsb", ".sok"),
    ),
    "tiled": Format(
        "Tiled map in JSON",
        "Tiled's JSON",
        tiled.CODEC,
        suffixes=(".tmj",),
        written_suffixes=(".tmj",),
        keywords=("folder",),
    ),
}
"""The formats by name. Of several that hold the same data, a later one is the more particular."""

FORMATS = Entries("formats", _OWN, lambda each: isinstance(each, Format))
"""The same, and those of extensions."""


def _prism(level: Level) -> Conversion:
    # Imported here as the tables need NumPy, which other formats do without.
    from babyrobot_levels.extensions.formats.prism import write_prism

    return write_prism(level)


def _umb(level: Level) -> Conversion:
    from babyrobot_levels.extensions.formats.umb import write_umb

    return write_umb(level)


def _pomdp(name: str) -> Callable[..., Conversion]:
    return lambda level, **seen: own("export_sight")(level, name, **seen)


PARTIAL = {name: _pomdp(name) for name in ("pomdp", "pomdp-prism", "pomdp-drn")}
"""What writes levels with a sight, for solvers of partially observable processes."""

MODELS: Mapping[str, Callable[..., Conversion]] = {"prism": _prism, "umb": _umb, **PARTIAL}
"""What writes levels for model checkers and for solvers of processes, by the format."""

SUFFIXES = {
    **{suffix: name for name, each in _OWN.items() for suffix in each.written_suffixes},
    **{f".{name}": name for name in ("prism", "umb", "pomdp")},
}
"""The formats of files that levels are written to, by their suffixes."""


def written() -> list[str]:
    """Return the names of the formats that levels are written in."""
    others = (name for name, each in FORMATS.added() if each.is_written)
    return [*(name for name, each in _OWN.items() if each.is_written), *MODELS, *others]


def is_written(name: str) -> bool:
    """Return whether levels are written in a format of this name."""
    return name in MODELS or (name in FORMATS and FORMATS[name].is_written)


def format_for(suffix: str) -> str | None:
    """Return the name of the format of a file that a level is written to, None if it has none."""
    if suffix in SUFFIXES:
        return SUFFIXES[suffix]
    others = (name for name, each in FORMATS.added() if suffix in each.written_suffixes)
    return next(others, None)


_PLAIN = ("", ".txt", ".json", ".py", *SUFFIXES_OF_LEVELS)
"""Suffixes that say nothing of a format."""


def guess(source: SourceFile) -> list[str]:
    """Return the names of the formats that a text may be in, by its suffix or its content.

    Raises:
        ConversionError: it is blank, or looks like JSON or Python but is malformed.
    """
    suffix = PurePath(source.name).suffix.lower()
    others = () if suffix in _PLAIN else FORMATS.added()
    for formats in (_OWN.items(), others):
        by_suffix = [name for name, each in formats if suffix in each.suffixes]
        if by_suffix:
            return by_suffix
    return _by_content(source, _OWN) or [*_by_extensions(source)]


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
        # Sentences may begin with brackets or quotes as well.
        if source.text.lstrip()[0] in "('\"":
            return []
        raise
    return [name for name, each in formats.items() if each.codec.holds(data)][-1:]


class UnknownFormatError(ConversionError):
    """A text that is in none of the formats, or may be in several of them (`found`)."""

    def __init__(self, source: SourceFile, found: Sequence[str]):
        self.found = tuple(found)
        super().__init__(*_why_unknown(source, self.found))


def _why_unknown(source: SourceFile, found: tuple[str, ...]) -> tuple[str, str]:
    """Return why the format of a text is unknown, and what to do about it."""
    name = one_line(source.name)
    if found:
        titles = " or a ".join(FORMATS[each].title for each in found)
        return f"{name} may be a {titles}", f"give its format: {' or '.join(found)}"
    if source.name.lower().endswith(SUFFIXES_OF_LEVELS):
        with suppress(LevelError):
            data = read(source).data
            if isinstance(data, dict) and data.get("version") == 1:
                return (
                    f"{name} is already a level file",
                    "use `babyrobot export` to convert it for other programs",
                )
        return f"{name} is YAML, but no level", f"formats that are read: {', '.join(FORMATS)}"
    if source.text.lstrip().startswith("<"):
        help_text = "write a level of it as a text"
        if "<map" in source.text:
            help_text = "in Tiled, save the map as JSON (.tmj)"
        return f"{name} is XML, which is not read", help_text
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
    return SourceFile("the data", repr(data))


def import_(
    source: Any,
    path: str | os.PathLike[str] | None = None,
    *,
    format: str | None = None,  # noqa: A002
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
    is_data = not isinstance(source, str | os.PathLike)
    world = _world(source, format, seed, kwargs, slippery)
    own = name or (None if is_data else slug(Path(source).stem))
    if path is not None:
        title = (own or "imported").replace("-", " ").capitalize()
        text = file_text(world, schema=schema_for(Path(path)), name=name, title=title)
        write_new(Path(path), text, force=force)
    return level_of(world, name=own)


def _world(
    source: Any,
    chosen: str | None,
    seed: int,
    kwargs: Mapping[str, Any] | None,
    slippery: bool | None,
) -> World:
    folder: Path | None = None
    if isinstance(source, str) and is_environment(source):
        from babyrobot_levels.analysis.environments import ComparisonError

        try:
            return world_of_id(source, seed, kwargs)
        except ComparisonError as error:
            raise ConversionError(str(error)) from error
    if isinstance(source, str | os.PathLike):
        text, folder = read_source(Path(source)), Path(source).parent
    elif hasattr(source, "unwrapped"):
        return _world_of_made(source, seed)
    else:
        text = _literal_of(source)
    if chosen is not None and chosen not in FORMATS:
        raise ValueError(no_format(chosen, FORMATS))
    return FORMATS[chosen or format_of(text)].read(text, slippery=slippery, folder=folder)


# -- export ----------------------------------------------------------------------------------------

_LOOKS = (*fields_with(Role.TEXT, Role.LIMIT, Role.LOOK, Role.EXPECTATION), "maze", "walls.color")
"""Prefixes of the fields whose loss does not change the MDP."""

_WALLS = ("maze", "walls", "openings")
_TOGETHER = {
    "walls": _WALLS,
    "blocked": ("blocked", *_WALLS),
    "exit_one_of": ("exit_one_of", "exit"),
}
"""Fields that are lost together."""

_OF_AREAS = ("reward", "skid", "ends")
"""What areas have beside looks."""


def export(
    level: LevelLike,
    format: str | None = None,  # noqa: A002
    path: str | os.PathLike[str] | None = None,
    *,
    maze_seed: int | None = None,
    force: bool = False,
    **seen: Any,
) -> Conversion:
    """Return a level in the format of another program, as `babyrobot export` writes it.

    The warnings list everything that the format cannot hold. The result is read again (but that of
    model checkers and solvers) and its tables are compared with those of the level, in which what
    warnings name is as in the result: a difference is a warning too.

    Args:
        level: a name, a path, a share code, a mapping, or a level.
        format: the format, such as `"frozen-lake"`; by default by the suffix of the file.
        path: a file to write it to, and beside it what belongs to it.
        maze_seed: the seed of the maze of a level with a random maze.
        force: whether to replace existing files.
        seen: for the formats `pomdp`, `pomdp-prism` and `pomdp-drn`: `sight`, what the agent
            observes, by default `"view"`, and the options of the observation, such as
            `view_radius`.

    Raises:
        LevelNotFoundError: nothing has that name.
        LevelError: the level is not valid, or its maze has no seed yet (`seed: random`).
        ValueError: there is no such format, or no such sight.
        TypeError: there is no such option.
        ImportError: the format needs an extra that is not installed.
        FileExistsError: there is a file, and `force` is not given.
    """
    found = load(level) if maze_seed is None else load(level).with_maze_seed(maze_seed)
    conversion = converted(found, format or _by_suffix(path), **seen)
    if path is not None:
        for beside, data in conversion.beside.items():
            write_new(Path(path).parent / beside, data, force=force)
        write_new(Path(path), conversion.content, force=force)
    return conversion


def _by_suffix(path: str | os.PathLike[str] | None) -> str:
    suffix = "" if path is None else Path(path).suffix.lower()
    name = format_for(suffix)
    if name is None:
        raise ValueError("give the format: one of " + ", ".join(written()))
    return name


def converted(level: Level, name: str, **seen: Any) -> Conversion:
    """Return a level in a format by its name; see `export`."""
    if not is_written(name):
        raise ValueError(no_format(name, written()))
    if name in PARTIAL:
        return PARTIAL[name](level, **seen)
    for each in seen:
        raise TypeError(f"unexpected option {each!r}: {name} holds no sight")
    if name in MODELS:
        return MODELS[name](level)
    conversion = FORMATS[name].write(level)
    unsaid = _unsaid(level, conversion, name)
    if unsaid is None:
        return conversion
    lost = (*conversion.warnings, Lost("MDP", unsaid))
    return Conversion(conversion.text, lost, conversion.beside)


def _unsaid(level: Level, conversion: Conversion, name: str) -> str | None:
    """Return a difference of a result that its warnings do not explain, None if there is none."""
    from babyrobot_levels.analysis.compare import compare

    try:
        source = SourceFile("<exported>", conversion.text)
        again = Level.from_fields(FORMATS[name].read(source).fields)
        is_open = not any(getattr(level, key) for key in _WALLS)
        told_of_walls = any(lost.field == "walls" for lost in conversion.warnings)
        if again.size != level.size and told_of_walls and not is_open:
            # Walls became cells. What else is lost shows without them.
            fields = {key: each for key, each in _of_mdp(level).items() if key not in _WALLS}
            rest = Level.from_fields(fields)
            return _unsaid(rest, FORMATS[name].write(rest), name)
        told = level
        if conversion.warnings:
            told = Level.from_fields(_as_told(level, again, conversion))
    except LevelError:
        # It is too large to be read, or what it comes to is not valid.
        return None
    if told.digest == again.digest:
        return None
    found = compare(told, again)
    if found.equal and found.everywhere:
        # Probabilities differ in their last digits only.
        return None
    return found.difference or "cells that no episode reaches differ"


def _of_mdp(level: Level) -> dict[str, Any]:
    """Return the fields of a level that its tables come from, as plain data, without a drawing."""
    names = {*fields_with(Role.GEOMETRY, Role.DYNAMICS, Role.REWARD)} - {"map", "legend"}
    fields = level.model_dump(by_alias=True, exclude_none=True, include=names)
    for name, value in fields.items():
        if isinstance(value, tuple) and value and isinstance(value[0], dict):
            # Only what is given: a wall with `pass: 0` replaces glass, one without does not.
            given = {"by_alias": True, "exclude_unset": True, "exclude_none": True}
            fields[name] = tuple(each.model_dump(**given) for each in getattr(level, name))
    if "exit_one_of" in fields:
        del fields["exit"]
    return {"version": 1, **fields}


def _as_told(level: Level, again: Level, conversion: Conversion) -> dict[str, Any]:
    """Return the fields of a level in which what warnings name is as in the result."""
    fields, result = _of_mdp(level), _of_mdp(again)
    for lost in conversion.warnings:
        name, *parts = lost.field.split(".")
        if lost.field.startswith(_LOOKS):
            continue
        if name == "areas":
            _take_areas(fields, result, parts[0])
        elif name in _TOGETHER:
            for each in _TOGETHER[name]:
                _take(fields, result, [each])
        else:
            _take(fields, result, [name, *parts])
    return fields


def _take(fields: dict[str, Any], result: dict[str, Any], keys: list[str]) -> None:
    """Have the value under some keys, one inside the other, as in the result."""
    key, *others = keys
    inner, new = fields.get(key), result.get(key)
    if others and isinstance(inner, dict) and isinstance(new, dict):
        _take(inner, new, others)
    elif new is None:
        fields.pop(key, None)
    else:
        fields[key] = new


def _take_areas(fields: dict[str, Any], result: dict[str, Any], part: str) -> None:
    """Take a property from all areas; those that end the episode share the reward of the result."""
    ends = [area for area in result["areas"] if area.get("ends")]
    for area in fields["areas"]:
        area.pop(part, None)
        if part == "reward" and area.get("ends") and ends:
            area.update({key: ends[0][key] for key in (part,) if key in ends[0]})
    fields["areas"] = [area for area in fields["areas"] if not area.keys().isdisjoint(_OF_AREAS)]
