"""Answers on the picture: what each cell is worth, and where the best actions lead from it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from babyrobot_levels.actions import Action
from babyrobot_levels.scene.layout import CELL, Layout
from babyrobot_levels.scene.paths import polygon, polyline
from babyrobot_levels.scene.shapes import Command, Path, Rect, Shape, Text
from babyrobot_levels.scene.texts import CHARACTER_WIDTH, end_texts, label_shapes
from babyrobot_levels.spec.looks import Colors

if TYPE_CHECKING:
    from babyrobot_levels.level import Level

_SIZE = 10.5
_PILL = 13.0
_GAP = 2.0
_TOP, _FOOT = 4.0, CELL - 4.0
_BELOW_COORDINATES = 16.0

_REACHES = 8.0, 18.0
"""The shortest and the longest arrow, from the middle to its tip."""
_WIDTH = 3.2
_RING = 0.25
"""The radius of the ring that means stay, as a share of how far arrows reach."""
_RIM = "#ffffff"
_SHADE = "#000000"

_TOWARDS = {
    Action.NORTH: (0, -1),
    Action.EAST: (1, 0),
    Action.SOUTH: (0, 1),
    Action.WEST: (-1, 0),
}

Content = TypeVar("Content")
Cell = tuple[int, int]
Room = tuple[float, float]
"""What is free of a cell's middle: from so many pixels below its upper edge to so many."""


@dataclass(frozen=True, slots=True)
class Overlay:
    """What is written over the cells of a level, as plain data.

    Attributes:
        values: what each cell is worth, `[height][width]`; it may be infinite. None for a cell
            on which nothing is written.
        actions: the actions that are best in each cell, `[height][width]`, as `Action`s; none
            where there is nothing to do.
    """

    values: Sequence[Sequence[float | None]] | None = None
    actions: Sequence[Sequence[Sequence[int]]] | None = None


def overlay_shapes(level: Level, overlay: Overlay, layout: Layout) -> tuple[Shape, ...]:
    """Return the values, at the feet of the cells, and the arrows above them.

    Both keep clear of the texts that the picture has already.

    Raises:
        ValueError: the overlay is not as large as the level.
    """
    rooms = _rooms(level, layout)
    shapes: list[Shape] = []
    if overlay.values is not None:
        colors = level.colors_and_widths.colors
        for (x, y), value in _cells(overlay.values, layout):
            if value is not None:
                top, foot = rooms[x, y]
                middle, upper = layout.corner(x + 0.5, y)
                shapes += _pill(value, middle, upper + foot, colors)
                rooms[x, y] = top, foot - _PILL - _GAP
    if overlay.actions is not None:
        color = level.colors_and_widths.colors.arrows
        shapes += _arrows(_cells(overlay.actions, layout), rooms, layout, color)
    return tuple(shapes)


def short(value: float) -> str:
    """Return a finite number in few characters: two decimals at most, none for large ones."""
    if abs(value) >= 99_999.5:
        digits, _, exponent = f"{value:.1e}".partition("e")
        return f"{digits}e{int(exponent)}"
    if abs(value) >= 999.995:
        return f"{value:.0f}"
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def _pill(value: float, middle: float, under: float, colors: Colors) -> Iterator[Shape]:
    """Yield a value on a ground that keeps it readable, the lower edge at `under`."""
    text = "" if math.isinf(value) else short(value)
    width = max(len(text), 3) * _SIZE * CHARACTER_WIDTH + 0.8 * _SIZE
    yield Rect(middle - width / 2, under - _PILL, width, _PILL, colors.text_bg, radius=_PILL / 2)
    if text:
        yield Text(middle, under - 2.9, text, _SIZE, colors.text_fg, bold=True)
        return
    # Not every font has this sign, so it is drawn.
    x, y = middle + (0 if value > 0 else 3.5), under - _PILL / 2
    yield Path(_infinity(x, y), stroke=colors.text_fg, width=1.3)
    if value < 0:
        yield Path(polyline([(x - 11, y), (x - 8, y)]), stroke=colors.text_fg, width=1.3)


def _infinity(x: float, y: float) -> tuple[Command, ...]:
    return (
        ("M", (x, y)),
        ("C", (x + 2.5, y - 4, x + 6, y - 3.5, x + 6, y)),
        ("C", (x + 6, y + 3.5, x + 2.5, y + 4, x, y)),
        ("C", (x - 2.5, y - 4, x - 6, y - 3.5, x - 6, y)),
        ("C", (x - 6, y + 3.5, x - 2.5, y + 4, x, y)),
        ("Z", ()),
    )


def _cells(rows: Sequence[Sequence[Content]], layout: Layout) -> Iterator[tuple[Cell, Content]]:
    if len(rows) != layout.rows or any(len(row) != layout.columns for row in rows):
        raise ValueError(f"an overlay must have {layout.rows} rows of {layout.columns} cells")
    for y, row in enumerate(rows):
        for x, content in enumerate(row):
            yield (x, y), content


def _rooms(level: Level, layout: Layout) -> dict[Cell, Room]:
    """Return the room that the picture's texts leave in each cell."""
    top = _BELOW_COORDINATES if level.display.coordinates else _TOP
    rooms = {(x, y): (top, _FOOT) for y in range(layout.rows) for x in range(layout.columns)}
    for left, upper, right, lower in _text_boxes(level, layout):
        y = int((upper - layout.margin) // CELL)
        edge = layout.corner(0, y)[1]
        first, last = (int((place - layout.margin) // CELL) for place in (left, right))
        for x in range(first, last + 1):
            top, foot = rooms[x, y]
            if upper - edge < CELL / 2:
                rooms[x, y] = max(top, lower - edge + _GAP), foot
            else:
                rooms[x, y] = top, min(foot, upper - edge - _GAP)
    return rooms


def _text_boxes(level: Level, layout: Layout) -> Iterator[tuple[float, float, float, float]]:
    for text in end_texts(level, layout):
        yield text.x, text.y - 0.75 * text.size, text.x, text.y
    for shape in label_shapes(level, layout):
        if isinstance(shape, Rect):
            yield shape.x, shape.y, shape.x + shape.width, shape.y + shape.height


def _arrows(
    cells: Iterable[tuple[Cell, Sequence[int]]],
    rooms: dict[Cell, Room],
    layout: Layout,
    color: str,
) -> Iterator[Shape]:
    """Yield all arrows at once, rimmed like stickers: they can be seen on every ground."""
    shafts: list[Command] = []
    heads: list[Command] = []
    for (x, y), actions in cells:
        top, foot = rooms[x, y]
        left, upper = layout.corner(x, y)
        reach = min(max((foot - top) / 2, _REACHES[0]), _REACHES[1])
        # Where the room is too small for any arrow, it gives way at the top.
        middle = left + CELL / 2, upper + min((top + foot) / 2, foot - reach)
        start = 0.0
        if Action.STAY in actions:
            start = _RING * reach
            shafts += _circle(*middle, start)
        for action in actions:
            if action != Action.STAY:
                shaft, head = _arrow(middle, _TOWARDS[Action(action)], start, reach)
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
    start: tuple[float, float], towards: tuple[int, int], gap: float, reach: float
) -> tuple[tuple[Command, ...], tuple[Command, ...]]:
    """Return shaft and head of an arrow that begins and ends so far from `start`."""
    length = 0.5 * reach

    def at(along: float, across: float) -> tuple[float, float]:
        return (
            start[0] + along * towards[0] - across * towards[1],
            start[1] + along * towards[1] + across * towards[0],
        )

    neck = reach - length
    half = 0.6 * length
    shaft = polyline([at(min(gap, neck), 0), at(neck, 0)])
    return shaft, polygon([at(reach, 0), at(neck, half), at(neck, -half)])


def _circle(x: float, y: float, r: float) -> tuple[Command, ...]:
    # A quarter of a circle is this cubic curve, to a thousandth of its radius.
    k = 0.5523 * r
    return (
        ("M", (x + r, y)),
        ("C", (x + r, y + k, x + k, y + r, x, y + r)),
        ("C", (x - k, y + r, x - r, y + k, x - r, y)),
        ("C", (x - r, y - k, x - k, y - r, x, y - r)),
        ("C", (x + k, y - r, x + r, y - k, x + r, y)),
        ("Z", ()),
    )
