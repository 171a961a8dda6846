"""Values and optimal actions on a page where they differ between configurations or headings.

What a cell shows is a *mark*: shapes relative to the cell, packed once for all cells and states
that show the same.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from typing import TYPE_CHECKING

from babyrobot_levels.render.page_shapes import Group, Palette, length, pack
from babyrobot_levels.render.scene.cell_grounds import CellGrounds
from babyrobot_levels.render.scene.heat import FRAME, Heat, legend_shapes
from babyrobot_levels.render.scene.layout import CELL, Layout
from babyrobot_levels.render.scene.number_labels import number_shapes
from babyrobot_levels.render.scene.overlay import Overlay
from babyrobot_levels.render.scene.overlay_shapes import (
    Lengths,
    arrow_lengths,
    arrow_shapes,
    number_form,
)
from babyrobot_levels.render.scene.scale import ink_on, scale_of
from babyrobot_levels.render.scene.shapes import Path, Rect, Shape, polygon
from babyrobot_levels.render.scene.slots import Cell, Slots

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld


class Marks:
    """The marks of a page.

    Args:
        level: the level.
        layout: where its cells are.
        palette: the palette of the page's picture.
        slots: what stands where in its cells beside answers.
        overlays: everything that the page can show: all of it has one scale and form of numbers.

    Attributes:
        packed: the shapes of each mark.
        legend: the shapes of the legend.
    """

    def __init__(
        self,
        level: GridWorld,
        layout: Layout,
        palette: Palette,
        slots: Slots,
        overlays: Iterable[Overlay],
    ) -> None:
        self._level, self._layout, self._palette, self._slots = level, layout, palette, slots
        heats = [Heat(level, layout, overlay, slots) for overlay in overlays]
        numbers = [value for heat in heats for value in heat.values.values()]
        self._scale = scale_of(numbers, level.resolved_theme.colors)
        self._form = number_form(numbers, heats[0].overlay.precision if heats else 0)
        self._grounds = CellGrounds(level).own
        self.legend = tuple(legend_shapes(level, layout, self._scale, self._form)) if heats else ()
        self._numbers: dict[Hashable, int] = {}
        self._by_look: dict[str, int] = {}
        self.packed: list[list[Group]] = []

    def values(self, overlays: Iterable[Overlay]) -> dict[str, list[int]]:
        """Return the marks of each cell's value in each overlay in turn; -1 for none.

        Returns:
            Under `heat` those of the colours, under `values` those of the numbers.
        """
        marks: dict[str, list[int]] = {"heat": [], "values": []}
        for overlay in overlays:
            values = Heat(self._level, self._layout, overlay, self._slots).values
            for cell in self._layout.cells():
                tile = number = -1
                if cell in values:
                    color = self._scale.color(values[cell])
                    tile = self._tile(cell, color, self._grounds.get(cell))
                    number = self._value(cell, values[cell], color)
                marks["heat"].append(tile)
                marks["values"].append(number)
        return marks

    def actions(self, overlays: Iterable[Overlay]) -> list[int]:
        """Return the mark of each cell's actions in each overlay in turn; -1 for none."""
        marks = []
        for overlay in overlays:
            lengths = dict(arrow_lengths(overlay, self._slots, self._layout))
            marks += [self._actions(cell, lengths.get(cell, {})) for cell in self._layout.cells()]
        return marks

    def _tile(self, cell: Cell, color: str, ground: str | None) -> int:
        key = "tile", color, ground
        if key not in self._numbers:
            left, top = self._layout.corner(*cell)
            # The lines between the cells are seen beside it.
            shapes = [Rect(left + 0.5, top + 0.5, CELL - 1, CELL - 1, color)]
            if ground is not None:
                edge, side = FRAME / 2, CELL - FRAME
                frame = polygon(
                    (left + edge + x * side, top + edge + y * side)
                    for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))
                )
                self._add(key, cell, [*shapes, Path(frame, stroke=ground, width=FRAME)])
            else:
                self._add(key, cell, shapes)
        return self._numbers[key]

    def _value(self, cell: Cell, value: float, color: str) -> int:
        box = self._slots.plan(cell).number
        key = "value", box, value, color
        if key not in self._numbers:
            box = box.moved(*self._layout.corner(*cell))
            self._add(key, cell, number_shapes(value, self._form, box, ink_on(color), color))
        return self._numbers[key]

    def _actions(self, cell: Cell, lengths: Lengths) -> int:
        if not lengths:
            return -1
        key = "actions", self._slots.plan(cell).arrow, tuple(lengths.items())
        if key not in self._numbers:
            color = self._level.resolved_theme.colors.arrows
            shapes = arrow_shapes([(cell, lengths)], self._slots, self._layout, color)
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
