"""The formats: which ones there are, which one a text is in, and reading and writing them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any

from babyrobot_levels.analysis.compare import compare
from babyrobot_levels.convert.babyrobot.reading import KEYWORDS as SETUP_KEYWORDS
from babyrobot_levels.convert.babyrobot.reading import read_setup
from babyrobot_levels.convert.babyrobot.writing import write_setup
from babyrobot_levels.convert.block_maps import (
    read_maze_dataset,
    read_maze_map,
    read_sokoban,
    write_maze_dataset,
    write_maze_map,
    write_sokoban,
)
from babyrobot_levels.convert.blocks import is_lattice, text_rows
from babyrobot_levels.convert.conversion import Conversion, ConversionError, Lost, World
from babyrobot_levels.convert.data import looks_like_data, mapping, read_data
from babyrobot_levels.convert.frozen_lake import KEYWORDS as LAKE_KEYWORDS
from babyrobot_levels.convert.frozen_lake import LETTERS, read_frozen_lake, write_frozen_lake
from babyrobot_levels.convert.minigrids.text import read_minigrid, write_minigrid
from babyrobot_levels.convert.tiled.reading import is_tiled, read_tiled
from babyrobot_levels.convert.tiled.writing import write_tiled
from babyrobot_levels.language.fields import Role, fields_with
from babyrobot_levels.library.level import Level
from babyrobot_levels.suites.checking import errors_of
from babyrobot_levels.text.emitter import emit_field
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import source_of
from babyrobot_levels.text.source import SourceFile


@dataclass(frozen=True, slots=True)
class Format:
    """A format: its title, and how it is read and written."""

    title: str
    read: Callable[[SourceFile], World]
    write: Callable[[Level], Conversion]


def _read_babyrobot(source: SourceFile) -> World:
    return read_setup(mapping(read_data(source), "the setup"))


FORMATS = {
    "babyrobot": Format("keyword setup of PyPI babyrobot", _read_babyrobot, write_setup),
    "frozen-lake": Format("FrozenLake map", read_frozen_lake, write_frozen_lake),
    "maze-map": Format("Gymnasium-Robotics maze_map", read_maze_map, write_maze_map),
    "maze-dataset": Format("maze-dataset ASCII", read_maze_dataset, write_maze_dataset),
    "minigrid": Format("MiniGrid text", read_minigrid, write_minigrid),
    "sokoban": Format("map of # and blanks", read_sokoban, write_sokoban),
    "tiled": Format("Tiled map in JSON", read_tiled, write_tiled),
}

SUFFIXES = {".tmj": "tiled", ".xsb": "sokoban", ".sok": "sokoban"}
"""File suffixes that say which format a file has."""

_LOOKS = (*fields_with(Role.TEXT, Role.LIMIT, Role.LOOK), "maze", "walls.color")
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


def export(level: Level, name: str) -> Conversion:
    """Return a level in another format.

    The warnings list everything that the format cannot hold. The result is read again and its
    tables are compared with those of the level, in which what warnings name is as in the result: a
    difference is a warning too.

    Args:
        level: the level.
        name: a name of `FORMATS`.

    Raises:
        LevelError: the level's maze has no seed yet (`seed: random`).
    """
    conversion = FORMATS[name].write(level)
    unsaid = _unsaid(level, conversion, name)
    if unsaid is None:
        return conversion
    lost = (*conversion.warnings, Lost("MDP", unsaid))
    return Conversion(conversion.text, lost, conversion.beside)


def _unsaid(level: Level, conversion: Conversion, name: str) -> str | None:
    """Return a difference of a result that its warnings do not explain, None if there is none."""
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


def file_text(world: World, *, schema: str | None, name: str | None, title: str) -> str:
    """Return the text of a level file.

    Args:
        world: its content.
        schema: where editors find the JSON schema, for the file's first line; None for no line.
        name: the level's name, None to use that of the file.
        title: the level's title, if the world has none.

    Raises:
        ConversionError: the world is too large for a file.
        LevelError: it is not a valid level.
    """
    fields = {"version": 1, **({"name": name} if name else {}), "title": title, **world.fields}
    if name:
        fields["name"] = name
    lines = [f"# yaml-language-server: $schema={schema}\n"] if schema else []
    lines.append(f"# {world.origin}\n")
    for field, value in fields.items():
        if field in world.comments:
            lines.append(f"# {world.comments[field]}\n")
        lines.append(emit_field(field, value))
    return _tidy("".join(lines))


def _tidy(text: str) -> str:
    """Return a level's text as `babyrobot lint --fix` and `babyrobot format` leave it."""
    # Here, because exporting does not need the linter.
    from babyrobot_levels.language.formatting.formatter import format_source
    from babyrobot_levels.linter.fixer import fix
    from babyrobot_levels.linter.registry import select

    try:
        source = source_of(text.encode("utf-8"), "<imported>")
    except LevelError as error:
        raise ConversionError(
            f"the level would be too large for one file: {error.diagnostics[0].message}",
            "a drawing takes eight characters a cell, so it has room for some 360 by 360 cells",
        ) from None
    errors = errors_of(source)
    if errors:
        raise ConversionError("this is not a valid level:\n" + "\n".join(map(str, errors[:5])))
    fixed = fix(source, select(None)).text
    return format_source(SourceFile(source.name, fixed)).text


def guess(source: SourceFile) -> list[str]:
    """Return the names of the formats that a text may be in, by its suffix or its content.

    Raises:
        ConversionError: it is blank, or looks like JSON or Python but is malformed.
    """
    suffix = PurePath(source.name).suffix.lower()
    if suffix in SUFFIXES:
        return [SUFFIXES[suffix]]
    return list(_of_text(source) or _of_data(source))


def _of_text(source: SourceFile) -> list[str]:
    """Return the formats of a drawn map, none if the text is not one."""
    letters = set(source.text) - set("\r\n")
    if not letters - {" "}:
        raise ConversionError("the text is blank")
    if letters <= {*LETTERS, " ", "\t"}:
        return ["frozen-lake"]
    if letters <= set("#SEX "):
        lines = text_rows(source)
        fits = is_lattice(tuple(line.replace("S", "E").replace("X", " ") for line in lines))
        has_path = {"S", "E", "X"} <= letters
        return [*(["maze-dataset"] if fits else []), *([] if fits and has_path else ["sokoban"])]
    if letters <= set("#@.$*+-_SEX "):
        return ["sokoban"]
    if "WG" in source.text and letters <= set("WGVFDLKABRPY><^_ "):
        return ["minigrid"]
    return []


def _of_data(source: SourceFile) -> Iterator[str]:
    if not looks_like_data(source.text):
        return
    data = read_data(source)
    if is_tiled(data):
        yield "tiled"
    elif isinstance(data, dict):
        if data.keys() & LAKE_KEYWORDS:
            yield "frozen-lake"
        elif not data or data.keys() & SETUP_KEYWORDS:
            yield "babyrobot"
    elif isinstance(data, list | tuple) and data:
        cells = [cell for row in data if isinstance(row, list | tuple | str) for cell in row]
        letters = {c.decode("latin-1") if isinstance(c, bytes) else str(c) for c in cells}
        if letters <= LETTERS.keys():
            yield "frozen-lake"
        elif letters <= {"0", "1", "r", "g", "c"}:
            yield "maze-map"
