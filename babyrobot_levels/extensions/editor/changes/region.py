"""Regions: what a rectangle of cells has, taken from a level and stamped into one."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Set
from dataclasses import dataclass
from typing import Any

from babyrobot_levels.extensions.editor.changes import routes
from babyrobot_levels.extensions.editor.changes.cells import box_between, cost_of_hits
from babyrobot_levels.extensions.editor.changes.draft import (
    GROUND,
    KIND_OF_FIELD,
    PUDDLES,
    STANDING,
    Draft,
    RefusedError,
    as_cell,
    erase,
    known_names,
    lying_in,
    replace_in,
    unused_name,
)
from babyrobot_levels.extensions.editor.changes.placement import Placement
from babyrobot_levels.extensions.editor.changes.shapes import Box, Entry, Run, cut_boxes, cut_sides
from babyrobot_levels.extensions.editor.changes.walls import PLAIN_FIELDS
from babyrobot_levels.extensions.editor.gestures import Stamp
from babyrobot_levels.extensions.editor.places import places_of
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.cells import GLASS_PASS
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.language.kinds import KIND
from babyrobot_levels.language.things import SHAPES, as_names
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.document import Document

Names = dict[str, str]
"""The names that things of a region have got, by those that they had."""

_SIDES = ("walls", "openings", "doors")


@dataclass(frozen=True, slots=True)
class Region:
    """What a rectangle of cells has, with the sides around it.

    Attributes:
        size: its columns and rows.
        entries: the fields and entries, with places counted from its first cell.
        left: how many of which kinds are no part of it: starts and exits, which a level has
            once, and what stands partly outside.
    """

    size: tuple[int, int]
    entries: tuple[tuple[str, Entry], ...]
    left: Counter[str]


def lifted(level: Level, document: Document, one: Cell, other: Cell) -> Region:
    """Return the region of which two cells are opposite corners.

    Walls of a maze, and wind, are no part of it.

    Raises:
        RefusedError: the cells are off the grid, or these are too many.
    """
    box = box_between(level, one, other)
    inside = Placement(level.size, (box.columns, box.rows), (-box.x, -box.y))
    entries, left = [], Counter[str]()
    for place in places_of(level, document):
        kind = KIND[place["kind"]]
        if not (place["sides"] or any(map(box.has, map(as_cell, place["cells"])))):
            continue
        entry = None
        if kind.is_listed and kind.name != "robot":
            is_drawn = place["route"][0] == "map"
            data = place["fields"] if is_drawn else routes.get(document.data, place["route"])
            entry = inside.entry(kind.field, data)
        if entry is not None:
            entries.append((kind.field, entry))
        elif not place["sides"]:
            left[kind.name] += 1
    return Region((box.columns, box.rows), tuple(entries), left)


def stamp(draft: Draft, region: Region, gesture: Stamp) -> None:
    """Make cells what a region is. Starts and exits stay, and sides around it that it leaves open.

    Things get names of their own, and its doors need these. What cannot stand there is left out.
    """
    level = draft.level
    place = Placement(region.size, level.size, gesture.at, gesture.mirror)
    box = place.box(Box(0, 0, *region.size))
    if box is None:
        raise RefusedError("this is off the grid")
    draft.left.update(region.left)
    ends = {*level.starts, *level.exits}
    _clear(draft, box, ends)
    names: Names = {}
    # Doors come last: they need the names that things have got.
    for field, entry in sorted(region.entries, key=lambda each: each[0] == "doors"):
        moved = place.entry(field, entry)
        if moved is not None and not _put(draft, field, moved, names, ends):
            draft.left[KIND_OF_FIELD[field].name] += 1


def _clear(draft: Draft, box: Box, ends: Set[Cell]) -> None:
    """Take everything out of a rectangle, but for starts and exits."""
    erase(draft, [cell for cell in box.cells if cell not in ends], STANDING | GROUND)
    for run in _inner_runs(box):
        for field in _SIDES:
            cut_sides(draft.entries(field), run)
        if draft.canvas is not None:
            draft.canvas.mark(run, d.OPEN)


def _inner_runs(box: Box) -> Iterator[Run]:
    """Yield the lines of sides between the cells of a rectangle."""
    for x in range(box.x, box.x + box.columns - 1):
        yield Run("E", x, box.y, box.y + box.rows)
    for y in range(box.y, box.y + box.rows - 1):
        yield Run("S", y, box.x, box.x + box.columns)


def _put(draft: Draft, field: str, entry: Entry, names: Names, ends: Set[Cell]) -> bool:
    """Add an entry; tell whether it can stand there."""
    if field in _SIDES:
        return _put_side(draft, field, entry, names)
    if field in GROUND:
        return _put_ground(draft, field, entry, ends)
    at = entry.get("one_of") or ([entry["at"]] if "at" in entry else [])
    if not ends.isdisjoint(map(as_cell, at)):
        return False
    if field == "movers":
        cost_of_hits(draft)
    if field == "puddles" and draft.canvas is not None:
        draft.canvas.put(as_cell(entry["at"]), PUDDLES[entry.get("size", "small")])
    elif entry.get("name") in names:
        _lay_there_too(draft.entries(field), names[entry["name"]], at)
    else:
        draft.entries(field).append(routes.ordered(field, _named(draft, field, entry, names)))
    return True


def _named(draft: Draft, field: str, entry: Entry, names: Names) -> Entry:
    """Return an entry with a name that nothing has yet, if it has a name."""
    name = entry.get("name")
    if name is None:
        return entry
    names[name] = unused_name(draft, name)
    # An item without a shape has that of its name.
    has_shape = field == "items" and name in SHAPES and names[name] != name
    return {**({"shape": name} if has_shape else {}), **entry, "name": names[name]}


def _lay_there_too(items: list[Entry], name: str, cells: list[Any]) -> None:
    """Let an item lie in one of further cells: a drawing shows it in each of them."""
    index = next(index for index, item in enumerate(items) if item["name"] == name)
    places = items[index].get("one_of") or [items[index]["at"]]
    item = {**items[index], "one_of": places}
    item.pop("at", None)
    items[index] = lying_in(item, [*map(as_cell, [*places, *cells])]) or item


def _put_ground(draft: Draft, field: str, entry: Entry, ends: Set[Cell]) -> bool:
    """Add a rectangle, but for starts and exits where nobody could be then."""
    parts = [entry]
    if field == "blocked" or entry.get("ends"):
        cut_boxes(parts, {*ends}, lambda entry: True)
    if field == "blocked" and draft.canvas is not None:
        for cell in (cell for part in parts for cell in Box.of(part).cells):
            draft.canvas.put(cell, d.BLOCKED)
    else:
        draft.entries(field).extend(parts)
    return bool(parts)


def _put_side(draft: Draft, field: str, entry: Entry, names: Names) -> bool:
    """Add a wall, an opening or a door instead of what is there; the outer wall stays."""
    run = Run.of_entry(entry)
    last = draft.level.size[0 if run.axis == "E" else 1] - 1
    if not 0 <= run.line < last or (field == "openings" and draft.level.maze is None):
        return True
    if not _keep_needs(draft, entry, names):
        return False
    for other in _SIDES:
        # In a maze, a door stands in an opening.
        if (field, other) != ("doors", "openings"):
            cut_sides(draft.entries(other), run)
    if draft.canvas is not None:
        draft.canvas.mark(run, _mark(field, entry))
        if entry.get("pass") in (0, GLASS_PASS):
            entry.pop("pass")
    if draft.canvas is None or field != "walls" or not PLAIN_FIELDS.issuperset(entry):
        draft.entries(field).append(entry)
    return True


def _keep_needs(draft: Draft, entry: Entry, names: Names) -> bool:
    """Let a door need things by their new names; tell whether there are these."""
    fields = ("needs", "unless")
    for field in fields:
        replace_in(entry, field, names)
    needed = {name for field in fields for name in as_names(entry.get(field, ()))}
    return needed <= {*known_names(draft)}


def _mark(field: str, entry: Entry) -> str:
    """Return the mark of drawings that shows a side."""
    if field != "walls":
        return d.DOOR if field == "doors" else d.OPEN
    return d.GLASS if entry.get("pass") else d.SOLID
