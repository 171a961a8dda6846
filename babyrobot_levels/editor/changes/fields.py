"""Fields and entries of a level that are set, removed and moved, and fixes of findings."""

from __future__ import annotations

from typing import Any

from babyrobot_levels.editor.changes import on_drawing, routes
from babyrobot_levels.editor.changes.draft import Draft, RefusedError, replace_names
from babyrobot_levels.editor.changes.erasing import forget_missing
from babyrobot_levels.editor.changes.routes import Route
from babyrobot_levels.editor.gestures import Fix, Move, Remove, Set
from babyrobot_levels.language.geometry import Cell, show_cell
from babyrobot_levels.language.kinds import NEEDED
from babyrobot_levels.language.things import DRAWN_NAMES
from babyrobot_levels.linter.fixer import apply
from babyrobot_levels.linter.runner import Report

_NEEDS = ("needs", "unless", "exit_needs")
"""Fields that hold names of things."""

_NAMES = {**{kind.field: ("name",) for kind in NEEDED}, "legend": DRAWN_NAMES}
"""The fields that give a thing its name, by the fields that hold the entries."""

_ALONE = {"start": "start", "exit": "exit", "exit_one_of": "exit", "one_of": "at"}
"""Fields that list cells, each with the field that gives a single one."""


def set_field(draft: Draft, gesture: Set) -> None:
    """Give a field or an entry another value; None removes it."""
    route, value = gesture.route, routes.plain_value(gesture.value)
    if on_drawing.is_drawn(route):
        legend = on_drawing.set_drawn(draft, route, value)
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
        with on_drawing.redrawn(draft, route):
            routes.remove(draft.data, route)


def remove_entry(draft: Draft, gesture: Remove) -> None:
    """Remove an entry or a field: doors no longer need a thing that is removed."""
    if on_drawing.is_drawn(gesture.route):
        on_drawing.remove_drawn(draft, gesture.route)
    else:
        _remove(draft, gesture.route)


def move_entry(draft: Draft, gesture: Move) -> None:
    """Move what stands at a route as far as from one cell to another."""
    (x, y), (to_x, to_y) = gesture.from_, gesture.to
    shift = to_x - x, to_y - y
    if on_drawing.is_drawn(gesture.route):
        on_drawing.move_drawn(draft, gesture.route, shift)
        return
    match gesture.route:
        case ["start" | "exit" as field] if field not in draft.data:
            draft.data[field] = [*getattr(draft.level, field)]
    with on_drawing.redrawn(draft, gesture.route):
        value = routes.get(draft.data, gesture.route)
        routes.put(draft.data, gesture.route, _moved(value, shift, gesture.from_))


def fixed(report: Report, gesture: Fix) -> str:
    """Return the text of a report after the fix of one of its findings.

    Raises:
        RefusedError: there is no such finding, or it has no fix.
    """
    for found in report.diagnostics:
        place = (found.code, found.line, found.column)
        if place == (gesture.code, gesture.line, gesture.column) and found.fix is not None:
            assert report.source is not None
            return apply(found.fix.edits, report.source)
    raise RefusedError("this finding is no longer there, or has no fix")


def _put(draft: Draft, route: Route, value: Any) -> None:
    old = _name(draft, route)
    if route[0] == "theme" and len(route) > 1 and isinstance(draft.data.get("theme"), str):
        theme = draft.level.resolved_theme
        draft.data["theme"] = theme.model_dump(exclude_defaults=True)
    with on_drawing.redrawn(draft, route):
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
        case _:
            with on_drawing.redrawn(draft, route):
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
    if len(left) == 1:
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
        case {"one_of": [*cells]}:
            moved = [_moved(cell, shift, taken) if tuple(cell) == taken else cell for cell in cells]
            return {**value, "one_of": moved}
        case dict():
            parts = [name for name in ("at", "path", "within", "start") if name in value]
            return {**value, **{name: _moved(value[name], shift, taken) for name in parts}}
        case list():
            return [_moved(each, shift, taken) for each in value]
        case _:
            raise RefusedError("this cannot be moved")
