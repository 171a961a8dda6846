"""What the language's drawing shows of a level."""

from __future__ import annotations

from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.level import LevelSpec
from babyrobot_levels.mdp.grid import BIT, Grid


def drawing_of(level: LevelSpec, grid: Grid) -> d.Drawing:
    """Return what the language's drawing shows of a level."""
    width, height = grid.width, grid.height
    cells = [[d.PLAIN] * width for _ in range(height)]
    if level.drawing is not None:
        for character in level.legend:
            for x, y in level.drawing.find(character):
                cells[y][x] = character
    for puddle in level.puddles:
        x, y = puddle.at
        cells[y][x] = d.SMALL if puddle.size == "small" else d.LARGE
    for character, ends in ((d.START, level.starts), (d.EXIT, level.exits)):
        for x, y in ends:
            cells[y][x] = character
    for cell, blocked in enumerate(grid.blocked_cells):
        if blocked:
            cells[cell // width][cell % width] = d.BLOCKED

    east, south = _marks(grid, "E"), _marks(grid, "S")
    rows = range(0, width * height, width)
    return d.Drawing(
        tuple("".join(row) for row in cells),
        tuple(east[first : first + width - 1] for first in rows),
        tuple(south[first : first + width] for first in rows[:-1]),
    )


def _marks(grid: Grid, side: str) -> str:
    """Return the drawing's mark for what is on one side of each cell."""
    solid, glass, nothing = map(ord, (d.SOLID, d.GLASS, d.OPEN))
    walls = bytes(solid if bits & BIT[side] else nothing for bits in range(256))
    marks = bytearray(grid.wall_bits.translate(walls))
    for cell, where in grid.glass:
        if where == side and marks[cell] == solid:
            marks[cell] = glass
    return marks.decode("ascii")
