"""What must hold between things and the level around them; walls are looked at with the grid."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import TYPE_CHECKING

from babyrobot_levels.language.geometry import (
    Cell,
    Route,
    is_inside,
    off_the_grid,
    show_cell,
)
from babyrobot_levels.language.things import Item, Mover, as_names
from babyrobot_levels.language.walls import sides_of
from babyrobot_levels.text.diagnostics import Issue, Key
from babyrobot_levels.text.words import did_you_mean

if TYPE_CHECKING:
    from babyrobot_levels.language.fields import LevelFields

IsBlocked = Callable[[Cell], bool]


def check_things(level: LevelFields, blocked: IsBlocked) -> Iterator[Issue]:
    """Yield the errors of items, doors, switches and movers."""
    if level.exit_one_of is not None and "exit" in level.model_fields_set:
        yield Issue(
            "BR206",
            Key(("exit_one_of",)),
            "`exit_one_of` cannot be combined with `exit`",
            "remove one of them",
        )
    if not (level.has_things or level.exit_keys):
        return
    yield from _check_names(level)
    yield from _check_needs(level)
    yield from _check_places(level, blocked)
    for index, _ in level.written("doors"):
        yield from _check_door(level, index)
    for index, mover in enumerate(level.movers):
        yield from _check_mover(level, mover, ("movers", index), blocked)
    if _has_random_maze(level):
        yield from _check_random_maze(level)


def _check_names(level: LevelFields) -> Iterator[Issue]:
    seen: set[str] = set()
    for field in ("items", "switches", "movers"):
        for index, thing in enumerate(getattr(level, field)):
            name = thing.name
            if name is not None and name in seen:
                yield Issue(
                    "BR320",
                    _entry(level, field, index, "name"),
                    f"the name `{name}` is used twice",
                    "give each item, switch and mover a name of its own",
                )
            seen.add(name)


def _entry(level: LevelFields, field: str, index: int, *more: str | int) -> Route:
    """Return the route of an entry, that of the drawing for what the drawing gives."""
    drawn = level._drawn.get(field, 0)
    return (field, index - drawn, *more) if index >= drawn else ("map",)


def _check_needs(level: LevelFields) -> Iterator[Issue]:
    known = [*(item.name for item in level.items), *(each.name for each in level.switches)]
    movers = {mover.name for mover in level.movers}
    told: list[tuple[str | tuple[str, ...], Route]] = [(level.exit_needs, ("exit_needs",))]
    for index, door in enumerate(level.doors):
        told += [(door.needs, ("doors", index, "needs")), (door.unless, ("doors", index, "unless"))]
    for names, route in told:
        for number, name in enumerate(as_names(names)):
            if name in known:
                continue
            where = route if isinstance(names, str) else (*route, number)
            if name in movers:
                message = f"`{name}` is a mover, which is neither held nor switched on"
                yield Issue("BR321", where, message, "name an item or a switch")
            else:
                message = f"there is no item or switch `{name}`{did_you_mean(name, known)}"
                yield Issue("BR321", where, message, _known(known))


def _known(names: list[str]) -> str:
    if not names:
        return "the level has no items and no switches"
    return "known names: " + ", ".join(names[:8]) + (", …" if len(names) > 8 else "")


def _check_places(level: LevelFields, blocked: IsBlocked) -> Iterator[Issue]:
    """Check where items and switches lie."""
    exits = set(level.exits)
    entered = {warp.at for warp in level.warps if warp.when == "enter"}
    seen: dict[Cell, str] = {}
    for what, name, cell, route in _lying(level):
        if not is_inside(level, cell):
            yield off_the_grid(level, f"the {what}", cell, route)
        elif blocked(cell) or cell in exits or cell in entered:
            on = (
                "a blocked cell"
                if blocked(cell)
                else "an exit"
                if cell in exits
                else "a warp that acts on entering"
            )
            yield Issue(
                "BR318", route, f"the {what} `{name}` {show_cell(cell)} is on {on}", "move it"
            )
        elif seen.get(cell) == name:
            yield Issue("BR305", route, f"{show_cell(cell)} is listed twice")
        elif cell in seen:
            yield Issue(
                "BR319",
                route,
                f"`{name}` and `{seen[cell]}` may both lie in {show_cell(cell)}",
                "move one of them: a cell holds one item or switch",
            )
        seen.setdefault(cell, name)
    for index, item in enumerate(level.items):
        yield from _check_item(level, item, index)


def _lying(level: LevelFields) -> Iterator[tuple[str, str, Cell, Route]]:
    """Yield what lies where: what it is, its name, its cell, and the route of the latter."""
    for index, item in enumerate(level.items):
        if item.at is not None:
            yield "item", item.name, item.at, _entry(level, "items", index, "at")
        for number, cell in enumerate(item.one_of or ()):
            yield "item", item.name, cell, _entry(level, "items", index, "one_of", number)
    for index, switch in enumerate(level.switches):
        yield "switch", switch.name, switch.at, _entry(level, "switches", index, "at")


def _check_item(level: LevelFields, item: Item, index: int) -> Iterator[Issue]:
    route = _entry(level, "items", index)
    if item.at is not None and item.one_of is not None:
        message = f"the item `{item.name}` has both `at` and `one_of`"
        yield Issue("BR206", route, message, "remove one of them")
    elif item.at is None and item.one_of is None:
        message = f"the item `{item.name}` lies nowhere"
        yield Issue("BR202", route, message, "add `at: [x, y]`, or `one_of` with several cells")


def _check_door(level: LevelFields, index: int) -> Iterator[Issue]:
    door, route = level.doors[index], ("doors", index)
    cells = sides_of(door)
    if not is_inside(level, door.at):
        yield off_the_grid(level, "the cell", door.at, (*route, "at"))
    elif not is_inside(level, cells[-1]):
        yield off_the_grid(level, "the last cell of the door", cells[-1], (*route, "length"))


def _check_mover(
    level: LevelFields, mover: Mover, route: Route, blocked: IsBlocked
) -> Iterator[Issue]:
    if mover.path is None and mover.within is None:
        help_text = "add `path` with the cells that it walks, or `within` with a rectangle"
        yield Issue("BR202", route, "the mover has neither `path` nor `within`", help_text)
    elif mover.path is not None and mover.within is not None:
        message = "the mover has both `path` and `within`"
        yield Issue("BR206", route, message, "remove one of them")
    elif mover.path is not None:
        yield from _check_path(level, mover, route, blocked)
    else:
        yield from _check_region(level, mover, route, blocked)


MAX_PATH = 1 << 14
"""The most cells of a path."""


def _check_path(
    level: LevelFields, mover: Mover, route: Route, blocked: IsBlocked
) -> Iterator[Issue]:
    path = mover.path or ()
    if len(path) > MAX_PATH:
        message = f"the path has {len(path):,} cells; the limit is {MAX_PATH:,}"
        yield Issue("BR205", (*route, "path"), message)
        return
    if mover.start is not None:
        message = "`start` belongs to `within`: a path begins with its first cell"
        yield Issue("BR206", (*route, "start"), message, "remove it")
    for number, cell in enumerate(path):
        where = (*route, "path", number)
        if not is_inside(level, cell):
            yield off_the_grid(level, "the path's cell", cell, where)
        elif blocked(cell):
            yield Issue("BR323", where, f"the path's cell {show_cell(cell)} is blocked")
    for number, (one, two) in enumerate(pairwise(path), 1):
        if _distance(one, two) > 1:
            message = f"{show_cell(two)} is no neighbour of {show_cell(one)}"
            yield Issue("BR323", (*route, "path", number), message, "a mover goes one cell a step")
    if not mover.back and len(path) > 1 and _distance(path[-1], path[0]) > 1:
        message = (
            f"the path is a loop, and {show_cell(path[-1])} is no neighbour of {show_cell(path[0])}"
        )
        help_text = "close the loop, or let the mover walk there and back with `back: true`"
        yield Issue("BR323", (*route, "path", len(path) - 1), message, help_text)


def _distance(one: Cell, two: Cell) -> int:
    return abs(one[0] - two[0]) + abs(one[1] - two[1])


MAX_REGION = 4096
"""The most cells of the rectangle of a mover."""


def _check_region(
    level: LevelFields, mover: Mover, route: Route, blocked: IsBlocked
) -> Iterator[Issue]:
    assert mover.within is not None
    (left, top), (width, height) = mover.within.at, mover.within.size
    last = (left + width - 1, top + height - 1)
    if mover.back:
        message = "`back` belongs to `path`: in a rectangle the mover walks at random"
        yield Issue("BR206", (*route, "back"), message, "remove it")
    if not is_inside(level, mover.within.at):
        yield off_the_grid(level, "the cell", mover.within.at, (*route, "within", "at"))
    elif not is_inside(level, last):
        yield off_the_grid(level, "the last cell of the rectangle", last, (*route, "within"))
    elif width * height > MAX_REGION:
        message = f"the rectangle has {width * height:,} cells; the limit is {MAX_REGION:,}"
        yield Issue("BR205", (*route, "within", "size"), message)
    else:
        for cell in mover.phases:
            if blocked(cell):
                message = f"the mover's rectangle contains the blocked cell {show_cell(cell)}"
                yield Issue("BR324", (*route, "within"), message, "make it smaller")
                break
        if mover.start is not None and mover.start not in mover.phases:
            message = f"the start {show_cell(mover.start)} is outside of the mover's rectangle"
            yield Issue("BR324", (*route, "start"), message)


def _has_random_maze(level: LevelFields) -> bool:
    return level.maze is not None and level.maze.seed == "random"


def _check_random_maze(level: LevelFields) -> Iterator[Issue]:
    help_text = "give the maze a seed"
    for index, _ in enumerate(level.doors):
        message = "a door needs a maze with a seed: walls that change may stand in its place"
        yield Issue("BR325", ("doors", index), message, help_text)
    for index, mover in enumerate(level.movers):
        if mover.path is not None:
            message = "a path needs a maze with a seed: walls that change may cut it off"
            yield Issue("BR325", ("movers", index, "path"), message, help_text)
