"""Levels as text: the language's own drawing, and one in Unicode for terminals."""

from __future__ import annotations

from typing import TYPE_CHECKING

from babyrobot_levels import drawing as d
from babyrobot_levels.grid import BIT, Grid

if TYPE_CHECKING:
    from babyrobot_levels.spec.level import LevelFields


def drawing_of(level: LevelFields, grid: Grid) -> d.Drawing:
    """Return what the language's drawing shows of a level."""
    width, height = grid.width, grid.height
    cells = [[d.PLAIN] * width for _ in range(height)]
    if level.map is not None:
        shown, _ = d.parse(level.map, lambda character: character in level.legend, max(level.size))
        for character in level.legend if shown else ():
            for x, y in shown.find(character):  # type: ignore[union-attr]
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

    def mark(cell: int, side: str) -> str:
        if not grid.wall_bits[cell] & BIT[side]:
            return d.OPEN
        return d.GLASS if (cell, side) in grid.glass else d.SOLID

    return d.Drawing(
        tuple("".join(row) for row in cells),
        tuple("".join(mark(y * width + x, "E") for x in range(width - 1)) for y in range(height)),
        tuple("".join(mark(y * width + x, "S") for x in range(width)) for y in range(height - 1)),
    )


def ascii_drawing(level: LevelFields, grid: Grid, state: int | None = None) -> str:
    """Return the language's drawing; each line ends with a newline.

    Args:
        level: the level.
        grid: its walls and cells.
        state: the cell, `y * width + x`, that shows `R` for the robot. What then comes out is a
            picture, and no drawing that the language could read.
    """
    text = d.compose(drawing_of(level, grid))
    if state is None:
        return text
    y, x = divmod(state, grid.width)
    lines = text.split("\n")
    row = lines[2 * y + 1]
    lines[2 * y + 1] = f"{row[: 4 * x + 1]} R {row[4 * x + 4 :]}"
    return "\n".join(lines)
