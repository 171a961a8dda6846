"""Texts on the grid: start, exit, labels of areas, notes, coordinates."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from babyrobot_levels.render.scene.layout import CHARACTER_WIDTH, Layout, fit
from babyrobot_levels.render.scene.overlay import Note
from babyrobot_levels.render.scene.scale import ink_on
from babyrobot_levels.render.scene.shapes import Rect, Shape, Text
from babyrobot_levels.render.scene.slots import Cell, Slots

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

_END_SIZE, _SMALL_END_SIZE = 11.0, 8.5
_COORDINATE_SIZE = 9.5

NO_TILES: Mapping[Cell, str] = {}


def end_texts(level: GridWorld, layout: Layout, slots: Slots) -> Iterator[Shape]:
    """Yield START and EXIT: at the foot of their cells, or beside answers at the top."""
    colors, display = level.resolved_theme.colors, level.display
    exits = level.exits if level.exit_one_of is None else ()
    for word, cells, shown, fill, ground in (
        ("START", level.starts, display.start_text, colors.start_text, colors.start),
        ("EXIT", exits, display.exit_text, colors.exit_text, colors.exit),
    ):
        for cell in cells if shown else ():
            box = slots.plan(cell).word
            if box is None:
                continue
            box = box.moved(*layout.corner(*cell))
            if slots.is_small(cell):
                yield Rect(box.left, box.top, box.width, box.height, ground, radius=3.0)
                yield Text(box.centre[0], box.bottom - 2.2, word, _SMALL_END_SIZE, fill, bold=True)
            else:
                yield Text(box.centre[0], box.bottom, word, _END_SIZE, fill, bold=True)


def end_text(word: str, layout: Layout, cell: Cell, fill: str) -> Text:
    """Return a word at the foot of a cell."""
    centre, foot = layout.corner(cell[0] + 0.5, cell[1] + 1)
    return Text(centre, foot - 5, word, _END_SIZE, fill, bold=True)


def label_shapes(level: GridWorld, slots: Slots) -> Iterator[Shape]:
    """Yield the labels of areas, on a background that keeps them readable."""
    colors = level.resolved_theme.colors
    for box, size, text in slots.labels:
        yield Rect(*box[:2], box.width, box.height, colors.text_bg, radius=box.height / 2)
        yield Text(box.centre[0], box.top + 1.02 * size, text, size, colors.text_fg)


def note_shapes(level: GridWorld, notes: Sequence[Note], layout: Layout) -> Iterator[Shape]:
    """Yield notes on the grid, each on a background that keeps it readable."""
    colors = level.resolved_theme.colors
    left_edge, right_edge = layout.margin + 2, layout.margin + layout.grid_width - 2
    for note in notes:
        line = " ".join(note.text.split())
        if not line:
            continue
        size, text = fit(line, layout.grid_width - 16)
        width, height = len(text) * size * CHARACTER_WIDTH + size, 1.4 * size
        x, y = layout.corner(note.x + 0.5, note.y + 0.5)
        # A note that would stick out of the grid is moved inwards.
        left = min(max(x - width / 2, left_edge), right_edge - width)
        yield Rect(left, y - height / 2, width, height, colors.text_bg, radius=height / 2)
        fill = colors.text_fg if note.color is None else note.color
        yield Text(left + width / 2, y + 0.342 * size, text, size, fill, bold=True)


def coordinate_texts(
    level: GridWorld, layout: Layout, slots: Slots, tiles: Mapping[Cell, str] = NO_TILES
) -> Iterator[Text]:
    """Yield the coordinates of each free cell, at its left; see `end_texts`."""
    colors, blocked = level.resolved_theme.colors, level.grid().blocked_cells
    fills = dict.fromkeys(level.starts, colors.start_text)
    if level.exit_one_of is None:
        fills |= dict.fromkeys(level.exits, colors.exit_text)
    for x, y in layout.cells():
        if not blocked[y * layout.columns + x]:
            box = slots.plan((x, y)).coordinates.moved(*layout.corner(x, y))
            fill = fills.get((x, y), colors.arrows)
            fill = ink_on(tiles[x, y]) if (x, y) in tiles else fill
            text = f"{x},{y}"
            yield Text(box.left, box.bottom, text, _COORDINATE_SIZE, fill, "start", opacity=0.85)
