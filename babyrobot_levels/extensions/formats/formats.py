"""The formats of other programs, one entry each; levels written in them, and what is lost."""

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from babyrobot_levels.analysis.picture_formats import maker_of
from babyrobot_levels.extensions.formats import (
    block_maps,
    drawings,
    frozen_lake,
    karel,
    ldtk,
    letters,
    micromouse,
    minihack,
    movingai,
    setups,
    sokoban,
    tiled,
)
from babyrobot_levels.extensions.formats.conversion import (
    Codec,
    Conversion,
    ConversionError,
    Lost,
    Part,
    World,
)
from babyrobot_levels.language.fields import Role, fields_with
from babyrobot_levels.library.catalogue import LevelLike, load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.gridworld import check_one_robot
from babyrobot_levels.registry.entries import Entries
from babyrobot_levels.registry.own import own
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import write_new
from babyrobot_levels.text.source import SourceFile
from babyrobot_levels.text.words import no_format, unexpected

MAX_WORLDS = 10_000
"""The most worlds of one text: collections have hundreds, and each takes some milliseconds."""


MAX_LOST = 1_000
"""So much of what is lost is told one by one."""


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

    def parts(self, source: SourceFile) -> Sequence[Part]:
        """Return the worlds that a text holds, each as a text of its own.

        Raises:
            ConversionError: the text is not in this format, or has more than `MAX_WORLDS`.
        """
        parts = [Part(source.text)] if self.codec.parts is None else self.codec.parts(source)
        if len(parts) > MAX_WORLDS:
            message = f"the text has {len(parts):,} worlds; at most {MAX_WORLDS:,} are read"
            raise ConversionError(message, "split it into several files")
        return parts

    def read(
        self,
        source: SourceFile,
        *,
        number: int | None = None,
        robots: int | None = None,
        **given: Any,
    ) -> World:
        """Return the world of a text; of what is given, those that are not its keywords are left.

        Args:
            source: the text.
            number: which of its worlds, counted from 1; None for the only one.
            robots: how many of its worlds, which are then one of several robots.
            given: values of keywords.

        Raises:
            ConversionError: the text is not in this format, or has no such world, or several.
        """
        if robots is not None:
            if self.codec.team is None:
                raise ConversionError(f"a {self.title} has no several robots to choose from")
            return self.read_part(source, self.codec.team(source, robots), **given)
        parts = self.parts(source)
        if not 1 <= (number or 1) <= len(parts) or (number is None and len(parts) > 1):
            count = f"{len(parts)} worlds" if len(parts) != 1 else "one world"
            raise ConversionError(
                f"the text has {count}",
                "`babyrobot import` takes one with --number N, or all with -o FOLDER",
            )
        return self.read_part(source, parts[(number or 1) - 1], **given)

    def read_part(self, source: SourceFile, part: Part, **given: Any) -> World:
        """Return the world of a part of a text; see `read`."""
        keywords = {name: each for name, each in given.items() if name in self.keywords}
        try:
            world = self.codec.read(SourceFile(source.name, part.text), **keywords)
        except ConversionError:
            if part.line == 1:
                raise
            # So that the place is that in the text of all.
            whole = "\n" * (part.line - 1) + part.text
            return self.codec.read(SourceFile(source.name, whole), **keywords)
        if source.is_made:
            return replace(world, lost=tuple(replace(each, at=None) for each in world.lost))
        places = self.codec.places(source)
        lost = [replace(each, at=part.placed(each.at, places)) for each in world.lost[:MAX_LOST]]
        if len(world.lost) > MAX_LOST:
            lost.append(Lost("more", f"{len(world.lost) - MAX_LOST:,} further losses", lost[-1].at))
        return replace(world, file=source.name, lost=tuple(lost))

    def write(self, level: Level) -> Conversion:
        """Return a level in this format, without a check of what is lost; see `export`."""
        if self.codec.write is None:
            raise ValueError(f"levels are not written as a {self.title}")
        return self.codec.write(level)


_OWN = {
    "arc": Format("task of ARC", "tasks of ARC", letters.ARC),
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
    "gym-maze": Format(
        "maze of gym-maze", "mazes of gym-maze", micromouse.GYM_MAZE, suffixes=(".npy",)
    ),
    "karel": Format("world of Karel", "worlds of Karel", karel.CODEC),
    "ldtk": Format("level of LDtk", "LDtk's levels", ldtk.CODEC, suffixes=(".ldtk",)),
    "mettagrid": Format("map of MettaGrid", "MettaGrid's maps", letters.METTAGRID),
    "maz": Format(
        "micromouse maze of 256 bytes",
        "micromouse mazes of 256 bytes",
        micromouse.MAZ,
        suffixes=(".maz",),
        written_suffixes=(".maz",),
    ),
    "micromouse": Format("micromouse maze", "micromouse mazes", micromouse.MICROMOUSE),
    "minihack": Format("level of MiniHack", "MiniHack's levels", minihack.CODEC),
    "movingai": Format("map of MovingAI", "MovingAI's maps", movingai.CODEC, keywords=("folder",)),
    "overcooked": Format(
        "kitchen of Overcooked-AI", "Overcooked-AI's kitchens", letters.OVERCOOKED
    ),
    "rware": Format("warehouse of RWARE", "RWARE's warehouses", letters.RWARE),
    "vglc": Format("dungeon of the VGLC", "the VGLC's dungeons", letters.VGLC),
    "sokoban": Format(
        "map of # and blanks",
        "Sokoban maps (# and blanks)",
        sokoban.CODEC,
        suffixes=(".xsb", ".sok", ".slc"),
    ),
    "tiled": Format(
        "map of Tiled",
        "Tiled's maps",
        tiled.CODEC,
        suffixes=(".tmj", ".tmx"),
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
        ValueError: there is no such format, or no such sight; or the file is a picture's.
        TypeError: there is no such option.
        ImportError: the format needs an extra that is not installed.
        FileExistsError: there is a file, and `force` is not given.
    """
    found = load(level) if maze_seed is None else load(level).with_maze_seed(maze_seed)
    if format and path is not None and (maker := maker_of(path)):
        raise ValueError(f"{path} is no file of the format {format}: use {maker}")
    conversion = converted(found, format or _by_suffix(path), **seen)
    if path is not None:
        for beside, data in conversion.beside.items():
            write_new(Path(path).parent / beside, data, force=force)
        write_new(Path(path), conversion.content, force=force)
    return conversion


def _by_suffix(path: str | os.PathLike[str] | None) -> str:
    name = format_for("" if path is None else Path(path).suffix.lower())
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
        known = ("format", "path", "maze_seed", "force")
        raise TypeError(f"{unexpected('export', each, known)}; {name} holds no sight")
    if name in MODELS:
        return MODELS[name](level)
    check_one_robot(level, f"files of {name}")
    conversion = FORMATS[name].write(level)
    unsaid = _unsaid(level, conversion, name)
    if unsaid is None:
        return conversion
    return replace(conversion, warnings=(*conversion.warnings, Lost("MDP", unsaid)))


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
