"""What must hold between the fields of a level: the geometry, checked without any table."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from babyrobot_levels.spec.problem import Problem
from babyrobot_levels.spec.walls import Opening, sides_of

if TYPE_CHECKING:
    from babyrobot_levels.spec.level import LevelFields

Cell = tuple[int, int]
Route = tuple[str | int, ...]

MAX_COVERED = 1 << 24
"""The most cells that all rectangles, walls and openings may cover, each counted for itself."""

MAX_PROBLEMS = 200
"""A file with more faults than this gets only so many told."""


def problems_of(level: LevelFields) -> list[Problem]:
    """Return the faults of a level whose fields are each valid for themselves."""
    too_much = _check_covered(level)
    if too_much:
        return too_much
    problems: list[Problem] = []
    for check in (_check_rectangles, _check_sides, _check_wind):
        _collect(problems, check(level))
    blocked = _blocked(level)
    for check_cells in (_check_ends, _check_puddles, _check_warps):
        _collect(problems, check_cells(level, blocked))
    return problems


def _collect(problems: list[Problem], found: Iterator[Problem]) -> None:
    for problem in found:
        if len(problems) >= MAX_PROBLEMS:
            return
        problems.append(problem)


def _check_covered(level: LevelFields) -> list[Problem]:
    cells = sum(area.size[0] * area.size[1] for area in (*level.areas, *level.blocked))
    cells += sum(opening.length for opening in (*level.walls, *level.openings))
    if cells <= MAX_COVERED:
        return []
    field = "areas" if level.areas else "blocked" if level.blocked else "walls"
    return [
        Problem(
            "BR205",
            (field,),
            f"areas, blocked cells and walls cover {cells:,} cells, counted one by one; "
            f"at most {MAX_COVERED:,} are allowed",
        )
    ]


def _blocked(level: LevelFields) -> Callable[[Cell], bool]:
    """Return a test for blocked cells."""
    width, height = level.size
    cells = bytearray(width * height)
    for rectangle in level.blocked:
        (x, y), (columns, rows) = rectangle.at, rectangle.size
        last = min(x + columns, width)
        for row in range(y, min(y + rows, height)):
            if x < last:
                cells[row * width + x : row * width + last] = b"\1" * (last - x)
    return lambda cell: _inside(level, cell) and bool(cells[cell[1] * width + cell[0]])


def _inside(level: LevelFields, cell: Cell) -> bool:
    return cell[0] < level.size[0] and cell[1] < level.size[1]


def _show(cell: Cell) -> str:
    return f"[{cell[0]}, {cell[1]}]"


def _off(level: LevelFields, what: str, cell: Cell, route: Route) -> Problem:
    width, height = level.size
    return Problem(
        "BR301",
        route,
        f"{what} {_show(cell)} is off the grid, which is {width} wide and {height} high",
        f"x goes from 0 to {width - 1}, y from 0 to {height - 1}",
    )


def _cells_of(level: LevelFields, field: str) -> list[tuple[Cell, Route]]:
    """Return the cells of `start` or `exit`, each with its route."""
    cells = level.starts if field == "start" else level.exits
    value = getattr(level, field)
    if isinstance(value[0], tuple):
        return [(cell, (field, index)) for index, cell in enumerate(cells)]
    return [(cell, (field,)) for cell in cells]


def _check_ends(level: LevelFields, blocked: Callable[[Cell], bool]) -> Iterator[Problem]:
    exits = set(level.exits)
    left = {warp.at for warp in level.warps if warp.when == "enter"}
    for field in ("start", "exit"):
        seen: set[Cell] = set()
        for cell, route in _cells_of(level, field):
            if not _inside(level, cell):
                yield _off(level, f"the {field}", cell, route)
            elif blocked(cell):
                code = "BR302" if field == "start" else "BR304"
                given = field in level.model_fields_set
                default = "" if given else ", where it is if nothing is said"
                yield Problem(
                    code,
                    route if given else _blocking(level, cell),
                    f"the {field} {_show(cell)} is on a blocked cell{default}",
                    f"put the {field} elsewhere, or leave the cell free",
                )
            elif cell in seen:
                yield Problem("BR305", route, f"{_show(cell)} is listed twice")
            elif field == "start" and cell in exits:
                yield Problem(
                    "BR303",
                    _given(level, route, ("exit",)),
                    _start_is_exit(level, cell),
                    "move one of the two; a level without an exit says `exit: none`",
                )
            elif field == "start" and cell in left:
                number = next(n for n, warp in enumerate(level.warps) if warp.at == cell)
                yield Problem(
                    "BR309",
                    _given(level, route, ("warps", number, "at")),
                    f"the start {_show(cell)} is a warp, and nobody can stand there",
                    "start elsewhere, or let the warp act `when: leave`",
                )
            elif field == "start" and _ends(level, cell):
                yield Problem(
                    "BR316",
                    route,
                    f"the start {_show(cell)} is on an area that ends the episode",
                    "start elsewhere, or take `ends` away there",
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
    if "exit" in level.model_fields_set or level.map is not None:
        default = "" if "start" in level.model_fields_set else ", as where nothing is said"
        return f"the exit {_show(cell)} is the start too{default}"
    return (
        f"the start {_show(cell)} is the exit too: "
        "where nothing is said, the exit is the bottom-right cell"
    )


def _ends(level: LevelFields, cell: Cell) -> bool:
    """Tell whether an area ends the episode on the cell; the last one that says so counts."""
    for area in reversed(level.areas):
        (x, y), (columns, rows) = area.at, area.size
        if area.ends is not None and x <= cell[0] < x + columns and y <= cell[1] < y + rows:
            return area.ends
    return False


def _check_rectangles(level: LevelFields) -> Iterator[Problem]:
    for field in ("areas", "blocked"):
        for index, rectangle in level.written(field):
            (x, y), (columns, rows) = rectangle.at, rectangle.size
            first, last = (x, y), (x + columns - 1, y + rows - 1)
            if not _inside(level, first):
                yield _off(level, "the cell", first, (field, index, "at"))
            elif not _inside(level, last):
                yield _off(level, "the rectangle's last cell", last, (field, index))


def _check_sides(level: LevelFields) -> Iterator[Problem]:
    for field in ("walls", "openings"):
        for index, entry in level.written(field):
            yield from _check_side(level, field, index, entry)


def _check_side(level: LevelFields, field: str, index: int, entry: Opening) -> Iterator[Problem]:
    what = "wall" if field == "walls" else "opening"
    route = (field, index)
    cells = sides_of(entry)
    if not _inside(level, entry.at):
        yield _off(level, "the cell", entry.at, (*route, "at"))
        return
    if not _inside(level, cells[-1]):
        yield _off(level, f"the last cell of the {what}", cells[-1], (*route, "length"))
        return
    (x, y), (width, height) = entry.at, level.size
    outer = {"N": y == 0, "W": x == 0, "S": y == height - 1, "E": x == width - 1}[entry.side]
    if outer and field == "openings":
        yield Problem(
            "BR310",
            (*route, "side"),
            f"side {entry.side} of {_show(entry.at)} is the outer wall, which cannot be opened",
        )
    elif outer and getattr(entry, "pass_", 0) > 0:
        yield Problem(
            "BR311",
            (*route, "pass"),
            f"side {entry.side} of {_show(entry.at)} is the outer wall, "
            "and there is nothing behind it",
            "remove `pass`",
        )


def _check_puddles(level: LevelFields, blocked: Callable[[Cell], bool]) -> Iterator[Problem]:
    seen: set[Cell] = set()
    for index, puddle in enumerate(level.puddles):
        route = ("puddles", index, "at")
        if not _inside(level, puddle.at):
            yield _off(level, "the puddle", puddle.at, route)
        elif blocked(puddle.at):
            yield Problem("BR306", route, f"the puddle {_show(puddle.at)} is on a blocked cell")
        elif puddle.at in seen:
            yield Problem(
                "BR307",
                route,
                f"there is a puddle on {_show(puddle.at)} already",
                "one cell has one puddle",
            )
        seen.add(puddle.at)


def _check_warps(level: LevelFields, blocked: Callable[[Cell], bool]) -> Iterator[Problem]:
    exits = set(level.exits)
    seen: set[Cell] = set()
    entered: dict[Cell, Cell] = {}
    for index, warp in enumerate(level.warps):
        at_is_good = True
        for field, cell in (("at", warp.at), ("to", warp.to)):
            if cell == "start" or isinstance(cell, str):
                continue
            route = ("warps", index, field)
            if not _inside(level, cell):
                yield _off(level, "the warp's cell", cell, route)
            elif blocked(cell):
                yield Problem(
                    "BR308", route, f"the warp's cell {_show(cell)} is blocked: it leads nowhere"
                )
            else:
                continue
            at_is_good = False
        if warp.at in seen:
            yield Problem(
                "BR307", ("warps", index, "at"), f"there is a warp on {_show(warp.at)} already"
            )
        elif warp.at in exits:
            yield Problem(
                "BR308",
                ("warps", index, "at"),
                f"the warp {_show(warp.at)} is on an exit, where the episode is over",
            )
        elif at_is_good and warp.when == "enter" and not isinstance(warp.to, str):
            entered[warp.at] = warp.to
        seen.add(warp.at)
    yield from _check_circles(level, entered)


def _check_circles(level: LevelFields, entered: dict[Cell, Cell]) -> Iterator[Problem]:
    """Report the warps from which a robot is sent round for ever."""
    index_of = {warp.at: index for index, warp in enumerate(level.warps)}
    done: set[Cell] = set()
    for first in entered:
        path: dict[Cell, None] = {}
        cell = first
        while cell in entered and cell not in done and cell not in path:
            path[cell] = None
            cell = entered[cell]
        if cell in path:
            circle = [*path][[*path].index(cell) :]
            way = " to ".join(_show(step) for step in [*circle[:8], cell])
            yield Problem(
                "BR308",
                ("warps", index_of[cell], "to"),
                f"the warp leads in a circle: {way}",
                "let one of them lead elsewhere",
            )
        done.update(path)


def _check_wind(level: LevelFields) -> Iterator[Problem]:
    if level.wind is None:
        return
    for side in ("north", "east", "south", "west"):
        strengths = getattr(level.wind, side)
        vertical = side in ("north", "south")
        count = level.size[0] if vertical else level.size[1]
        if strengths is not None and len(strengths) != count:
            line = "column" if vertical else "row"
            yield Problem(
                "BR315",
                ("wind", side),
                f"`{side}` gives {len(strengths)} strength{'s' * (len(strengths) != 1)} "
                f"for {count} {line}{'s' * (count != 1)}",
                f"give one for each {line}",
            )
