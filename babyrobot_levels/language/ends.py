"""Checks of starts and exits."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from babyrobot_levels.language.geometry import (
    Cell,
    Route,
    is_inside,
    off_the_grid,
    painted,
    show_cell,
)
from babyrobot_levels.text.diagnostics import Issue

if TYPE_CHECKING:
    from babyrobot_levels.language.fields import LevelFields


def _cells_of(level: LevelFields, field: str) -> list[tuple[Cell, Route]]:
    """Return the cells of `start` or `exit`, each with its route."""
    cells = level.starts if field == "start" else level.exits
    value = getattr(level, field)
    if isinstance(value[0], tuple):
        return [(cell, (field, index)) for index, cell in enumerate(cells)]
    return [(cell, (field,)) for cell in cells]


def check_ends(level: LevelFields, blocked: Callable[[Cell], bool]) -> Iterator[Issue]:
    """Yield the errors of starts and exits. `blocked` tells whether a cell is blocked."""
    exits = set(level.exits)
    left = {warp.at for warp in level.warps if warp.when == "enter"}
    ends = painted(level, ((area, area.ends) for area in level.areas if area.ends is not None))
    for field in ("start", "exit"):
        seen: set[Cell] = set()
        for cell, route in _cells_of(level, field):
            if not is_inside(level, cell):
                yield off_the_grid(level, f"the {field}", cell, route)
            elif blocked(cell):
                code = "BR302" if field == "start" else "BR304"
                given = field in level.model_fields_set
                message = f"the {field} {show_cell(cell)} is on a blocked cell"
                default = f"the default {field} {show_cell(cell)} is on a blocked cell"
                yield Issue(
                    code,
                    route if given else _blocking(level, cell),
                    message if given else default,
                    f"move the {field}, or unblock the cell",
                )
            elif cell in seen:
                yield Issue("BR305", route, f"{show_cell(cell)} is listed twice")
            elif field == "start" and cell in exits:
                yield Issue(
                    "BR303",
                    _given(level, route, ("exit",)),
                    _start_is_exit(level, cell),
                    "move one of them, or use `exit: none` for a level without an exit",
                )
            elif field == "start" and cell in left:
                number = next(n for n, warp in enumerate(level.warps) if warp.at == cell)
                yield Issue(
                    "BR309",
                    _given(level, route, ("warps", number, "at")),
                    f"the start {show_cell(cell)} is on a warp that acts on entering",
                    "move the start, or use `when: leave` for the warp",
                )
            elif field == "start" and ends(cell):
                yield Issue(
                    "BR316",
                    route,
                    f"the start {show_cell(cell)} is on an area that ends the episode",
                    "move the start, or remove `ends` from the area",
                )
            seen.add(cell)


def _given(level: LevelFields, route: Route, otherwise: Route) -> Route:
    """Return the route of a start or an exit, or another where the file leaves it out."""
    if level.map is not None:
        return ("map",)
    return route if route[0] in level.model_fields_set else otherwise


def _blocking(level: LevelFields, cell: Cell) -> Route:
    """Return the route of the rectangle that blocks a cell."""
    for index, rectangle in enumerate(level.blocked):
        (x, y), (columns, rows) = rectangle.at, rectangle.size
        if x <= cell[0] < x + columns and y <= cell[1] < y + rows:
            return ("blocked", index)
    return ("blocked",)


def _start_is_exit(level: LevelFields, cell: Cell) -> str:
    start, exit_ = ("start" in level.model_fields_set, "exit" in level.model_fields_set)
    if start and not exit_:
        default = "the default exit is the bottom-right cell"
        return f"the start {show_cell(cell)} is also the exit: {default}"
    if exit_ and not start:
        return f"the exit {show_cell(cell)} is also the start: the default start is [0, 0]"
    if not start:
        return f"start and exit are both {show_cell(cell)} by default"
    return f"the start {show_cell(cell)} is also an exit"
