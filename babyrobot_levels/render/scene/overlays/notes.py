"""Texts that users write: anywhere on the grid, and as lines in the panels."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from babyrobot_levels.language.looks import Panel
from babyrobot_levels.render.scene.layout import COMPASS, Layout
from babyrobot_levels.render.scene.lines import (
    CHARACTER_WIDTH,
    LINE,
    LINE_SIZE,
    PANEL_EDGE,
    wrapped,
)
from babyrobot_levels.render.scene.overlays import Note, Overlay
from babyrobot_levels.render.scene.shapes import Rect, Shape, Text
from babyrobot_levels.render.scene.texts import fit

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld


def note_shapes(level: GridWorld, notes: Sequence[Note], layout: Layout) -> Iterator[Shape]:
    """Yield texts on the grid, each on a ground that keeps it readable."""
    colors = level.resolved_theme.colors
    left_edge, right_edge = layout.margin + 2, layout.margin + layout.grid_width - 2
    for note in notes:
        line = " ".join(note.text.split())
        if not line:
            continue
        size, text = fit(line, layout.grid_width - 16)
        width, height = len(text) * size * CHARACTER_WIDTH + size, 1.4 * size
        x, y = layout.corner(note.x + 0.5, note.y + 0.5)
        # What would stick out of the grid is moved in.
        left = min(max(x - width / 2, left_edge), right_edge - width)
        yield Rect(left, y - height / 2, width, height, colors.text_bg, radius=height / 2)
        fill = colors.text_fg if note.color is None else note.color
        yield Text(left + width / 2, y + 0.342 * size, text, size, fill, bold=True)


def panel_texts(level: GridWorld, overlay: Overlay, layout: Layout) -> Iterator[Text]:
    """Yield the lines of the panels; long ones are broken, and what has no room is left out."""
    display, color = level.display, level.resolved_theme.colors.text_fg
    top = COMPASS if display.compass else 0.0
    if layout.side:
        yield from _lines(
            overlay.side_panel,
            (layout.left_width, top, layout.side, layout.top_height - top),
            _text_color(display.side_panel, color),
        )
    if layout.bottom:
        yield from _lines(
            overlay.bottom_panel,
            (0.0, layout.top_height, layout.width, layout.bottom),
            _text_color(display.bottom_panel, color),
        )


def _text_color(panel: str | float | Panel, color: str) -> str:
    own = panel.text_color if isinstance(panel, Panel) else None
    return color if own is None else own


def _lines(
    texts: Sequence[str], box: tuple[float, float, float, float], fill: str
) -> Iterator[Text]:
    left, top, width, height = box
    lines = wrapped(texts, width)
    room = max(1, int((height - PANEL_EDGE) / LINE))
    if len(lines) > room:
        lines = [*lines[: room - 1], "…"]
    for number, line in enumerate(lines):
        if line:
            baseline = top + PANEL_EDGE + LINE * number + 0.75 * LINE
            yield Text(left + PANEL_EDGE, baseline, line, LINE_SIZE, fill, "start")
