"""Levels in the formats of other programs, with everything that is lost."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from babyrobot_levels.analysis.compare import compare
from babyrobot_levels.convert.conversion import Conversion, Lost
from babyrobot_levels.convert.formats import FORMATS
from babyrobot_levels.language.fields import Role, fields_with
from babyrobot_levels.library.catalogue import LevelLike, load
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import write_new
from babyrobot_levels.text.source import SourceFile

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


def export(
    level: LevelLike,
    format: str | None = None,  # noqa: A002
    path: str | os.PathLike[str] | None = None,
    *,
    maze_seed: int | None = None,
    force: bool = False,
) -> Conversion:
    """Return a level in the format of another program, as `babyrobot export` writes it.

    The warnings list everything that the format cannot hold. The result is read again and its
    tables are compared with those of the level, in which what warnings name is as in the result: a
    difference is a warning too.

    Args:
        level: a name, a path, a share code, a mapping, or a level.
        format: the format, such as `"frozen-lake"`; by default by the suffix of the file.
        path: a file to write it to, and beside it what belongs to it.
        maze_seed: the seed of the maze of a level with a random maze.
        force: whether to replace existing files.

    Raises:
        LevelNotFoundError: nothing has that name.
        LevelError: the level is not valid, or its maze has no seed yet (`seed: random`).
        ValueError: there is no such format.
        FileExistsError: there is a file, and `force` is not given.
    """
    found = load(level) if maze_seed is None else load(level).with_maze_seed(maze_seed)
    conversion = converted(found, format or _by_suffix(path))
    if path is not None:
        for beside, data in conversion.beside.items():
            write_new(Path(path).parent / beside, data, force=force)
        write_new(Path(path), conversion.text, force=force)
    return conversion


def _by_suffix(path: str | os.PathLike[str] | None) -> str:
    suffix = "" if path is None else Path(path).suffix.lower()
    found = [name for name, each in FORMATS.items() if suffix in each.written_suffixes]
    if not found:
        raise ValueError("give the format: one of " + ", ".join(_written()))
    return found[0]


def _written() -> list[str]:
    return [name for name, each in FORMATS.items() if each.is_written]


def converted(level: Level, name: str) -> Conversion:
    """Return a level in a format by its name; see `export`."""
    if name not in _written():
        raise ValueError(f"there is no format {name!r}; use one of {', '.join(_written())}")
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
