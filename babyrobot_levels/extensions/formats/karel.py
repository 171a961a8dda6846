"""Worlds of Karel the robot (`.w`): walls between cells, beepers, and where Karel stands."""

import re
from typing import Any

from babyrobot_levels.extensions.formats.blocks import (
    Edge,
    edge_of,
    edge_runs,
    is_inner,
    side_entry,
)
from babyrobot_levels.extensions.formats.conversion import Codec, ConversionError, Lost, World
from babyrobot_levels.language.base import MAX_SIZE
from babyrobot_levels.text.source import Position, SourceFile

_LINE = re.compile(r"(\w+): *(?:\((\d{1,4}), *(\d{1,4})\))? *;? *(.*)")
_SIZE = re.compile(r"(?mi)^ *dimension: *\((\d{1,6}), *(\d{1,6})\)")
_SIDES = {"north": "N", "east": "E", "south": "S", "west": "W"}
_KNOWN = ("dimension", "karel", "wall", "beeper", "beeperbag", "speed", "color")
_HELP = "for example `Dimension: (8, 8)`, `Wall: (3, 2); west`, `Karel: (1, 1); east`"

MAX_ITEMS = 8
"""So many beepers become items: each of them doubles the states."""


def read_karel(source: SourceFile) -> World:
    """Return the world of a file, whose cells are counted from 1, from the bottom left.

    Raises:
        ConversionError: a line is not of the format, or names a cell that there is not.
    """
    size, start, heading = _size(source), (1, 1), "E"
    walls: set[Edge] = set()
    beepers: dict[tuple[int, int], str] = {}
    places: dict[tuple[int, int], Position] = {}
    colors: list[Position] = []
    lost = [Lost("task", "it is no part of such a file: the level has no exit")]
    for number, line in enumerate(source.lines, 1):
        match, place = _LINE.fullmatch(line.strip()), Position(number, 1)
        if not line.strip():
            continue
        name = match[1].lower() if match else ""
        if match is None or name not in _KNOWN:
            raise ConversionError.at(source, place, "this is no line of a world of Karel", _HELP)
        if name == "beeperbag":
            lost.append(Lost(name, "what Karel carries is left out", place))
        if name in ("beeperbag", "speed", "dimension"):
            continue
        cell, rest = (int(match[2] or 0), int(match[3] or 0)), match[4].strip().lower()
        if not all(1 <= each <= most for each, most in zip(cell, size, strict=True)):
            raise ConversionError.at(source, place, "this is no cell of the world", _HELP)
        if name in ("wall", "karel") and rest not in _SIDES:
            raise ConversionError.at(source, place, "the direction is missing", _HELP)
        if name == "karel":
            start, heading = cell, _SIDES[rest]
        elif name == "wall":
            walls.add(edge_of(cell[0] - 1, size[1] - cell[1], _SIDES[rest]))
        elif name == "beeper":
            beepers[cell], places[cell] = rest, place
        else:
            colors.append(place)
    at = {cell: [cell[0] - 1, size[1] - cell[1]] for cell in (start, *beepers)}
    there = [cell for cell, count in beepers.items() if count != "0"]
    if len(there) > MAX_ITEMS:
        message = f"{len(there)} left out; at most {MAX_ITEMS} become items"
        lost.append(Lost("beepers", message, places[there[0]]))
        there = []
    elif there:
        message = "one is taken by stepping onto it; there, by an action"
        lost.append(Lost("beepers", message, places[there[0]]))
    if several := [cell for cell in there if beepers[cell] != "1"]:
        message = f"of several in a cell, one is kept (in {len(several)} cells)"
        lost.append(Lost("beepers", message, places[several[0]]))
    if colors:
        lost.append(Lost("color", f"{len(colors)} painted cells are left out", colors[0]))
    fields: dict[str, Any] = {"version": 1, "size": [*size], "start": at[start], "exit": "none"}
    fields |= {"heading": heading} if heading != "E" else {}
    inner: dict[Edge, dict[str, Any]] = {edge: {} for edge in walls if is_inner(*edge, *size)}
    runs = [side_entry(*edge, length) for edge, length, _ in edge_runs(inner)]
    items = [
        {"name": f"beeper-{number}", "at": at[cell], "shape": "gem"}
        for number, cell in enumerate(there, 1)
    ]
    fields |= {name: entries for name, entries in (("walls", runs), ("items", items)) if entries}
    return World(fields, "A world of Karel.", {}, tuple(lost))


def _size(source: SourceFile) -> tuple[int, int]:
    match = _SIZE.search(source.text)
    if match is None:
        raise ConversionError("the world has no line `Dimension: (width, height)`", _HELP)
    width, height = int(match[1]), int(match[2])
    if not (1 <= width <= MAX_SIZE and 1 <= height <= MAX_SIZE):
        raise ConversionError(f"the world is {width} by {height}; a level is 1 to {MAX_SIZE}")
    return width, height


def _is_karel(source: SourceFile, _: set[str]) -> bool:
    lines = [line for line in source.lines if line.strip()]
    return _SIZE.search(source.text) is not None and all(
        (match := _LINE.fullmatch(line.strip())) and match[1].lower() in _KNOWN for line in lines
    )


CODEC = Codec(read_karel, draws=_is_karel)
