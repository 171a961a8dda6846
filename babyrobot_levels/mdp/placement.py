"""Doors and paths against the walls of the grid, those of a maze included."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain, islice, pairwise

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.geometry import show_cell
from babyrobot_levels.language.things import Door
from babyrobot_levels.language.walls import sides_of
from babyrobot_levels.mdp.grid import BIT, OPPOSITE, Grid
from babyrobot_levels.text.diagnostics import Issue
from babyrobot_levels.text.errors import UnplayableError

MAX_PROBLEMS = 100
"""At most so many errors are reported."""

Doors = dict[tuple[int, str], int]
"""The number of the door at each cell and side, from both sides."""


def check_placement(level: LevelFields, grid: Grid) -> None:
    """Check that no doors stand on walls, and no walls or doors cut paths.

    Raises:
        UnplayableError: some do.
    """
    issues = placement_issues(level, grid) if level.stands_on_grid else []
    if issues:
        raise UnplayableError(issues)


def placement_issues(level: LevelFields, grid: Grid) -> list[Issue]:
    """Return the errors of doors that stand on walls, and of paths that walls or doors cut."""
    doors: Doors = {}
    issues = chain(_door_issues(level, grid, doors), _path_issues(level, grid, doors))
    return [*islice(issues, MAX_PROBLEMS)]


def _door_issues(level: LevelFields, grid: Grid, doors: Doors) -> Iterator[Issue]:
    """Yield the first error of each door, and note where doors stand."""
    for index, door in enumerate(level.doors):
        for x, y in sides_of(door):
            cell = y * grid.width + x
            other = grid.neighbour(cell, door.side)
            fault = _fault_of(door, cell, other, grid, doors)
            if fault is not None:
                message, help_text = fault
                where = f"side {door.side} of {show_cell((x, y))}"
                yield Issue("BR322", ("doors", index), f"{where} {message}", help_text)
                break
            assert other is not None
            doors[cell, door.side] = doors[other, OPPOSITE[door.side]] = index


def _fault_of(
    door: Door, cell: int, other: int | None, grid: Grid, doors: Doors
) -> tuple[str, str] | None:
    """Return what is wrong with a door between two cells, and what to do about it."""
    if other is None:
        return "is part of the outer wall, which has no doors", "move the door"
    if (cell, door.side) in doors:
        help_text = "remove one of them; several names in `needs` must all be met"
        return f"already has a door, `doors[{doors[cell, door.side]}]`", help_text
    if (cell, door.side) in grid.glass:
        return "has a wall of glass, so a door cannot stand there", "remove one of them"
    if grid.blocked_cells[cell] or grid.blocked_cells[other]:
        return "is beside a blocked cell, so a door there leads nowhere", "move the door"
    if not grid.open_bits[cell] & BIT[door.side]:
        help_text = "a door stands in an opening: remove the wall, or move the door"
        return "has a wall, so a door cannot stand there", help_text
    return None


def _path_issues(level: LevelFields, grid: Grid, doors: Doors) -> Iterator[Issue]:
    for index, mover in enumerate(level.movers):
        if mover.path is None:
            continue
        cells = [y * grid.width + x for x, y in mover.path]
        # A loop also goes from its last cell to its first.
        ways = pairwise(cells if mover.back else [*cells, cells[0]])
        for number, (one, two) in enumerate(ways, 1):
            what = _between(one, two, grid, doors)
            if what is not None:
                at, to = (show_cell((c % grid.width, c // grid.width)) for c in (one, two))
                route = ("movers", index, "path", number % len(cells))
                message = f"the path is cut off by {what} between {at} and {to}"
                help_text = "movers on a path cannot pass walls, glass or doors"
                yield Issue("BR323", route, message, help_text)


def _between(one: int, two: int, grid: Grid, doors: Doors) -> str | None:
    """Return what stands between two neighbours, None if nothing does."""
    for side in SIDES:
        if grid.neighbour(one, side) == two:
            if (one, side) in grid.glass:
                return "a wall of glass"
            if not grid.open_bits[one] & BIT[side]:
                return "a wall"
            if (one, side) in doors:
                return "a door"
    return None
