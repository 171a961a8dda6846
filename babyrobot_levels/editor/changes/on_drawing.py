"""What a drawing shows, and its walls and doors that have entries too: set, removed and moved."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from babyrobot_levels.editor.changes.draft import PUDDLES, Canvas, Draft, RefusedError
from babyrobot_levels.editor.changes.erasing import forget_missing
from babyrobot_levels.editor.changes.routes import Route, get, shown
from babyrobot_levels.editor.changes.shapes import Entry, Run
from babyrobot_levels.editor.places import Place, drawn_places
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.geometry import show_cell
from babyrobot_levels.language.kinds import KIND
from babyrobot_levels.language.walls import GLASS_PASS


def is_drawn(route: Route) -> bool:
    """Tell whether a route is of something that a drawing shows, and not of the drawing."""
    return route[0] == "map" and len(route) > 1


def set_drawn(draft: Draft, route: Route, value: Any) -> Route | None:
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
            move_drawn(draft, place["route"], (value[0] - x, value[1] - y))
        case _:
            raise RefusedError(f"the drawing gives `{shown(field or route)}`: change it there")
    return None


def remove_drawn(draft: Draft, route: Route) -> None:
    """Remove something from the drawing, and from the legend what is no longer drawn."""
    place, canvas, _ = _place_of(draft, route)
    if place["sides"]:
        canvas.mark(Run.of_entry(place["fields"]), d.OPEN)
    else:
        (cell,) = place["cells"]
        canvas.put(cell, d.PLAIN)
        forget_missing(draft)


def move_drawn(draft: Draft, route: Route, shift: tuple[int, int]) -> None:
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
    character = canvas.at((x, y))
    canvas.put((x, y), d.PLAIN)
    if canvas.at(to) != d.PLAIN:
        where = show_cell(to)
        raise RefusedError(f"{where} shows something already: a cell of a drawing shows one thing")
    canvas.put(to, character)


@contextmanager
def redrawn(draft: Draft, route: Route) -> Iterator[None]:
    """Draw a wall or a door that has an entry anew after it was changed, or removed."""
    canvas, field = draft.canvas, route[0]
    if canvas is None or field not in ("walls", "doors") or len(route) < 2:
        yield
        return
    before = get(draft.data, route[:2])
    run, count = Run.of_entry(before), len(draft.data[field])
    marks = canvas.marked(run) if _is_inner(canvas, run) else []
    yield
    if marks:
        canvas.mark(run, d.OPEN)
    if len(draft.data.get(field, ())) < count:
        return
    after = get(draft.data, route[:2])
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
        raise RefusedError(f"the drawing shows nothing at `{shown(route[:length])}`")
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
