"""Words and questions that the checks of a level share: cells, routes, what is blocked."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from babyrobot_levels.spec.problem import Problem

if TYPE_CHECKING:
    from babyrobot_levels.spec.level import LevelFields

Cell = tuple[int, int]
Route = tuple[str | int, ...]


def blocked_cells(level: LevelFields) -> Callable[[Cell], bool]:
    """Return a test for blocked cells."""
    width, height = level.size
    cells = bytearray(width * height)
    for rectangle in level.blocked:
        (x, y), (columns, rows) = rectangle.at, rectangle.size
        last = min(x + columns, width)
        for row in range(y, min(y + rows, height)):
            if x < last:
                cells[row * width + x : row * width + last] = b"\1" * (last - x)
    return lambda cell: is_inside(level, cell) and bool(cells[cell[1] * width + cell[0]])


def is_inside(level: LevelFields, cell: Cell) -> bool:
    """Tell whether a cell is on the grid."""
    return cell[0] < level.size[0] and cell[1] < level.size[1]


def show_cell(cell: Cell) -> str:
    """Return a cell as it stands in a file."""
    return f"[{cell[0]}, {cell[1]}]"


def off_the_grid(level: LevelFields, what: str, cell: Cell, route: Route) -> Problem:
    """Return the fault of something that is off the grid."""
    width, height = level.size
    return Problem(
        "BR301",
        route,
        f"{what} {show_cell(cell)} is off the grid, which is {width} wide and {height} high",
        f"x goes from 0 to {width - 1}, y from 0 to {height - 1}",
    )
