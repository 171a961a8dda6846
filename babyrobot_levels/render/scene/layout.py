"""Where things stand in a picture: the grid, the free space around it, panels and compass."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from babyrobot_levels.language.looks import Panel
from babyrobot_levels.render.scene.lines import height_of, wrapped
from babyrobot_levels.render.scene.overlays import Overlay

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

CELL = 64.0
"""The side of a cell in pixels."""

COMPASS = 72.0
"""The side of the square that the compass takes."""


@dataclass(frozen=True, slots=True)
class Layout:
    """The parts of a picture, in pixels.

    Attributes:
        columns: the number of columns of cells.
        rows: the number of rows of cells.
        margin: the free space around the grid.
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
        """The width of the grid with the free space around it."""
        return self.grid_width + 2 * self.margin

    @property
    def top_height(self) -> float:
        """The height of the grid with the free space around it."""
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
        cells_only: whether to leave out the free space, the panels and the compass.
        overlay: what is written on it; its lines are given a panel if the level has none.
    """
    columns, rows = level.size
    if cells_only:
        return Layout(columns, rows, 0.0, 0.0, 0.0)
    widths = level.resolved_theme.widths
    # Half of the outer wall stands outside of the cells, and must not be cut off.
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
