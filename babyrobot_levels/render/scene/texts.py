"""Texts on the grid: start, exit, labels of areas, notes, coordinates."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from babyrobot_levels.render.colors import ink_on, plate_for
from babyrobot_levels.render.scene.arrows import crossed_cells
from babyrobot_levels.render.scene.cell_grounds import CellGrounds
from babyrobot_levels.render.scene.layout import (
    CELL,
    CHARACTER_WIDTH,
    Layout,
)
from babyrobot_levels.render.scene.overlay import Note
from babyrobot_levels.render.scene.shapes import Rect, Shape, Text

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

_END_SIZE = 11.0
_COORDINATE_SIZE = 9.5
_LABEL_SIZES = (12.0, 10.5, 9.0)


def end_texts(level: GridWorld, layout: Layout) -> Iterator[Text]:
    """Yield START and EXIT at the bottom of their cells, where the robot does not hide them."""
    colors, display, grounds = level.resolved_theme.colors, level.display, CellGrounds(level)
    exits = level.exits if level.exit_one_of is None else ()
    for word, cells, shown, fill in (
        ("START", level.starts, display.start_text, colors.start_text),
        ("EXIT", exits, display.exit_text, colors.exit_text),
    ):
        for cell in cells if shown else ():
            yield end_text(word, layout, cell, ink_on([grounds[cell]], fill))


def end_text(word: str, layout: Layout, cell: tuple[int, int], fill: str) -> Text:
    """Return a word at the bottom of a cell."""
    centre, foot = layout.corner(cell[0] + 0.5, cell[1] + 1)
    return Text(centre, foot - 5, word, _END_SIZE, fill, bold=True)


def label_shapes(level: GridWorld, layout: Layout) -> Iterator[Shape]:
    """Yield the labels of areas at an edge, on a background that keeps them readable."""
    colors = level.resolved_theme.colors
    for area in level.areas:
        label = " ".join((area.label or "").split())
        if not label:
            continue
        room = area.size[0] * CELL - 16
        size, text = fit(label, room)
        width = len(text) * size * CHARACTER_WIDTH + size
        height = 1.35 * size
        x, top = layout.corner(area.at[0] + area.size[0] / 2, area.at[1])
        # Coordinates are at the upper edge.
        top += area.size[1] * CELL - height - 4 if level.display.coordinates else 4
        plate = plate_for(colors.text_fg, colors.text_bg)
        yield Rect(x - width / 2, top, width, height, plate, radius=height / 2)
        yield Text(x, top + 1.02 * size, text, size, colors.text_fg)


def fit(text: str, room: float) -> tuple[float, str]:
    """Return the largest font size at which a text fits; a text that never fits is shortened."""
    for size in _LABEL_SIZES:
        if len(text) * size * CHARACTER_WIDTH <= room:
            return size, text
    count = max(1, int(room / (_LABEL_SIZES[-1] * CHARACTER_WIDTH)) - 1)
    return _LABEL_SIZES[-1], text[:count].rstrip() + "…"


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
        fill = colors.text_fg if note.color is None else note.color
        plate = plate_for(fill, colors.text_bg)
        yield Rect(left, y - height / 2, width, height, plate, radius=height / 2)
        yield Text(left + width / 2, y + 0.342 * size, text, size, fill, bold=True)


def coordinate_texts(
    level: GridWorld, layout: Layout, tops: Mapping[tuple[int, int], float] | None = None
) -> Iterator[Shape]:
    """Yield the coordinates of each free cell, at its left; arrows of warps are cut off there.

    Args:
        level: the level.
        layout: where its cells are.
        tops: where the text begins in each cell, in pixels below its upper edge; by default, at
            the top.
    """
    colors, blocked = level.resolved_theme.colors, level.grid().blocked_cells
    crossed, grounds = crossed_cells(level, layout), CellGrounds(level)
    fills = dict.fromkeys(level.starts, colors.start_text)
    if level.exit_one_of is None:
        fills |= dict.fromkeys(level.exits, colors.exit_text)
    for x, y in layout.cells():
        if not blocked[y * layout.columns + x]:
            left, top = layout.corner(x, y)
            baseline = top + (tops[x, y] if tops else 4.0) + 10
            fill = ink_on([grounds[x, y]], fills.get((x, y), colors.arrows))
            text = f"{x},{y}"
            if (x, y) in crossed:
                width = len(text) * _COORDINATE_SIZE * CHARACTER_WIDTH + 2
                yield Rect(left + 5, baseline - 9, width, 11, grounds[x, y], radius=3)
            yield Text(left + 6, baseline, text, _COORDINATE_SIZE, fill, "start")
