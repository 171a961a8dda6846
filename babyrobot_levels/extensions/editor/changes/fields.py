"""Fields and entries, and what a drawing shows: set, removed, moved and fixed."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from babyrobot_levels.extensions.editor.changes import robots, routes
from babyrobot_levels.extensions.editor.changes.draft import (
    PUDDLES,
    Canvas,
    Draft,
    RefusedError,
    forget_missing,
    replace_names,
)
from babyrobot_levels.extensions.editor.changes.routes import Route
from babyrobot_levels.extensions.editor.changes.shapes import Entry, Run
from babyrobot_levels.extensions.editor.findings import fix_of
from babyrobot_levels.extensions.editor.gestures import Fix, Move, Remove, Set
from babyrobot_levels.extensions.editor.places import Place, drawn_places
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.cells import GLASS_PASS
from babyrobot_levels.language.geometry import Cell, show_cell
from babyrobot_levels.language.kinds import KIND, NEEDED
from babyrobot_levels.language.things import DRAWN_NAMES
from babyrobot_levels.linter.runner import Report, apply

_NEEDS = ("needs", "unless", "exit_needs")
"""Fields that hold names of things."""

_NAMES = {**{kind.field: ("name",) for kind in (*NEEDED, KIND["robot"])}, "legend": DRAWN_NAMES}
"""The fields that give a thing its name, by the fields that hold the entries."""

_ALONE = {"start": "start", "exit": "exit", "exit_one_of": "exit", "one_of": "at"}
"""Fields that list cells, each with the field that gives a single one."""


def set_field(draft: Draft, gesture: Set) -> None:
    """Give a field or an entry another value; None removes it."""
    route, value = gesture.route, routes.plain_value(gesture.value)
    if _is_drawn(route):
        legend = _set_drawn(draft, route, value)
        if legend is None:
            return
        route = legend
    if route[-1] in _NEEDS and isinstance(value, list) and len(value) < 2:
        value = value[0] if value else None
    if value is not None:
        _put(draft, route, value)
    elif isinstance(route[-1], int):
        _remove(draft, route)
    else:
        with _redrawn(draft, route):
            routes.remove(draft.data, route)


def remove_entry(draft: Draft, gesture: Remove) -> None:
    """Remove an entry or a field: doors no longer need a thing that is removed."""
    if _is_drawn(gesture.route):
        _remove_drawn(draft, gesture.route)
    else:
        _remove(draft, gesture.route)


def move_entry(draft: Draft, gesture: Move) -> None:
    """Move what stands at a route as far as from one cell to another."""
    (x, y), (to_x, to_y) = gesture.from_, gesture.to
    shift = to_x - x, to_y - y
    if _is_drawn(gesture.route):
        _move_drawn(draft, gesture.route, shift)
        return
    match gesture.route:
        case ["start" | "exit" as field] if field not in draft.data:
            draft.data[field] = [*getattr(draft.level, field)]
        case ["robots", int() as number]:
            robots.own_start(draft, number)
    with _redrawn(draft, gesture.route):
        value = routes.get(draft.data, gesture.route)
        routes.put(draft.data, gesture.route, _moved(value, shift, gesture.from_))


def fixed(report: Report, gesture: Fix) -> str:
    """Return the text of a report after the fix of one of its findings.

    Raises:
        RefusedError: there is no such finding, or it has no fix.
    """
    for found in report.diagnostics:
        place = (found.code, found.line, found.column)
        fix = fix_of(found)
        if place == (gesture.code, gesture.line, gesture.column) and fix is not None:
            assert report.source is not None
            return apply(fix.edits, report.source)
    raise RefusedError("this finding is no longer there, or has no fix")


def _put(draft: Draft, route: Route, value: Any) -> None:
    old = _name(draft, route)
    match route:
        case ["robots", int() as number, "start"]:
            robots.own_start(draft, number)
    if route[0] == "theme" and len(route) > 1 and isinstance(draft.data.get("theme"), str):
        draft.data["theme"] = draft.level.resolved_theme.model_dump(exclude_defaults=True)
    with _redrawn(draft, route):
        routes.put(draft.data, route, value)
    new = _name(draft, route)
    if old is not None and new is not None and old != new:
        replace_names(draft, {old: new})


def _remove(draft: Draft, route: Route) -> None:
    match route:
        case ["start"]:
            raise RefusedError("a level has a start: move it instead")
        case ["exit"]:
            draft.data["exit"] = "none"
        case [*above, "start" | "exit" | "exit_one_of" | "one_of" as field, int()]:
            _remove_cell(draft, [*above, field], route)
        case ["robots", int() as number]:
            robots.remove_robot(draft, number)
        case _:
            with _redrawn(draft, route):
                routes.remove(draft.data, route)
            forget_missing(draft)


def _remove_cell(draft: Draft, cells: Route, route: Route) -> None:
    """Remove a cell from a list of cells; one that is left alone is no list."""
    *above, field = cells
    routes.get(draft.data, route)
    left = routes.get(draft.data, cells)
    if len(left) == 1:
        _remove(draft, cells)
        return
    routes.remove(draft.data, route)
    weights = {"start": "start_weights", "exit_one_of": "exit_weights"}.get(str(field))
    if weights is not None and weights in draft.data:
        del draft.data[weights][int(route[-1])]
    if len(left) == 1:
        draft.data.pop(weights or "", None)
        routes.remove(draft.data, cells)
        routes.put(draft.data, [*above, _ALONE[str(field)]], left[0])


def _name(draft: Draft, route: Route) -> str | None:
    """Return the name of the thing that a route leads to, or into, if doors can need it."""
    fields = _NAMES.get(str(route[0]), ())
    if len(route) < 2 or not fields:
        return None
    entry = routes.get(draft.data, route[:2])
    if not isinstance(entry, dict):
        return None
    names = [entry[field] for field in fields if isinstance(entry.get(field), str)]
    return names[0] if names else None


def _moved(value: Any, shift: tuple[int, int], taken: Cell) -> Any:
    """Return a cell, some cells or an entry after it was moved by the cell that was taken."""
    match value:
        case [int() | float() as x, int() | float() as y]:
            to = int(x) + shift[0], int(y) + shift[1]
            if min(to) < 0:
                raise RefusedError(f"{show_cell(to)} is off the grid")
            return [*to]
        case {"to": [*to], "at": [*at]} if tuple(to) == taken and tuple(at) != taken:
            return {**value, "to": _moved(to, shift, taken)}
        case {"to": [[*_], *_] as cells, "at": [*at]} if tuple(at) != taken:
            return {**value, "to": _one_moved(cells, shift, taken)}
        case {"one_of": [*cells]}:
            return {**value, "one_of": _one_moved(cells, shift, taken)}
        case dict():
            parts = [name for name in ("at", "path", "within", "start") if name in value]
            return {**value, **{name: _moved(value[name], shift, taken) for name in parts}}
        case list():
            return [_moved(each, shift, taken) for each in value]
        case _:
            raise RefusedError("this cannot be moved")


def _one_moved(cells: list[Any], shift: tuple[int, int], taken: Cell) -> list[Any]:
    """Return some cells, of which the one that was taken was moved."""
    return [_moved(cell, shift, taken) if tuple(cell) == taken else cell for cell in cells]


# -- what a drawing shows ------------------------------------------------------------------


def _is_drawn(route: Route) -> bool:
    """Tell whether a route is of something that a drawing shows, and not of the drawing."""
    return route[0] == "map" and len(route) > 1


def _set_drawn(draft: Draft, route: Route, value: Any) -> Route | None:
    """Set a field of something drawn, or return the route in the legend that gives it."""
    place, canvas, field = _place_of(draft, route)
    x, y = place["fields"]["at"]
    match place["kind"], field:
        case kind, [name, *more] if KIND[kind].legend and name != "at":
            return ["legend", canvas.at((x, y)), kind if name == "name" else name, *more]
        case "puddle", ["size"] if isinstance(value, str) and value in PUDDLES:
            canvas.put((x, y), PUDDLES[value])
        case "wall", ["pass"] if value in (None, 0, GLASS_PASS):
            canvas.mark(Run.of_entry(place["fields"]), d.GLASS if value else d.SOLID)
        case "wall", ["pass" | "color" | "width" | "fit" as name]:
            run = Run.of_entry(place["fields"])
            if name == "pass":
                canvas.mark(run, d.GLASS)
            draft.entries("walls").append(run.entry(**{name: value}))
        case _, ["at"] if isinstance(value, list) and [*map(type, value)] == [int, int]:
            _move_drawn(draft, place["route"], (value[0] - x, value[1] - y))
        case _:
            raise RefusedError(
                f"the drawing gives `{routes.shown(field or route)}`: change it there"
            )
    return None


def _remove_drawn(draft: Draft, route: Route) -> None:
    """Remove something from the drawing, and from the legend what is no longer drawn."""
    place, canvas, _ = _place_of(draft, route)
    if place["sides"]:
        canvas.mark(Run.of_entry(place["fields"]), d.OPEN)
    else:
        (cell,) = place["cells"]
        canvas.put(cell, _taken_from(draft, canvas.at(cell))[1])
        forget_missing(draft)


def _move_drawn(draft: Draft, route: Route, shift: tuple[int, int]) -> None:
    """Move something in the drawing to where it shows nothing."""
    place, canvas, _ = _place_of(draft, route)
    right, down = shift
    x, y = place["fields"]["at"]
    to = x + right, y + down
    if place["sides"]:
        run = Run.of_entry(place["fields"])
        mark = canvas.marked(run)[0]
        canvas.mark(run, d.OPEN)
        run = Run.of_entry({**place["fields"], "at": to})
        if not _is_inner(canvas, run):
            raise RefusedError("a wall of a drawing stays within its outer wall")
        if {*canvas.marked(run)} != {d.OPEN}:
            raise RefusedError("another wall or a door stands there: remove it first")
        canvas.mark(run, mark)
        return
    width, height = draft.level.size
    if not (0 <= to[0] < width and 0 <= to[1] < height):
        raise RefusedError(f"{show_cell(to)} is off the grid")
    character, rest = _taken_from(draft, canvas.at((x, y)))
    canvas.put((x, y), rest)
    both = d.together(canvas.at(to), character)
    if both is None or both in {d.COVERED}.intersection(draft.level.legend):
        where = show_cell(to)
        raise RefusedError(f"{where} shows something already: a cell of a drawing shows one thing")
    canvas.put(to, both)


def _taken_from(draft: Draft, mark: str) -> tuple[str, str]:
    """Return what of a cell's mark is moved or removed, and what stays: a box leaves its target."""
    if mark == d.COVERED and mark not in draft.level.legend:
        return d.BOX, d.TARGET
    return mark, d.PLAIN


@contextmanager
def _redrawn(draft: Draft, route: Route) -> Iterator[None]:
    """Draw a wall or a door that has an entry anew after it was changed, or removed."""
    canvas, field = draft.canvas, route[0]
    if canvas is None or field not in ("walls", "doors") or len(route) < 2:
        yield
        return
    before = routes.get(draft.data, route[:2])
    run, count = Run.of_entry(before), len(draft.data[field])
    marks = canvas.marked(run) if _is_inner(canvas, run) else []
    yield
    if marks:
        canvas.mark(run, d.OPEN)
    if len(draft.data.get(field, ())) < count:
        return
    after = routes.get(draft.data, route[:2])
    try:
        run = Run.of_entry(after)
    except (KeyError, TypeError, ValueError):
        # The level tells what is wrong with it.
        return
    if _is_inner(canvas, run):
        canvas.mark(run, d.DOOR if field == "doors" else _wall_mark(after, marks))


def _place_of(draft: Draft, route: Route) -> tuple[Place, Canvas, Route]:
    """Return the place of something drawn, the drawing, and the rest of the route.

    Raises:
        RefusedError: the drawing shows nothing there.
    """
    length = 4 if len(route) > 3 and route[3] in ("N", "E", "S", "W") else 3
    places = drawn_places(draft.level, draft.document)
    place = next((each for each in places if each["route"] == route[:length]), None)
    if place is None or draft.canvas is None:
        raise RefusedError(f"the drawing shows nothing at `{routes.shown(route[:length])}`")
    return place, draft.canvas, route[length:]


def _is_inner(canvas: Canvas, run: Run) -> bool:
    """Tell whether a run lies on the grid, and not on the outer wall."""
    width, height = len(canvas.cells[0]), len(canvas.cells)
    lines, places = (width, height) if run.axis == "E" else (height, width)
    return 0 <= run.line < lines - 1 and 0 <= run.first < run.stop <= places


def _wall_mark(wall: Entry, marks: list[str]) -> str:
    """Return the mark of an entry of `walls`, whose sides had some marks before."""
    if "pass" in wall:
        return d.GLASS if wall["pass"] else d.SOLID
    return marks[0] if marks else d.SOLID
