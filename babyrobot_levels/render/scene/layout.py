"""The layout of a picture: grid, margin, panels, compass, and lines of text."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from babyrobot_levels.language.looks import Panel
from babyrobot_levels.render.scene.overlay import Overlay

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

CELL = 64.0
"""The side of a cell in pixels."""

COMPASS = 72.0
"""The side of the compass's square in pixels."""


@dataclass(frozen=True, slots=True)
class Layout:
    """The parts of a picture, in pixels.

    Attributes:
        columns: the number of columns of cells.
        rows: the number of rows of cells.
        margin: the width of the margin around the grid.
        side: the width of the strip to the right of the grid, 0 for none.
        bottom: the height of the strip below the grid, 0 for none.
    """

    columns: int
    rows: int
    margin: float
    side: float
    bottom: float

    @property
    def grid_width(self) -> float:
        """The width of all cells."""
        return self.columns * CELL

    @property
    def grid_height(self) -> float:
        """The height of all cells."""
        return self.rows * CELL

    @property
    def left_width(self) -> float:
        """The width of the grid with its margins."""
        return self.grid_width + 2 * self.margin

    @property
    def top_height(self) -> float:
        """The height of the grid with its margins."""
        return self.grid_height + 2 * self.margin

    @property
    def width(self) -> float:
        """The width of the picture."""
        return self.left_width + self.side

    @property
    def height(self) -> float:
        """The height of the picture."""
        return self.top_height + self.bottom

    def corner(self, x: float, y: float) -> tuple[float, float]:
        """Return the top-left corner of a cell; halves give its centre."""
        return self.margin + x * CELL, self.margin + y * CELL

    def cells(self) -> Iterator[tuple[int, int]]:
        """Yield all cells, row by row."""
        return ((x, y) for y in range(self.rows) for x in range(self.columns))


def layout_of(
    level: GridWorld, *, cells_only: bool = False, overlay: Overlay | None = None
) -> Layout:
    """Return the layout of a level's picture.

    Args:
        level: the level.
        cells_only: whether to leave out the margin, the panels and the compass.
        overlay: what is shown over it; its lines get a panel if the level has none.
    """
    columns, rows = level.size
    if cells_only:
        return Layout(columns, rows, 0.0, 0.0, 0.0)
    widths = level.resolved_theme.widths
    # Half of the border is outside of the cells and must not be cut off.
    margin = float(math.ceil(max(widths.padding, widths.border / 2)))
    side, bottom = panel_width(level.display.side_panel), panel_width(level.display.bottom_panel)
    if overlay is not None and overlay.side_panel and not side:
        side = Panel().width
    if level.display.compass:
        side = max(side, COMPASS)
    if overlay is not None and overlay.bottom_panel and not bottom:
        width = columns * CELL + 2 * margin + side
        bottom = height_of(wrapped(overlay.bottom_panel, width))
    return Layout(columns, rows, margin, side, bottom)


def panel_width(panel: str | float | Panel) -> float:
    """Return a panel's width (of a bottom panel, its height) in pixels, 0 for `none`."""
    if isinstance(panel, Panel):
        return panel.width
    return 0.0 if isinstance(panel, str) else panel


CHARACTER_WIDTH = 0.58
"""The average width of a character, as a share of the font size."""

LINE = 18.0
"""The height of a panel's line in pixels."""

LINE_SIZE = 13.0
"""The font size of a panel's text."""

PANEL_EDGE = 10.0
"""The padding of a panel."""


def wrapped(texts: Sequence[str], width: float) -> list[str]:
    """Return texts wrapped into lines that fit into a panel of the given width in pixels."""
    columns = max(1, int((width - 2 * PANEL_EDGE) / (LINE_SIZE * CHARACTER_WIDTH)))
    return [
        line
        for text in texts
        for part in text.splitlines() or [""]
        for line in textwrap.wrap(part, columns) or [""]
    ]


def height_of(lines: Sequence[str]) -> float:
    """Return the height of a panel for the lines."""
    return 2 * PANEL_EDGE + LINE * len(lines)
