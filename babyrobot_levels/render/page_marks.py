"""Values and optimal actions on a page where they differ between configurations or headings.

What a cell shows is a *mark*: shapes relative to the cell, packed once for all cells and states
that show the same.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from typing import TYPE_CHECKING

from babyrobot_levels.render.page_shapes import Group, Palette, length, pack
from babyrobot_levels.render.scene.layout import CELL, Layout
from babyrobot_levels.render.scene.number_labels import HEIGHT, number_label
from babyrobot_levels.render.scene.overlay import Content, Overlay, Rows
from babyrobot_levels.render.scene.overlay_shapes import FreeSpace, arrow_shapes
from babyrobot_levels.render.scene.shapes import Shape

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld


class Marks:
    """The marks of a page.

    Args:
        level: the level.
        layout: where its cells are.
        palette: the palette of the page's picture.

    Attributes:
        packed: the shapes of each mark.
    """

    def __init__(self, level: GridWorld, layout: Layout, palette: Palette) -> None:
        self._colors, self._layout, self._palette = level.resolved_theme.colors, layout, palette
        self._free = FreeSpace(level, layout)
        # The lower edges of values, below which arrows keep clear.
        self._feet = {cell: self._free.take_foot(cell, HEIGHT) for cell in layout.cells()}
        self._numbers: dict[Hashable, int] = {}
        self._by_look: dict[str, int] = {}
        self.packed: list[list[Group]] = []

    def values(self, overlays: Iterable[Overlay]) -> list[int]:
        """Return the mark of each cell's value in each overlay in turn; -1 for none."""
        return [
            -1 if value is None else self._value(cell, value, overlay.precision)
            for overlay in overlays
            for cell, value in self._cells(overlay.values)
        ]

    def actions(self, overlays: Iterable[Overlay]) -> list[int]:
        """Return the mark of each cell's actions in each overlay in turn; -1 for none."""
        return [
            self._actions(cell, tuple(actions)) if actions else -1
            for overlay in overlays
            for cell, actions in self._cells(overlay.actions)
        ]

    def _cells(
        self, rows: Rows[Content] | None
    ) -> Iterable[tuple[tuple[int, int], Content | None]]:
        if rows is None:
            return ((cell, None) for cell in self._layout.cells())
        return zip(self._layout.cells(), (each for row in rows for each in row), strict=True)

    def _value(self, cell: tuple[int, int], value: float, precision: int) -> int:
        foot = self._feet[cell]
        key = "value", foot, value, precision
        if key not in self._numbers:
            left, upper = self._layout.corner(*cell)
            middle = left + CELL / 2
            shapes = number_label(value, middle, upper + foot, CELL - 4, precision, self._colors)
            self._add(key, cell, shapes)
        return self._numbers[key]

    def _actions(self, cell: tuple[int, int], actions: tuple[int, ...]) -> int:
        key = "actions", self._free[cell], actions
        if key not in self._numbers:
            color = self._colors.arrows
            shapes = arrow_shapes([(cell, actions)], self._free, self._layout, color, ())
            self._add(key, cell, shapes)
        return self._numbers[key]

    def _add(self, key: Hashable, cell: tuple[int, int], shapes: Iterable[Shape]) -> None:
        left, top = (length(edge) for edge in self._layout.corner(*cell))
        groups = pack(shapes, self._palette, self._layout.margin)
        mark = [[x - left, y - top, packed] for x, y, packed in groups]
        # Values that differ in what is not shown look the same.
        number = self._by_look.setdefault(repr(mark), len(self.packed))
        self._numbers[key] = number
        if number == len(self.packed):
            self.packed.append(mark)
