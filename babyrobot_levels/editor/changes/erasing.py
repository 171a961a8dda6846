"""What stands in cells, taken out of them."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Any

from babyrobot_levels.editor.changes.draft import Draft, names_of, replace_names
from babyrobot_levels.editor.changes.shapes import Box, Entry, cut_boxes
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.language.kinds import KIND, LISTED, NEEDED, Where
from babyrobot_levels.language.things import DRAWN_NAMES

STANDING = frozenset(kind.field for kind in LISTED if kind.where in (Where.CELL, Where.PATH))
"""What cannot stand in a blocked cell."""

GROUND = frozenset(kind.field for kind in LISTED if kind.where is Where.RECTANGLE)
"""What covers rectangles, of which a part can be taken away."""

_DRAWN = {mark: kind.field for kind in LISTED for mark in kind.marks}
"""The field whose entry would say what a mark of drawings says."""


def erase(
    draft: Draft,
    cells: Collection[Cell],
    fields: Collection[str],
    where: Callable[[Entry], bool] = lambda entry: True,
) -> None:
    """Take entries of some fields out of cells, and what is drawn there instead of them.

    A warp stands in its cell and in its target; a mover in all cells to which it comes.

    Args:
        draft: the level.
        cells: the cells.
        fields: of `STANDING` and `GROUND`.
        where: which of the entries are taken.
    """
    gone = {*cells}
    for field in fields:
        entries: list[Entry] = draft.data.get(field, [])
        if field in GROUND:
            cut_boxes(entries, gone, where)
        else:
            kept = [_without(each, gone) if where(each) else each for each in entries]
            entries[:] = [each for each in kept if each is not None]
    if draft.canvas is not None:
        for cell in gone:
            if _drawn_kind(draft, cell) in fields:
                draft.canvas.put(cell, d.PLAIN)
    forget_missing(draft)


def _without(entry: Entry, cells: set[Cell]) -> Entry | None:
    """Return an entry without some cells; None if nothing is left of it."""
    if entry.get("one_of"):
        return lying_in(entry, [c for c in map(as_cell, entry["one_of"]) if c not in cells])
    return entry if cells.isdisjoint(_cells_of(entry)) else None


def lying_in(item: Entry, cells: list[Cell]) -> Entry | None:
    """Return an item with other cells of which it lies in one; None without any."""
    places = [[*cell] for cell in cells]
    if len(places) != 1:
        return {**item, "one_of": places} if places else None
    # At its place in the entry.
    names = {"one_of": "at"}
    return {names.get(name, name): value for name, value in item.items()} | {"at": places[0]}


def _cells_of(entry: Entry) -> list[Cell]:
    """Return the cells in which an entry stands."""
    if entry.get("within") is not None:
        return [*Box.of(entry["within"]).cells]
    ends = [entry[name] for name in ("at", "to") if isinstance(entry.get(name), list)]
    return [*map(as_cell, (*ends, *(entry.get("path") or ())))]


def as_cell(value: Any) -> Cell:
    """Return a cell of the text as a tuple."""
    x, y = value
    return int(x), int(y)


def _drawn_kind(draft: Draft, cell: Cell) -> str | None:
    """Return the field whose entry would say what the drawing shows in a cell."""
    assert draft.canvas is not None
    character = draft.canvas.at(cell)
    if character in draft.level.legend:
        return KIND[draft.level.legend[character].kind].field
    return _DRAWN.get(character)


# -- names ---------------------------------------------------------------------------------


def forget_missing(draft: Draft) -> None:
    """Take out of the text what it says about things that are gone.

    These are characters of the legend that are no longer drawn, and names in `needs`, `unless`
    and `exit_needs`.
    """
    if draft.canvas is not None and draft.level.drawing is not None:
        shown = {character for row in draft.canvas.cells for character in row}
        for character in {*"".join(draft.level.drawing.cells)} - shown:
            draft.data.get("legend", {}).pop(character, None)
    gone = {*names_of(draft.level)} - {*_names(draft)}
    if gone:
        replace_names(draft, dict.fromkeys(gone))


def _names(draft: Draft) -> list[str]:
    """Return the names of what doors and exits can need now."""
    things = [thing for kind in NEEDED for thing in draft.data.get(kind.field, ())]
    drawn = [
        entry[kind]
        for entry in draft.data.get("legend", {}).values()
        for kind in DRAWN_NAMES
        if entry.get(kind) is not None
    ]
    # One whose name was removed has none; the level tells that it needs one.
    return [*(thing["name"] for thing in things if "name" in thing), *drawn]
