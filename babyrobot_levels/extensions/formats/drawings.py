"""The drawings that the program itself prints: walls and cells, and below them what marks mean."""

import re
from dataclasses import replace

from babyrobot_levels.extensions.formats.conversion import Codec, ConversionError, Lost, World
from babyrobot_levels.extensions.formats.micromouse import is_micromouse
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.base import MAX_SIZE
from babyrobot_levels.language.parsing import parse
from babyrobot_levels.text.diagnostics import Mark
from babyrobot_levels.text.source import Position, SourceFile

_BORDER = re.compile(r"\s*\+(---\+)+\s*")
_KNOWN = {d.PLAIN, d.BLOCKED, d.START, d.EXIT, d.SMALL, d.LARGE}


def read_drawing(source: SourceFile) -> World:
    """Return the world of a drawing; what stands around it is left out.

    Raises:
        ConversionError: the text has no drawing, or a faulty one.
    """
    borders = [number for number, line in enumerate(source.lines) if _BORDER.fullmatch(line)]
    first, last = min(borders, default=0), max(borders, default=0)
    drawing, faults = parse("\n".join(source.lines[first : last + 1]), str.isprintable, MAX_SIZE)
    if drawing is None:
        fault = faults[0].location
        assert isinstance(fault, Mark)
        place = Position(first + fault.row + 1, fault.column + 1)
        raise ConversionError.at(source, place, faults[0].message, faults[0].help)
    marks = dict.fromkeys(mark for row in drawing.cells for mark in row if mark not in _KNOWN)
    border = source.lines[first]
    line, column = first + 2, len(border) - len(border.lstrip()) + 3
    lost = []
    for mark in marks:
        x, y = drawing.find(mark)[0]
        place = Position(line + 2 * y, column + 4 * x)
        lost.append(Lost(f"`{mark}`", "a plain cell: what it means is not drawn", place))
    walls = (drawing.east, drawing.south)
    doors = [
        Position(line + 2 * y + index, column + 4 * x + 2 * (1 - index))
        for index, rows in enumerate(walls)
        for x, y in d.cells_with(rows, d.DOOR)
    ]
    if doors:
        lost.append(Lost("doors", "left out: what they need is not drawn", doors[0]))
    plain, opened = str.maketrans(dict.fromkeys(marks, d.PLAIN)), str.maketrans(d.DOOR, d.OPEN)
    east, south = (tuple(row.translate(opened) for row in rows) for rows in walls)
    cells = tuple(row.translate(plain) for row in drawing.cells)
    text = d.compose(replace(drawing, cells=cells, east=east, south=south))
    return World({"version": 1, "map": text}, "A drawing of a level.", {}, tuple(lost))


def _is_drawing(source: SourceFile, _: set[str]) -> bool:
    first = next(filter(str.strip, source.lines), "")
    return _BORDER.fullmatch(first) is not None and not is_micromouse(source)


CODEC = Codec(read_drawing, draws=_is_drawing)
