"""Things, warps and movers that are added."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from babyrobot_levels.editor.changes.draft import Draft, RefusedError, unused_name
from babyrobot_levels.editor.changes.routes import ordered, plain_value
from babyrobot_levels.editor.changes.shapes import Box
from babyrobot_levels.editor.gestures import Paint, Path, Warp
from babyrobot_levels.language.geometry import Cell, show_cell
from babyrobot_levels.language.kinds import KIND, NEEDED
from babyrobot_levels.language.things import SHAPES
from babyrobot_levels.text.words import listed


def add_things(draft: Draft, gesture: Paint) -> None:
    """Add a thing of the brush's kind in each cell of a gesture that has none yet."""
    brush = KIND[gesture.brush]
    things = [thing for kind in NEEDED for thing in kind.of(draft.level)]
    taken = {cell for thing in things for cell in thing.places}
    cells = [cell for cell in dict.fromkeys(gesture.cells) if cell not in taken]
    if not cells:
        where = show_cell(gesture.cells[0])
        nouns = listed([kind.one for kind in NEEDED], "or")
        raise RefusedError(f"{where} has {nouns} already: a cell holds one")
    fields = plain_value(gesture.fields)
    has_shape = "shape" in brush.properties
    usual = SHAPES[0] if has_shape else brush.noun
    base = str(fields.pop("name", None) or fields.get("shape") or usual)
    if has_shape and base in SHAPES:
        fields.setdefault("shape", base)
    for cell in cells:
        name = unused_name(draft, base)
        entry = {**fields, "name": name, "at": [*cell]}
        if entry.get("shape") == name:
            # The shape of its name is its shape anyway.
            del entry["shape"]
        draft.entries(brush.field).append(ordered(brush.field, entry))


def add_warp(draft: Draft, gesture: Warp) -> None:
    """Add a warp, or lead the warp that the cell has to another one."""
    for warp in draft.data.get("warps", []):
        if tuple(warp["at"]) == gesture.at:
            warp["to"] = [*gesture.to]
            return
    draft.entries("warps").append({"at": [*gesture.at], "to": [*gesture.to]})


def add_mover(draft: Draft, gesture: Path) -> None:
    """Add a guard on a path, or a wanderer in a rectangle."""
    if gesture.rectangle:
        x, y, columns, rows = Box.between(gesture.cells[0], gesture.cells[-1])
        within = {"at": [x, y], "size": [columns, rows]}
        draft.entries("movers").append({"within": within})
        return
    path = [*_joined(gesture.cells)]
    if len(path) > 1 and path[0] == path[-1]:
        path.pop()
    is_loop = _distance(path[-1], path[0]) <= 1
    back = {} if is_loop else {"back": True}
    draft.entries("movers").append({"path": [[*cell] for cell in path], **back})


def _joined(cells: list[Cell]) -> Iterator[Cell]:
    """Yield cells with those between two of a row or a column, which a fast pointer leaves out."""
    yield cells[0]
    for (x, y), (to_x, to_y) in pairwise(cells):
        steps = max(abs(to_x - x), abs(to_y - y))
        if min(abs(to_x - x), abs(to_y - y)):
            yield to_x, to_y
            continue
        for step in range(1, steps + 1):
            yield x + (to_x - x) * step // steps, y + (to_y - y) * step // steps


def _distance(one: Cell, other: Cell) -> int:
    return abs(one[0] - other[0]) + abs(one[1] - other[1])
