"""The room that is free in each cell; whatever is written into a cell takes its part of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from babyrobot_levels.render.scene.layout import CELL, Layout
from babyrobot_levels.render.scene.shapes import Rect
from babyrobot_levels.render.scene.texts import end_texts, label_shapes

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

_TOP, _FOOT = 4.0, CELL - 4.0
_BELOW_COORDINATES = 16.0
_GAP = 2.0

BESIDE_COORDINATES = 3.0
"""Where the row of a cell's coordinates begins, if the level itself shows them."""

Cell = tuple[int, int]


class Rooms:
    """What is free of each cell: from so many pixels below its upper edge to so many.

    Args:
        level: the level, whose own texts have their places already.
        layout: where its cells are.
    """

    def __init__(self, level: GridWorld, layout: Layout) -> None:
        top = _BELOW_COORDINATES if level.display.coordinates else _TOP
        cells = ((x, y) for y in range(layout.rows) for x in range(layout.columns))
        self._rooms = dict.fromkeys(cells, (top, _FOOT))
        for left, upper, right, lower in _text_boxes(level, layout):
            y = int((upper - layout.margin) // CELL)
            edge = layout.corner(0, y)[1]
            first, last = (int((place - layout.margin) // CELL) for place in (left, right))
            for x in range(first, last + 1):
                top, foot = self._rooms[x, y]
                if upper - edge < CELL / 2:
                    self._rooms[x, y] = max(top, lower - edge + _GAP), foot
                else:
                    self._rooms[x, y] = top, min(foot, upper - edge - _GAP)

    def __getitem__(self, cell: Cell) -> tuple[float, float]:
        return self._rooms[cell]

    def height(self, cell: Cell) -> float:
        """Return how much of a cell is free."""
        top, foot = self._rooms[cell]
        return foot - top

    def take_top(self, cell: Cell, height: float) -> float:
        """Take so much of a cell's room; return where that begins."""
        top, foot = self._rooms[cell]
        self._rooms[cell] = top + height + _GAP, foot
        return top

    def take_foot(self, cell: Cell, height: float) -> float:
        """Take so much of a cell's room; return where that ends."""
        top, foot = self._rooms[cell]
        self._rooms[cell] = top, foot - height - _GAP
        return foot


def _text_boxes(level: GridWorld, layout: Layout) -> Iterator[tuple[float, float, float, float]]:
    for text in end_texts(level, layout):
        yield text.x, text.y - 0.75 * text.size, text.x, text.y
    for shape in label_shapes(level, layout):
        if isinstance(shape, Rect):
            yield shape.x, shape.y, shape.x + shape.width, shape.y + shape.height
