"""What stands where in a level, each with the lines of the text that say so.

A place is a mapping that JSON can hold:

- `route`: by which gestures name it: that of its entry in the file, such as `["walls", 2]`; of what
  a drawing shows, `["map", x, y]` with its cell or `["map", x, y, side]` with its first side;
- `kind`: the name of its kind (`language.kinds`);
- `label`: what it is called;
- `cells`: where it stands, as `[x, y]`: a warp at its cell, then at its target;
- `sides`: at which sides it stands, as `[x, y, side]`: N only in the first row, W only in the first
  column, since any other N or W is the S or E of the neighbour;
- `lines`: its first and its last line, from 1; empty for a start or an exit that is left out;
- `columns`: its first and its last column, from 1; only of what a drawing shows;
- `fields`: its entry as the file gives it, with short forms written out (`forms.expanded`).

The walls of a maze have no places.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cache
from typing import Any

from babyrobot_levels.extensions.editor.forms import expanded
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.cells import GLASS_PASS, Opening, Rectangle, Warp, sides_of
from babyrobot_levels.language.fields import as_cells
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.language.kinds import KINDS, LISTED
from babyrobot_levels.language.things import Item, LegendEntry, Mover
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.document import Document, Node

MAX_LISTED = 1 << 18
"""The most cells of all rectangles that are listed; of further ones, only two corners are."""


def places_of(level: Level, document: Document) -> list[Place]:
    """Return everything that stands somewhere in the level of a document."""
    places = [*_ends(level, document), *drawn_places(level, document), *_entries(level, document)]
    places += _own_exits(level, document)
    left = MAX_LISTED
    for place in places:
        left -= len(place["cells"])
        if left < 0:
            place["cells"] = [place["cells"][0], place["cells"][-1]]
        place["cells"] = [[*cell] for cell in place["cells"]]
        place["sides"] = [[*side] for side in place["sides"]]
    return places


# -- entries of the file -------------------------------------------------------------------


def _ends(level: Level, document: Document) -> Iterator[Place]:
    """Yield starts and exits that are not drawn. Where several robots begin, they are."""
    exits = level.common_exits
    fields = {"start": ("start", "start", level.starts), "exit": ("exit", "exit", exits)}
    if level.map is not None:
        fields.clear()
    if level.robots:
        fields.pop("start", None)
    if level.exit_one_of is not None:
        fields["exit"] = ("exit_one_of", "possible exit", exits)
    for kind, (name, label, cells) in fields.items():
        node = document.root.children.get(name)
        is_list = node is not None and bool(cells) and isinstance(node.data[0], list)
        for number, cell in enumerate(cells):
            lines = []
            if node is not None:
                key = document.root.keys[name]
                lines = _lines(node.children[number]) if is_list else _lines(node, key)
            route: list[str | int] = [name, number] if is_list else [name]
            yield new_place(route, kind, label, cells=[cell], lines=lines)


def _entries(level: Level, document: Document) -> Iterator[Place]:
    """Yield what the lists of the file give."""
    for kind in LISTED:
        # The drawing may give puddles and blocked cells, which then are in no list.
        if kind.field not in document.data:
            continue
        nodes = document.root.children[kind.field].children
        for index, entry in level.written(kind.field):
            data = nodes[index].data
            yield new_place(
                [kind.field, index],
                kind.name,
                kind.called(entry),
                cells=[level.starts[index]] if kind.name == "robot" else _cells(entry),
                sides=[side_of(*cell, entry.side) for cell in sides_of(entry)]
                if isinstance(entry, Opening)
                else [],
                lines=_lines(nodes[index]),
                fields=expanded(data) if kind.name == "area" else data,
            )


def _own_exits(level: Level, document: Document) -> Iterator[Place]:
    """Yield the exits that only one of several robots has."""
    for index, robot in enumerate(level.robots):
        if robot.exit is not None:
            node = document.root.children["robots"].children[index].children["exit"]
            route: list[str | int] = ["robots", index, "exit"]
            label = f"exit of {robot.name}"
            yield new_place(route, "exit", label, cells=[robot.exit], lines=_lines(node))


def _cells(entry: Any) -> Iterable[Cell]:
    if isinstance(entry, Opening):
        return ()
    if isinstance(entry, Item):
        return entry.places
    if isinstance(entry, Mover):
        return entry.path or entry.phases
    if isinstance(entry, Rectangle):
        (left, top), (width, height) = entry.at, entry.size
        return [(x, y) for y in range(top, top + height) for x in range(left, left + width)]
    if isinstance(entry, Warp) and not isinstance(entry.to, str):
        return (entry.at, *as_cells(entry.to))
    cell: Cell = entry.at
    return (cell,)


def _lines(node: Node, key: Node | None = None) -> list[int]:
    """Return the first and the last line of a value, with its name if it has one."""
    text, last = node.source.text, node
    # A container of whole lines ends, for the parser, where the next value begins.
    while last.children and text[last.first] not in "[{*":
        last = [*last.children.values()][-1]
    end = last.first + len(text[last.first : last.last].rstrip())
    position = node.source.position
    return [position((key or node).first).line, position(max(end - 1, last.first)).line]


# -- what the drawing shows --------------------------------------------------------------


Place = dict[str, Any]

Look = tuple[str, str, dict[str, Any]]
"""Kind, label and fields of what a character shows."""


def drawn_places(level: Level, document: Document) -> Iterator[Place]:
    """Yield what the drawing shows. Doors, and walls with properties, have entries instead."""
    if level.drawing is None:
        return
    shown = _Drawing(level, document)
    legend = document.data.get("legend", {})
    looks = _looks() | {
        character: _look(entry, legend[character]) for character, entry in level.legend.items()
    }
    if level.robots:
        # Where they begin, robots are.
        looks.pop(d.START, None)
    for y, row in enumerate(level.drawing.cells):
        for x, character in enumerate(row):
            if character in looks:
                yield shown.place_of_cell(x, y, looks[character])
    plain = without_entries(level, level.drawing)
    for mark in (d.SOLID, d.GLASS):
        for (x, y), side, length in plain.runs(mark):
            yield shown.place_of_sides(x, y, side, length, mark)


def new_place(route: list[str | int], kind: str, label: str, **more: Any) -> Place:
    """Return a place, with nothing where nothing is given."""
    where = {"route": route, "kind": kind, "label": label}
    return {**where, "cells": [], "sides": [], "lines": [], "fields": {}, **more}


def without_entries(level: Level, drawing: d.Drawing) -> d.Drawing:
    """Return a drawing without the walls that have entries in `walls`."""
    marks = {"E": [[*row] for row in drawing.east], "S": [[*row] for row in drawing.south]}
    for _, wall in level.written("walls"):
        for x, y in sides_of(wall):
            x, y, side = side_of(x, y, wall.side)
            if side in marks and y < len(marks[side]) and x < len(marks[side][y]):
                marks[side][y][x] = d.OPEN
    east, south = (tuple(map("".join, marks[side])) for side in "ES")
    return replace(drawing, east=east, south=south)


def side_of(x: int, y: int, side: str) -> tuple[int, int, str]:
    """Return a side as places name it: as that of the neighbour in the north or the west."""
    if side == "W" and x > 0:
        return x - 1, y, "E"
    if side == "N" and y > 0:
        return x, y - 1, "S"
    return x, y, side


@cache
def _looks() -> dict[str, Look]:
    """Return what the marks of cells show."""
    looks: dict[str, Look] = {}
    for kind in KINDS:
        for mark, given in kind.marks.items():
            if kind.where != "side":
                label = (
                    kind.called(kind.entry({"at": (0, 0), **given})) if kind.model else kind.name
                )
                looks[mark] = (kind.name, label, {**given})
    return looks


def _look(entry: LegendEntry, data: dict[str, Any]) -> Look:
    """Return what a character of the legend shows, with the fields of an entry outside of it."""
    if entry.kind == "area":
        return "area", entry.label or "area", expanded(data)
    names: dict[str, str] = {entry.kind: "name"}
    fields = {names.get(field, field): value for field, value in data.items()}
    return entry.kind, fields["name"], fields


class _Drawing:
    """Says where the text has what a drawing shows."""

    def __init__(self, level: Level, document: Document):
        node = document.root.children["map"]
        corner = document.span(d.mark_of(level.map or "", 0, 0)).start
        # A drawing that is no block of literal text has other lines than its text.
        self.corner = corner if node.block else None
        self.span = node.span

    def place_of_cell(self, x: int, y: int, look: Look) -> Place:
        kind, label, fields = look
        spot = self._spot(2 * y, 4 * x, 1, 3)
        fields = {"at": [x, y], **fields}
        return new_place(["map", x, y], kind, label, cells=[(x, y)], fields=fields, **spot)

    def place_of_sides(self, x: int, y: int, side: str, length: int, mark: str) -> Place:
        passes = 0 if mark == d.SOLID else GLASS_PASS
        fields = {"at": [x, y], "side": side, "length": length, "pass": passes}
        if side == "E":
            sides = [(x, y + step, side) for step in range(length)]
            spot = self._spot(2 * y, 4 * x + 3, 2 * length - 1, 1)
        else:
            sides = [(x + step, y, side) for step in range(length)]
            spot = self._spot(2 * y + 1, 4 * x, 1, 4 * length - 1)
        label = f"glass {passes:g}" if passes else "wall"
        return new_place(["map", x, y, side], "wall", label, sides=sides, fields=fields, **spot)

    def _spot(self, row: int, column: int, rows: int, columns: int) -> dict[str, list[int]]:
        """Return the lines and columns of a part, which begins so far from the first cell."""
        if self.corner is None:
            return {"lines": [self.span.start.line, self.span.end.line]}
        row, column = self.corner.line + row, self.corner.column + column
        return {"lines": [row, row + rows - 1], "columns": [column, column + columns - 1]}
