"""Mazes of `#` and blanks, as Sokoban and many small programs have them: walls fill cells."""

from __future__ import annotations

import re
from itertools import groupby
from typing import Any

from babyrobot_levels.convert.blocks import (
    drawn,
    text_rows,
    translated,
    without_ring,
    without_surroundings,
)
from babyrobot_levels.convert.conversion import Conversion, ConversionError, Lost, World
from babyrobot_levels.convert.marks import block_map
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.moves import Rewards
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.source import SourceFile

PLACE = "a Sokoban map"
BOXES = "$*"
ON_GOAL = "+"
_CELLS = {"#": d.BLOCKED, " ": d.PLAIN, "-": d.PLAIN, "_": d.PLAIN, "$": d.PLAIN}
_CELLS |= {"@": d.START, "S": d.START, ON_GOAL: d.START}
_CELLS |= {".": d.EXIT, "E": d.EXIT, "X": d.EXIT, "*": d.EXIT}
_STARTS = {mark for mark, cell in _CELLS.items() if cell == d.START}
_COMMENT = ";"
_SAYING = re.compile(r"([A-Za-z][A-Za-z ]*):\s*(.*?)\s*$")
_KNOWN = "`#` wall, a blank (or `-`) free, @ or S start, `.` E or X exit, $ and * boxes"


def read_sokoban(source: SourceFile) -> World:
    """Return the world of a map: its walls are blocked cells, and so is all outside of them.

    Lines of comments and of `Title:`, as files of Sokoban levels have them, may stand around it.
    """
    said: dict[str, Any] = {}
    lost: list[Lost] = []
    drawn_only = _map_of(source, said, lost)
    lines = text_rows(drawn_only)
    rows = translated(drawn_only, lines, _CELLS, _KNOWN)
    fields = {"version": 1, **said, **drawn(without_ring(without_surroundings(rows)))}
    text = "".join(lines)
    if any(box in text for box in BOXES):
        lost.append(Lost("boxes", "they are left out: their cells are free"))
    if ON_GOAL in text:
        lost.append(Lost(ON_GOAL, "a start cannot be an exit: it is only the start"))
    return World(fields, "A map of `#` and blanks.", {}, tuple(lost))


def _map_of(source: SourceFile, said: dict[str, Any], lost: list[Lost]) -> SourceFile:
    """Return the text with blank lines for all that is no map; what these say is put into `said`.

    Raises:
        ConversionError: there are several maps, with blank lines between them.
    """
    lines = []
    for line in source.lines:
        keyword = _SAYING.match(line)
        if keyword is None and not line.startswith(_COMMENT):
            lines.append(line)
            continue
        lines.append("")
        name = keyword[1].lower() if keyword is not None else _COMMENT
        if keyword is not None and name in ("title", "author") and keyword[2]:
            said[name] = keyword[2]
        elif all(each.field != name for each in lost):
            lost.append(Lost(name, "what the file says there is left out"))
    maps = [
        list(found) for is_map, found in groupby(lines, lambda line: bool(line.strip())) if is_map
    ]
    with_start = sum(any(set(line) & _STARTS for line in each) for each in maps)
    if with_start > 1:
        raise ConversionError(
            f"there are {with_start} maps in it", "keep the one that is to be the level"
        )
    return SourceFile(source.name, "\n".join(lines))


def write_sokoban(level: Level) -> Conversion:
    """Return a level as a map with a ring of walls, `@` for the start and `.` for exits."""
    ends = f"{PLACE} has no cells that end the episode but exits"
    rows, lost = block_map(level, PLACE, Rewards(), ends=ends, many="E")
    marks = str.maketrans({d.BLOCKED: "#", d.START: "@", d.EXIT: "."})
    return Conversion("\n".join(row.translate(marks) for row in rows) + "\n", tuple(lost))
