"""Worlds whose walls fill whole cells, from and to the language's walls between cells."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from babyrobot_levels.convert.conversion import ConversionError
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.base import MAX_SIZE
from babyrobot_levels.mdp.grid import BIT, Grid
from babyrobot_levels.text.source import Position, SourceFile

Rows = tuple[str, ...]
"""Cells row by row, each as the character that stands for it in a drawing of the language."""


def text_rows(source: SourceFile) -> list[str]:
    """Return the lines of a drawn map, all as long as the longest, without blank ones around.

    Raises:
        ConversionError: there are none.
    """
    lines = [line.rstrip() for line in source.lines]
    while lines and not lines[-1]:
        lines.pop()
    first = next((number for number, line in enumerate(lines) if line), 0)
    lines = lines[first:]
    if not lines:
        raise ConversionError("there is no map in it")
    # Editors drop blanks at the ends of lines.
    width = max(map(len, lines))
    return [line.ljust(width) for line in lines]


def translated(
    source: SourceFile, rows: Sequence[str], meanings: dict[str, str], known: str
) -> Rows:
    """Return rows with each character replaced by what it means.

    Raises:
        ConversionError: a character means nothing; `known` says which ones do.
    """
    for y, row in enumerate(rows):
        for x, character in enumerate(row):
            if character not in meanings:
                lines = source.lines
                above = next(number for number, line in enumerate(lines) if line.strip())
                place = Position(above + y + 1, x + 1)
                message = f"`{character}` means nothing here"
                raise ConversionError.at(source, place, message, known)
    return tuple("".join(map(meanings.__getitem__, row)) for row in rows)


def without_ring(rows: Rows) -> Rows:
    """Return rows without a ring of walls around them: there is always a wall around a level."""
    sides = [rows[0], rows[-1], *(row[0] + row[-1] for row in rows)]
    if len(rows) < 3 or len(rows[0]) < 3 or set("".join(sides)) != {d.BLOCKED}:
        return rows
    return tuple(row[1:-1] for row in rows[1:-1])


def without_surroundings(rows: Rows) -> Rows:
    """Return rows with the free cells blocked that lie outside of the walls around the world.

    Those are the ones from which one gets to the edge, but to no start and to no exit.
    """
    cells = [list(row) for row in rows]
    width, height = len(rows[0]), len(rows)
    seen: set[tuple[int, int]] = set()
    edge = [(x, y) for y in range(height) for x in range(width) if x in (0, width - 1)]
    edge += [(x, y) for x in range(width) for y in (0, height - 1)]
    for cell in edge:
        if cell in seen or rows[cell[1]][cell[0]] == d.BLOCKED:
            continue
        room, open_ends = {cell}, [cell]
        while open_ends:
            x, y = open_ends.pop()
            for near in ((x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)):
                inside = 0 <= near[0] < width and 0 <= near[1] < height
                if inside and near not in room and rows[near[1]][near[0]] != d.BLOCKED:
                    room.add(near)
                    open_ends.append(near)
        seen |= room
        if all(rows[y][x] == d.PLAIN for x, y in room):
            for x, y in room:
                cells[y][x] = d.BLOCKED
    return tuple("".join(row) for row in cells)


def is_lattice(rows: Rows) -> bool:
    """Tell whether every second cell of every second row is one, and all posts between are walls.

    That is how mazes with walls between their cells are drawn in blocks.
    """
    width, height = len(rows[0]), len(rows)
    if width % 2 == 0 or height % 2 == 0 or width < 3 or height < 3:
        return False
    posts = {character for row in rows[::2] for character in row[::2]}
    cells = {character for row in rows[1::2] for character in row[1::2]}
    return posts == {d.BLOCKED} and d.BLOCKED not in cells


def drawn(rows: Rows, east: Rows | None = None, south: Rows | None = None) -> dict[str, Any]:
    """Return the field `map` with rows of cells, without walls between them if none are given.

    Raises:
        ConversionError: there is no cell, there are too many, or there is no start among them.
    """
    width, height = len(rows[0]), len(rows)
    if max(width, height) > MAX_SIZE:
        raise ConversionError(
            f"the map is {width} by {height}; a level is at most {MAX_SIZE} cells wide and high"
        )
    if not any(d.START in row for row in rows):
        raise ConversionError("the map has no start", "mark the cell where episodes begin")
    east = east or (d.OPEN * (width - 1),) * height
    south = south or (d.OPEN * width,) * (height - 1)
    return {"map": d.compose(d.Drawing(rows, east, south))}


def has_walls(grid: Grid) -> bool:
    """Tell whether there are walls between free cells, of glass or not."""
    return any(
        bits & BIT[side] and other is not None and not grid.blocked_cells[other]
        for cell, bits in enumerate(grid.wall_bits)
        if not grid.blocked_cells[cell]
        for side in ("E", "S")
        if (other := grid.neighbour(cell, side)) is not None
    )


def as_blocks(grid: Grid, cells: Sequence[str], *, lattice: bool) -> Rows:
    """Return a grid in blocks, with a ring of them around it.

    Args:
        grid: walls and cells.
        cells: what the cells are, row by row; a blocked one is `BLOCKED`.
        lattice: whether walls between cells become blocks too, so that there are two blocks in
            each direction for each cell. Without it, those walls are left out.
    """
    if not lattice:
        border = d.BLOCKED * (grid.width + 2)
        return (border, *(f"{d.BLOCKED}{row}{d.BLOCKED}" for row in cells), border)
    rows = [[d.BLOCKED] * (2 * grid.width + 1) for _ in range(2 * grid.height + 1)]
    for cell, bits in enumerate(grid.open_bits):
        y, x = divmod(cell, grid.width)
        rows[2 * y + 1][2 * x + 1] = cells[y][x]
        if bits & BIT["E"]:
            rows[2 * y + 1][2 * x + 2] = d.PLAIN
        if bits & BIT["S"]:
            rows[2 * y + 2][2 * x + 1] = d.PLAIN
    return tuple("".join(row) for row in rows)


def from_lattice(rows: Rows) -> tuple[Rows, Rows, Rows]:
    """Return the cells of a lattice, and the marks east and south of them; see `Drawing`."""
    columns, lines = range(1, len(rows[0]), 2), range(1, len(rows), 2)

    def mark(x: int, y: int) -> str:
        return d.SOLID if rows[y][x] == d.BLOCKED else d.OPEN

    cells = tuple("".join(rows[y][x] for x in columns) for y in lines)
    east = tuple("".join(mark(x + 1, y) for x in columns[:-1]) for y in lines)
    south = tuple("".join(mark(x, y + 1) for x in columns) for y in lines[:-1])
    return cells, east, south
