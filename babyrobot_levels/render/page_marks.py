"""Values and optimal actions on a page.

What a cell shows is a *mark*: shapes relative to the cell, packed once for all cells and states
that show the same.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from typing import TYPE_CHECKING

from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.render.page_shapes import BAR, Group, Palette, length, pack
from babyrobot_levels.render.scene.heat import Heat, legend_bar, legend_plate, legend_texts
from babyrobot_levels.render.scene.layout import Layout
from babyrobot_levels.render.scene.overlay import Overlay
from babyrobot_levels.render.scene.overlay_shapes import (
    Lengths,
    arrow_lengths,
    arrow_shapes,
    number_form,
)
from babyrobot_levels.render.scene.scale import ink_on, scale_of
from babyrobot_levels.render.scene.shapes import Shape
from babyrobot_levels.render.scene.slots import Slots
from babyrobot_levels.render.scene.texts import busy_cells, form_of, number_shapes

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
        tiles: the colour of the cell below each mark, as the palette counts them; -1 for none.
        scale: the scale of the tiles.
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
        self.scale = scale_of(numbers, level.resolved_theme.colors)
        self._precision = heats[0].overlay.precision if heats else 0
        self._form = number_form(numbers, self._precision)
        self._covered = busy_cells(level, layout, slots) | {*level.starts}
        self._numbers: dict[Hashable, int] = {}
        self._by_look: dict[tuple[str, int], int] = {}
        self.packed: list[list[Group]] = []
        self.tiles: list[int] = []

    @property
    def legend(self) -> list[Group]:
        """The legend of the tiles; no groups where the picture has none."""
        if not self._layout.legend:
            return []
        bar, ends = legend_bar(self._layout), (self.scale.low, self.scale.high)
        box = map(length, (bar.left, bar.top, bar.width, bar.height))
        plate, texts = (
            pack(shapes, self._palette, self._layout.margin)
            for shapes in (
                [legend_plate(self._level, self._layout)],
                legend_texts(self._level, self._layout, self.scale, form_of(ends, self._precision)),
            )
        )
        colors = [BAR, -1, *box, *map(self.scale.step, ends)]
        return [*plate, [0, 0, [colors]], *texts]

    def values(self, overlays: Iterable[Overlay]) -> list[int]:
        """Return the mark of each cell's value in each overlay in turn; -1 for none."""
        marks = []
        for overlay in overlays:
            values = Heat(self._level, self._layout, overlay, self._slots).values
            marks += [
                self._value(cell, values[cell]) if cell in values else -1
                for cell in self._layout.cells()
            ]
        return marks

    def actions(self, overlays: Iterable[Overlay]) -> list[int]:
        """Return the mark of each cell's actions in each overlay in turn; -1 for none."""
        marks = []
        for overlay in overlays:
            lengths = dict(arrow_lengths(overlay, self._slots, self._layout))
            marks += [self._actions(cell, lengths.get(cell, {})) for cell in self._layout.cells()]
        return marks

    def _value(self, cell: Cell, value: float) -> int:
        box, color = self._slots.plan(cell).number, self.scale.color(value)
        key = "value", box, value, cell in self._covered
        if key not in self._numbers:
            ground = color if cell in self._covered else None
            box = box.moved(*self._layout.corner(*cell))
            shapes = number_shapes(value, self._form, box, ink_on(color), ground)
            self._add(key, cell, shapes, self._palette.place(color))
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

    def _add(self, key: Hashable, cell: Cell, shapes: Iterable[Shape], tile: int = -1) -> None:
        left, top = (length(edge) for edge in self._layout.corner(*cell))
        groups = pack(shapes, self._palette, self._layout.margin)
        mark = [[x - left, y - top, packed] for x, y, packed in groups]
        # Values that differ in what is not shown look the same.
        number = self._by_look.setdefault((repr(mark), tile), len(self.packed))
        self._numbers[key] = number
        if number == len(self.packed):
            self.packed.append(mark)
            self.tiles.append(tile)
