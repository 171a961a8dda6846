"""Texts on the grid: start, exit, labels of areas, coordinates."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from babyrobot_levels.render.scene.layout import CELL, Layout
from babyrobot_levels.render.scene.lines import CHARACTER_WIDTH
from babyrobot_levels.render.scene.shapes import Rect, Shape, Text

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

_END_SIZE = 11.0
_COORDINATE_SIZE = 9.5
_LABEL_SIZES = (12.0, 10.5, 9.0)


def end_texts(level: GridWorld, layout: Layout) -> Iterator[Text]:
    """Yield START and EXIT, at the foot of their cells, where the robot does not hide them."""
    colors, display = level.resolved_theme.colors, level.display
    for word, cells, shown, fill in (
        ("START", level.starts, display.start_text, colors.start_text),
        ("EXIT", level.exits, display.exit_text, colors.exit_text),
    ):
        for x, y in cells if shown else ():
            centre, foot = layout.corner(x + 0.5, y + 1)
            yield Text(centre, foot - 5, word, _END_SIZE, fill, bold=True)


def label_shapes(level: GridWorld, layout: Layout) -> Iterator[Shape]:
    """Yield the labels of areas, at an edge, on a ground that keeps them readable."""
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
        # Coordinates stand at the upper edge.
        top += area.size[1] * CELL - height - 4 if level.display.coordinates else 4
        yield Rect(x - width / 2, top, width, height, colors.text_bg, radius=height / 2)
        yield Text(x, top + 1.02 * size, text, size, colors.text_fg)


def fit(text: str, room: float) -> tuple[float, str]:
    """Return the largest size at which a text has room; what still has none is cut."""
    for size in _LABEL_SIZES:
        if len(text) * size * CHARACTER_WIDTH <= room:
            return size, text
    count = max(1, int(room / (_LABEL_SIZES[-1] * CHARACTER_WIDTH)) - 1)
    return _LABEL_SIZES[-1], text[:count].rstrip() + "…"


def coordinate_texts(
    level: GridWorld, layout: Layout, tops: Mapping[tuple[int, int], float] | None = None
) -> Iterator[Text]:
    """Yield the coordinates of each free cell, at its left.

    Args:
        level: the level.
        layout: where its cells are.
        tops: how many pixels below its upper edge each cell has room; by default, all have it
            there.
    """
    colors, blocked = level.resolved_theme.colors, level.grid().blocked_cells
    fills = dict.fromkeys(level.starts, colors.start_text)
    fills |= dict.fromkeys(level.exits, colors.exit_text)
    for x, y in layout.cells():
        if not blocked[y * layout.columns + x]:
            left, top = layout.corner(x, y)
            baseline = top + (tops[x, y] if tops else 4.0) + 10
            fill = fills.get((x, y), colors.arrows)
            text = f"{x},{y}"
            yield Text(left + 6, baseline, text, _COORDINATE_SIZE, fill, "start", opacity=0.85)
