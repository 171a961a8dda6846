"""A grid in the terms of the language again: as a drawing, and its maze as walls."""

from collections.abc import Iterator
from itertools import groupby
from typing import Any

from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.cells import GLASS_PASS, sides_of
from babyrobot_levels.language.drawing import consecutive
from babyrobot_levels.language.kinds import MARKED
from babyrobot_levels.language.level import LevelSpec
from babyrobot_levels.mdp.grid import BIT, Grid, neighbour, stretches


def drawing_of(level: LevelSpec, grid: Grid) -> d.Drawing:
    """Return what the language's drawing shows of a level."""
    width, height = grid.width, grid.height
    cells = [[d.PLAIN] * width for _ in range(height)]
    if level.drawing is not None:
        for character in level.legend:
            for x, y in level.drawing.find(character):
                cells[y][x] = character
    for kind in reversed(MARKED):
        # Beside a drawing, entries may stand in the field as well: the drawing has only its own.
        entries = kind.of(level)
        for entry in (
            entries if level.drawing is None else entries[: level._drawn.get(kind.field, 0)]
        ):
            x, y = entry.at
            mark = kind.mark_of(entry)
            cells[y][x] = d.together(cells[y][x], mark) or mark
    exits = level.exits if level.exit_one_of is None else ()
    for character, ends in ((d.START, level.starts), (d.EXIT, exits)):
        for x, y in ends:
            cells[y][x] = character
    for cell, blocked in enumerate(grid.blocked_cells):
        if blocked:
            cells[cell // width][cell % width] = d.BLOCKED

    east, south = _marks(level, grid, "E"), _marks(level, grid, "S")
    rows = range(0, width * height, width)
    return d.Drawing(
        tuple("".join(row) for row in cells),
        tuple(east[first : first + width - 1] for first in rows),
        tuple(south[first : first + width] for first in rows[:-1]),
    )


def _marks(level: LevelSpec, grid: Grid, side: str) -> str:
    """Return the drawing's mark for what is on one side of each cell."""
    solid, glass, nothing = map(ord, (d.SOLID, d.GLASS, d.OPEN))
    walls = bytes(solid if bits & BIT[side] else nothing for bits in range(256))
    marks = bytearray(grid.wall_bits.translate(walls))
    for cell, where in grid.glass:
        if where == side and marks[cell] == solid:
            marks[cell] = glass
    for door in level.doors:
        for cells, where in stretches(door, grid.width, grid.height):
            if where == side:
                marks[cells] = d.DOOR.encode() * door.length
    return marks.decode("ascii")


Edge = tuple[str, int, int]
"""A side and its cell `(x, y)`. Between two cells the side is E or S."""

Traits = dict[str, Any]
"""The fields of a wall beside its place that are not left at their defaults."""


def resolved_fields(level: LevelSpec, grid: Grid) -> dict[str, Any]:
    """Return the fields that replace `maze` and `openings`, which become None.

    Tables and picture stay the same.
    """
    walls = inner_walls(level, grid)
    fields: dict[str, Any] = {"maze": None, "openings": None}
    if level.map is not None:
        fields["map"] = d.compose(drawing_of(level, grid))
        # `walls` only gives what a drawing cannot show.
        drawn: tuple[Traits, ...] = ({}, {"pass": GLASS_PASS})
        walls = {edge: traits for edge, traits in walls.items() if traits not in drawn}
    fields["walls"] = list(wall_entries(walls)) or None
    return fields


def inner_walls(level: LevelSpec, grid: Grid) -> dict[Edge, Traits]:
    """Return all walls between cells, and of the outer wall what has looks of its own."""
    walls: dict[Edge, Traits] = {edge: {} for edge in _inner_edges(grid)}
    for (cell, side), probability in grid.glass.items():
        y, x = divmod(cell, grid.width)
        if (side, x, y) in walls:
            walls[side, x, y]["pass"] = probability
    for wall in level.walls:
        given = {name: getattr(wall, name) for name in ("color", "width")}
        looks = {name: value for name, value in given.items() if value is not None}
        looks |= {"fit": True} if wall.fit else {}
        for x, y in sides_of(wall) if looks else ():
            edge, is_outer = _edge(wall.side, x, y, grid)
            # An opening may have taken the wall away.
            if is_outer or edge in walls:
                walls.setdefault(edge, {}).update(looks)
    return walls


def _inner_edges(grid: Grid) -> Iterator[Edge]:
    for cell, bits in enumerate(grid.wall_bits):
        y, x = divmod(cell, grid.width)
        if bits & BIT["S"] and y < grid.height - 1:
            yield "S", x, y
        if bits & BIT["E"] and x < grid.width - 1:
            yield "E", x, y


def _edge(side: str, x: int, y: int, grid: Grid) -> tuple[Edge, bool]:
    """Return a side as it is named here, and whether it belongs to the outer wall."""
    other = neighbour(y * grid.width + x, side, grid.width, grid.height)
    if other is None or side in ("S", "E"):
        return (side, x, y), other is None
    return ("S", x, y - 1) if side == "N" else ("E", x - 1, y), False


def wall_entries(walls: dict[Edge, Traits]) -> Iterator[dict[str, Any]]:
    """Yield entries of `walls`, those in a line as one: by rows, then by columns."""
    for line in consecutive(sorted(walls, key=_position), _position):
        for traits, alike in groupby(line, walls.__getitem__):
            (side, x, y), *more = alike
            lengths = {"length": 1 + len(more)} if more else {}
            yield {"at": [x, y], "side": side, **lengths, **traits}


def _position(edge: Edge) -> tuple[tuple[bool, int, str], int]:
    """Return the line on which a side lies, and its place on it: rows come before columns."""
    side, x, y = edge
    return ((True, x, side), y) if side in ("E", "W") else ((False, y, side), x)
