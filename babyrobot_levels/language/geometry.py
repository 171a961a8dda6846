"""Cells of a level that is valid field by field: which are blocked, which are off the grid."""

from collections.abc import Callable, Iterable

from babyrobot_levels.language.cells import Rectangle
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.text.diagnostics import Issue, Location

Cell = tuple[int, int]
Route = tuple[str | int, ...]


def blocked_cells(level: LevelFields) -> Callable[[Cell], bool]:
    """Return a test for blocked cells."""
    return painted(level, ((rectangle, True) for rectangle in level.blocked))


def painted(
    level: LevelFields, rectangles: Iterable[tuple[Rectangle, bool]]
) -> Callable[[Cell], bool]:
    """Return a test for the cells that were painted with True, after all rectangles in turn.

    What lies off the grid is left out. Files may hold thousands of rectangles: each is painted
    along its longer side.
    """
    width, height = level.size
    cells = bytearray(width * height)
    for rectangle, value in rectangles:
        (x, y), (columns, rows) = rectangle.at, rectangle.size
        columns, rows = min(columns, width - x), min(rows, height - y)
        if columns <= 0 or rows <= 0:
            continue
        first = y * width + x
        if columns >= rows:
            starts, step, count = range(first, first + rows * width, width), 1, columns
        else:
            starts, step, count = range(first, first + columns), width, rows
        paint = bytes([value]) * count
        for start in starts:
            cells[start : start + step * (count - 1) + 1 : step] = paint
    return lambda cell: is_inside(level, cell) and bool(cells[cell[1] * width + cell[0]])


def is_inside(level: LevelFields, cell: Cell) -> bool:
    """Tell whether a cell is on the grid."""
    return cell[0] < level.size[0] and cell[1] < level.size[1]


def show_cell(cell: Cell) -> str:
    """Return a cell as it stands in a file."""
    return f"[{cell[0]}, {cell[1]}]"


def off_the_grid(level: LevelFields, what: str, cell: Cell, location: Location) -> Issue:
    """Return the error of something that is outside the grid."""
    width, height = level.size
    return Issue(
        "BR301",
        location,
        f"{what} {show_cell(cell)} is off the grid, which is {width} wide and {height} high",
        f"x goes from 0 to {width - 1}, y from 0 to {height - 1}",
    )
