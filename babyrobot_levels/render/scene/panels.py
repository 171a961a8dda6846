"""What stands beside the grid: panels and the compass."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from babyrobot_levels.language.looks import Panel
from babyrobot_levels.render.scene.layout import COMPASS, Layout, panel_width
from babyrobot_levels.render.scene.overlays import Overlay
from babyrobot_levels.render.scene.paths import polygon
from babyrobot_levels.render.scene.shapes import Ellipse, Path, Rect, Shape, Text

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

_NEEDLE = "#e5484d"


def panel_shapes(level: GridWorld, overlay: Overlay, layout: Layout) -> Iterator[Shape]:
    """Yield the ground of the panels: one beside the grid, one below both."""
    display, ground = level.display, level.resolved_theme.colors.text_bg
    if panel_width(display.side_panel) or overlay.side_panel:
        fill = _ground(display.side_panel, ground)
        yield Rect(layout.left_width, 0, layout.side, layout.top_height, fill)
    if layout.bottom:
        fill = _ground(display.bottom_panel, ground)
        yield Rect(0, layout.top_height, layout.width, layout.bottom, fill)


def _ground(panel: str | float | Panel, ground: str) -> str:
    return panel.color if isinstance(panel, Panel) and panel.color is not None else ground


def compass_shapes(level: GridWorld, layout: Layout) -> Iterator[Shape]:
    """Yield the compass, at the top of the strip beside the grid: north is up."""
    if not level.display.compass:
        return
    colors = level.resolved_theme.colors
    x = layout.left_width + layout.side / 2
    y = COMPASS / 2
    yield Ellipse(x, y, 31, 31, colors.text_bg)
    for down, fill in ((-1, _NEEDLE), (1, colors.text_fg)):
        yield Path(polygon([(x - 5, y), (x, y + 16 * down), (x + 5, y)]), fill=fill)
    for letter, across, along in (("N", 0, -1), ("E", 1, 0), ("S", 0, 1), ("W", -1, 0)):
        yield Text(x + 23.5 * across, y + 23.5 * along + 3.8, letter, 11, colors.text_fg, bold=True)
