"""An overlay as shapes that keep clear of each other: visits, values, arrows, texts."""

from __future__ import annotations

import math
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

from babyrobot_levels.language.looks import Colors
from babyrobot_levels.mdp.actions import DELTAS, Action
from babyrobot_levels.render.scene.layout import CELL, Layout
from babyrobot_levels.render.scene.number_labels import HEIGHT, SMALL, action_labels, number_label
from babyrobot_levels.render.scene.overlay import Content, Overlay, Rows
from babyrobot_levels.render.scene.panels import panel_texts
from babyrobot_levels.render.scene.shapes import (
    Command,
    Path,
    Point,
    Rect,
    Shape,
    circle,
    polygon,
    polyline,
)
from babyrobot_levels.render.scene.texts import (
    coordinate_texts,
    end_texts,
    label_shapes,
    note_shapes,
)

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

_COUNT_ROOM = 30.0
"""The width of a count, beside which coordinates may be."""


class OverlayShapes(NamedTuple):
    """The shapes of an overlay by layer, from the bottom up."""

    underlay: tuple[Shape, ...]
    overlay: tuple[Shape, ...]
    text: tuple[Shape, ...]


def overlay_shapes(level: GridWorld, overlay: Overlay, layout: Layout) -> OverlayShapes:
    """Return the shapes of an overlay: heat map and arrows, numbers, and other texts.

    They keep clear of each other and of the texts that the picture already has.

    Raises:
        ValueError: the overlay has another size than the level.
    """
    colors, free = level.resolved_theme.colors, FreeSpace(level, layout)
    visits = [(cell, count) for cell, count in _cells(overlay.visits, layout) if count]
    ground: list[Shape] = [*heat_shapes(visits, free, layout, colors.arrows)]
    tops = _corners(level, overlay, visits, free, layout)
    numbers = [*_counts(visits, tops, colors, layout)]
    numbers += _values(level, overlay, free, layout)
    crowded = {
        cell: values
        for cell, values in _cells(overlay.action_values, layout)
        if any(value is not None for value in values)
    }
    numbers += _action_values(crowded, overlay, free, colors, layout)
    actions = _cells(overlay.actions, layout)
    ground += arrow_shapes(actions, free, layout, colors.arrows, crowded)
    texts: list[Shape] = []
    if overlay.coordinates and not level.display.coordinates:
        texts += coordinate_texts(level, layout, tops)
    texts += note_shapes(level, overlay.notes, layout)
    texts += panel_texts(level, overlay, layout)
    return OverlayShapes(tuple(ground), tuple(numbers), tuple(texts))


def _corners(
    level: GridWorld,
    overlay: Overlay,
    visits: list[tuple[Cell, float]],
    free: FreeSpace,
    layout: Layout,
) -> dict[Cell, float]:
    """Return the tops of coordinates and counts: they share the upper edge of their cell."""
    if level.display.coordinates:
        return dict.fromkeys(layout.cells(), BESIDE_COORDINATES)
    cells = layout.cells() if overlay.coordinates else (cell for cell, _ in visits)
    return {cell: free.take_top(cell, HEIGHT) for cell in cells}


def _counts(
    visits: list[tuple[Cell, float]], tops: dict[Cell, float], colors: Colors, layout: Layout
) -> Iterator[Shape]:
    for cell, count in visits:
        right, upper = layout.corner(cell[0] + 1, cell[1])
        bottom = upper + tops[cell] + HEIGHT
        yield from number_label(count, right - 4, bottom, _COUNT_ROOM, 0, colors, "end")


def _values(level: GridWorld, overlay: Overlay, free: FreeSpace, layout: Layout) -> Iterator[Shape]:
    """Yield values at the bottom of the cells; a value of 0 at an exit is left out."""
    colors = level.resolved_theme.colors
    for cell, value in _cells(overlay.values, layout):
        if value is not None and not (value == 0 and cell in level.exits):
            middle, upper = layout.corner(cell[0] + 0.5, cell[1])
            bottom = upper + free.take_foot(cell, HEIGHT)
            yield from number_label(value, middle, bottom, CELL - 4, overlay.precision, colors)


def _action_values(
    crowded: Mapping[Cell, Sequence[float | None]],
    overlay: Overlay,
    free: FreeSpace,
    colors: Colors,
    layout: Layout,
) -> Iterator[Shape]:
    """Yield values of actions at the sides of the cells; the middle is left to arrows."""
    gap = 2 * SHORTEST if overlay.actions is not None else 0.0
    for cell, values in crowded.items():
        height = min(SMALL, free.height(cell) / 3)
        box = free.take_top(cell, height), free.take_foot(cell, height)
        corner = layout.corner(*cell)
        yield from action_labels(values, corner, box, height, gap, overlay.precision, colors)


def _cells(rows: Rows[Content] | None, layout: Layout) -> Iterator[tuple[Cell, Content]]:
    if rows is None:
        return
    if len(rows) != layout.rows or any(len(row) != layout.columns for row in rows):
        raise ValueError(f"an overlay must have {layout.rows} rows of {layout.columns} cells")
    for y, row in enumerate(rows):
        for x, content in enumerate(row):
            yield (x, y), content


_TOP, _FOOT = 4.0, CELL - 4.0
_BELOW_COORDINATES = 16.0
_GAP = 2.0

BESIDE_COORDINATES = 3.0
"""The top of a cell's coordinates, if the level itself shows them."""

Cell = tuple[int, int]


class FreeSpace:
    """The free part of each cell, from top to bottom, in pixels below its upper edge.

    Args:
        level: the level; the places of its own texts are taken.
        layout: where its cells are.
    """

    def __init__(self, level: GridWorld, layout: Layout) -> None:
        top = _BELOW_COORDINATES if level.display.coordinates else _TOP
        cells = ((x, y) for y in range(layout.rows) for x in range(layout.columns))
        self._free = dict.fromkeys(cells, (top, _FOOT))
        for left, upper, right, lower in _text_boxes(level, layout):
            y = int((upper - layout.margin) // CELL)
            edge = layout.corner(0, y)[1]
            first, last = (int((place - layout.margin) // CELL) for place in (left, right))
            for x in range(first, last + 1):
                top, foot = self._free[x, y]
                if upper - edge < CELL / 2:
                    self._free[x, y] = max(top, lower - edge + _GAP), foot
                else:
                    self._free[x, y] = top, min(foot, upper - edge - _GAP)

    def __getitem__(self, cell: Cell) -> tuple[float, float]:
        return self._free[cell]

    def height(self, cell: Cell) -> float:
        """Return the height of the free part of a cell."""
        top, foot = self._free[cell]
        return foot - top

    def take_top(self, cell: Cell, height: float) -> float:
        """Take a strip from the top of a cell's free part; return where the strip begins."""
        top, foot = self._free[cell]
        self._free[cell] = top + height + _GAP, foot
        return top

    def take_foot(self, cell: Cell, height: float) -> float:
        """Take a strip from the bottom of a cell's free part; return where the strip ends."""
        top, foot = self._free[cell]
        self._free[cell] = top, foot - height - _GAP
        return foot


def _text_boxes(level: GridWorld, layout: Layout) -> Iterator[tuple[float, float, float, float]]:
    for text in end_texts(level, layout):
        yield text.x, text.y - 0.75 * text.size, text.x, text.y
    for shape in label_shapes(level, layout):
        if isinstance(shape, Rect):
            yield shape.x, shape.y, shape.x + shape.width, shape.y + shape.height


_INSET = 4.0
_FAINTEST, _STRONGEST = 0.1, 0.6


def heat_shapes(
    visits: Sequence[tuple[Cell, float]], free: FreeSpace, layout: Layout, color: str
) -> Iterator[Rect]:
    """Yield a heat map: a square for each cell, more opaque for more visits.

    Opacity grows with the logarithm of the count, so that the most visited cell does not make all
    others pale.
    """
    most = max((math.log1p(count) for _, count in visits), default=0.0)
    for cell, count in visits:
        share = math.log1p(count) / most
        opacity = round(_FAINTEST + (_STRONGEST - _FAINTEST) * share, 2)
        left, upper = layout.corner(*cell)
        top, foot = free[cell]
        yield Rect(left + _INSET, upper + top, CELL - 2 * _INSET, foot - top, color, 7.0, opacity)


SHORTEST = 8.0
"""The length of the shortest arrow, from its middle to its tip; between numbers all have it."""

_LONGEST = 18.0

_WIDTH = 3.2
_RING = 0.25
"""The radius of the ring that means `stay`, as a share of the arrows' length."""
_RIM = "#ffffff"
_SHADE = "#000000"


def arrow_shapes(
    cells: Iterable[tuple[Cell, Sequence[int]]],
    free: FreeSpace,
    layout: Layout,
    color: str,
    crowded: Container[Cell],
) -> Iterator[Shape]:
    """Yield the arrows of a policy, with a rim that makes them visible on every background.

    Args:
        cells: the actions of each cell.
        free: the free part of each cell.
        layout: where the cells are.
        color: the colour of the arrows.
        crowded: the cells with numbers at their sides.
    """
    shafts: list[Command] = []
    heads: list[Command] = []
    for (x, y), actions in cells:
        top, foot = free[x, y]
        left, upper = layout.corner(x, y)
        longest = SHORTEST if (x, y) in crowded else _LONGEST
        reach = min(max((foot - top) / 2, SHORTEST), longest)
        # An arrow that is too long for the free part reaches over its top.
        middle = left + CELL / 2, upper + min((top + foot) / 2, foot - reach)
        start = 0.0
        if Action.STAY in actions:
            start = _RING * reach
            shafts += circle(*middle, start)
        for action in actions:
            if action != Action.STAY:
                shaft, head = _arrow(middle, DELTAS[Action(action)], start, reach)
                shafts += shaft
                heads += head
    lines, tips = tuple(shafts), tuple(heads)
    for ink, rim, opacity in ((_SHADE, 3.2, 0.3), (_RIM, 2.0, 1.0)):
        if lines:
            yield Path(lines, stroke=ink, width=_WIDTH + 2 * rim, cap="round", opacity=opacity)
        if tips:
            yield Path(tips, stroke=ink, width=2 * rim, opacity=opacity)
    if lines:
        yield Path(lines, stroke=color, width=_WIDTH, cap="round")
    if tips:
        yield Path(tips, fill=color)


def _arrow(
    start: Point, towards: tuple[int, int], gap: float, reach: float
) -> tuple[tuple[Command, ...], tuple[Command, ...]]:
    """Return shaft and head of an arrow that begins and ends `gap` and `reach` from `start`."""
    length = 0.5 * reach

    def at(along: float, across: float) -> Point:
        return (
            start[0] + along * towards[0] - across * towards[1],
            start[1] + along * towards[1] + across * towards[0],
        )

    neck = reach - length
    half = 0.6 * length
    shaft = polyline([at(min(gap, neck), 0), at(neck, 0)])
    return shaft, polygon([at(reach, 0), at(neck, half), at(neck, -half)])
