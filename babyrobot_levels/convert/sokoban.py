"""Mazes of `#` and blanks, as Sokoban and many small programs have them: walls fill cells."""

from __future__ import annotations

from babyrobot_levels import drawing as d
from babyrobot_levels.convert.blocks import (
    drawn,
    text_rows,
    translated,
    without_ring,
    without_surroundings,
)
from babyrobot_levels.convert.conversion import Conversion, Lost, World
from babyrobot_levels.convert.marks import block_map
from babyrobot_levels.level import Level
from babyrobot_levels.source import SourceFile
from babyrobot_levels.spec.moves import Rewards

PLACE = "a Sokoban map"
BOXES = "$*"
ON_GOAL = "+"
_CELLS = {"#": d.BLOCKED, " ": d.PLAIN, "-": d.PLAIN, "_": d.PLAIN, "$": d.PLAIN}
_CELLS |= {"@": d.START, "S": d.START, ON_GOAL: d.START}
_CELLS |= {".": d.EXIT, "E": d.EXIT, "X": d.EXIT, "*": d.EXIT}
_KNOWN = "`#` wall, a blank (or `-`) free, @ or S start, `.` E or X exit, $ and * boxes"


def read_sokoban(source: SourceFile) -> World:
    """Return the world of a map: its walls are blocked cells, and so is all outside of them."""
    lines = text_rows(source)
    rows = translated(source, lines, _CELLS, _KNOWN)
    fields = {"version": 1, **drawn(without_ring(without_surroundings(rows)))}
    lost = []
    text = "".join(lines)
    if any(box in text for box in BOXES):
        lost.append(Lost("boxes", "they are left out: their cells are free"))
    if ON_GOAL in text:
        lost.append(Lost(ON_GOAL, "a start cannot be an exit: it is only the start"))
    return World(fields, "A map of `#` and blanks.", {}, tuple(lost))


def write_sokoban(level: Level) -> Conversion:
    """Return a level as a map with a ring of walls, `@` for the start and `.` for exits."""
    ends = f"{PLACE} has no cells that end the episode but exits"
    rows, lost = block_map(level, PLACE, Rewards(), ends=ends, many="E")
    marks = str.maketrans({d.BLOCKED: "#", d.START: "@", d.EXIT: "."})
    return Conversion("\n".join(row.translate(marks) for row in rows) + "\n", tuple(lost))
