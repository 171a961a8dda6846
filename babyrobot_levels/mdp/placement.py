"""Doors and paths against the walls of the grid, those of a maze included."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.geometry import show_cell
from babyrobot_levels.language.walls import sides_of
from babyrobot_levels.mdp.doors import door_sides
from babyrobot_levels.mdp.grid import BIT, OPPOSITE, Grid
from babyrobot_levels.text.diagnostics import Issue

MAX_PROBLEMS = 100
"""At most so many errors are reported."""


def placement_issues(level: LevelFields, grid: Grid) -> list[Issue]:
    """Return the errors of doors that stand on walls, and of paths that walls or doors cut."""
    issues: list[Issue] = []
    for found in (_door_issues(level, grid), _path_issues(level, grid)):
        for issue in found:
            if len(issues) < MAX_PROBLEMS:
                issues.append(issue)
    return issues


def _door_issues(level: LevelFields, grid: Grid) -> Iterator[Issue]:
    seen: dict[tuple[int, str], int] = {}
    for index, door in enumerate(level.doors):
        for x, y in sides_of(door):
            cell, route = y * grid.width + x, ("doors", index)
            other = grid.neighbour(cell, door.side)
            where = f"side {door.side} of {show_cell((x, y))}"
            if other is None:
                message = f"{where} is part of the outer wall, which has no doors"
                yield Issue("BR322", (*route, "side"), message, "move the door")
                continue
            if (cell, door.side) in seen:
                message = f"{where} already has a door"
                yield Issue("BR322", route, message, "a side has one door; `needs` takes a list")
            elif (cell, door.side) in grid.glass:
                message = f"{where} has a wall of glass"
                yield Issue("BR322", route, message, "remove the glass, or the door")
            elif grid.blocked_cells[cell] or grid.blocked_cells[other]:
                message = f"{where} is beside a blocked cell"
                yield Issue("BR322", route, message, "move the door: it would lead nowhere")
            elif not grid.open_bits[cell] & BIT[door.side]:
                message = f"{where} has a wall"
                help_text = "remove the wall there with `openings`, or move the door"
                yield Issue("BR322", route, message, help_text)
            seen[cell, door.side] = seen[other, OPPOSITE[door.side]] = index


def _path_issues(level: LevelFields, grid: Grid) -> Iterator[Issue]:
    doors = {(cell, side) for cell, side, _ in door_sides(level, grid)}
    for index, mover in enumerate(level.movers):
        if mover.path is None:
            continue
        cells = [y * grid.width + x for x, y in mover.path]
        for number, (one, two) in enumerate(pairwise([*cells, cells[-1 if mover.back else 0]]), 1):
            number %= len(cells)
            for side in SIDES:
                if grid.neighbour(one, side) != two:
                    continue
                what = None
                if (one, side) in grid.glass:
                    what = "a wall of glass"
                elif not grid.open_bits[one] & BIT[side]:
                    what = "a wall"
                elif (one, side) in doors:
                    what = "a door"
                if what is not None:
                    at, to = (show_cell((c % grid.width, c // grid.width)) for c in (one, two))
                    message = f"{what} stands between {at} and {to}"
                    help_text = "movers on a path pass no walls, glass or doors"
                    yield Issue("BR323", ("movers", index, "path", number), message, help_text)
