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
from typing import Any

from babyrobot_levels.editor.entries.drawn_places import Place, drawn_places, new_place, side_of
from babyrobot_levels.editor.entries.forms import expanded
from babyrobot_levels.language.cells import Rectangle, Warp
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.language.kinds import LISTED
from babyrobot_levels.language.things import Item, Mover
from babyrobot_levels.language.walls import Opening, sides_of
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.document import Document, Node

MAX_LISTED = 1 << 18
"""The most cells of all rectangles that are listed; of further ones, only two corners are."""


def places_of(level: Level, document: Document) -> list[Place]:
    """Return everything that stands somewhere in the level of a document."""
    places = [*_ends(level, document), *drawn_places(level, document), *_entries(level, document)]
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
    """Yield starts and exits that are not drawn."""
    fields = {"start": ("start", "start", level.starts), "exit": ("exit", "exit", level.exits)}
    if level.map is not None:
        fields.clear()
    if level.exit_one_of is not None:
        fields["exit"] = ("exit_one_of", "possible exit", level.exits)
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
                cells=_cells(entry),
                sides=_sides(entry),
                lines=_lines(nodes[index]),
                fields=expanded(data) if kind.name == "area" else data,
            )


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
        return (entry.at, entry.to)
    cell: Cell = entry.at
    return (cell,)


def _sides(entry: Any) -> list[tuple[int, int, str]]:
    is_run = isinstance(entry, Opening)
    return [side_of(x, y, entry.side) for x, y in sides_of(entry)] if is_run else []


def _lines(node: Node, key: Node | None = None) -> list[int]:
    """Return the first and the last line of a value, with its name if it has one."""
    text, last = node.source.text, node
    # A container of whole lines ends, for the parser, where the next value begins.
    while last.children and text[last.first] not in "[{*":
        last = [*last.children.values()][-1]
    end = last.first + len(text[last.first : last.last].rstrip())
    position = node.source.position
    return [position((key or node).first).line, position(max(end - 1, last.first)).line]
