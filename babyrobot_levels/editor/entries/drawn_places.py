"""What the drawing of a level shows, as places; see `places.py`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import Any

from babyrobot_levels.editor.entries.forms import expanded
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.kinds import KINDS, Where
from babyrobot_levels.language.things import LegendEntry
from babyrobot_levels.language.walls import GLASS_PASS, sides_of
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.document import Document

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
            if kind.where is not Where.SIDE:
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
