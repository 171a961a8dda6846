"""Numbers in the cells, on backgrounds that keep them readable."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Literal

from babyrobot_levels.language.looks import Colors
from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.render.scene.layout import CELL, CHARACTER_WIDTH
from babyrobot_levels.render.scene.shapes import Command, Path, Point, Rect, Shape, Text, polyline

Anchor = Literal["start", "middle", "end"]

HEIGHT = 13.0
"""The height of a number's background."""

_SMALLEST = 7.5
"""The font size below which decimals are dropped instead."""

SMALL = 10.5
"""The largest height where a cell shows the values of its actions."""


def short(value: float, precision: int = 2) -> str:
    """Return a finite number in few characters.

    Args:
        value: the number.
        precision: the largest number of decimals; large numbers have none.
    """
    if abs(value) >= 99_999.5:
        digits, _, exponent = f"{value:.1e}".partition("e")
        return f"{digits}e{int(exponent)}"
    if abs(value) >= 999.995:
        precision = 0
    text = f"{value:.{precision}f}"
    if precision:
        text = text.rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def number_label(
    value: float,
    x: float,
    bottom: float,
    room: float,
    precision: int,
    colors: Colors,
    anchor: Anchor = "middle",
    height: float = HEIGHT,
    strong: bool = True,
) -> Iterator[Shape]:
    """Yield a value on its background.

    Args:
        value: the value; it may be infinite.
        x: the left edge, middle or right edge of the background, depending on `anchor`.
        bottom: its lower edge.
        room: its largest width.
        precision: the largest number of decimals.
        colors: the theme's colours.
        anchor: which point `x` is.
        height: the height of the background.
        strong: whether the value is in bold.
    """
    padding = (0.64 if height == HEIGHT else 0.4) * height
    columns = int((room - padding) / (_SMALLEST * CHARACTER_WIDTH))
    text = "" if math.isinf(value) else short(value, precision)
    while precision > 0 and len(text) > columns:
        # Fewer decimals are readable, smaller ones are not.
        precision -= 1
        text = short(value, precision)
    count = max(len(text), 3)
    size = min(0.8 * height, (room - padding) / (count * CHARACTER_WIDTH))
    width = count * size * CHARACTER_WIDTH + padding
    left = x - {"start": 0.0, "middle": width / 2, "end": width}[anchor]
    middle, centre = left + width / 2, bottom - height / 2
    yield Rect(left, bottom - height, width, height, colors.text_bg, radius=height / 2)
    if text:
        yield Text(middle, centre + 0.342 * size, text, size, colors.text_fg, bold=strong)
        return
    # Not every font has this character.
    x = middle + (0 if value > 0 else 3.5)
    yield Path(_infinity(x, centre), stroke=colors.text_fg, width=1.3)
    if value < 0:
        minus = polyline([(x - 11, centre), (x - 8, centre)])
        yield Path(minus, stroke=colors.text_fg, width=1.3)


def action_labels(
    values: Sequence[float | None],
    corner: Point,
    room: tuple[float, float],
    height: float,
    gap: float,
    precision: int,
    colors: Colors,
) -> Iterator[Shape]:
    """Yield the values of the moves, each at its side of the cell; the largest are in bold.

    Args:
        values: in the order of `Action`, None for nothing. That of `stay` is not shown.
        corner: the upper left corner of the cell.
        room: top and bottom of the free part of the cell, in pixels below its upper edge.
        height: the height of each of them.
        gap: the width of the middle that is kept free.
        precision: the largest number of decimals.
        colors: the theme's colours.
    """
    best = max((value for value in values if value is not None), default=None)
    left, right, middle = corner[0] + 2, corner[0] + CELL - 2, corner[0] + CELL / 2
    top, foot = corner[1] + room[0], corner[1] + room[1]
    half, centre = CELL / 2 - 2.5 - gap / 2, (top + foot + height) / 2
    places: dict[Action, tuple[float, float, float, Anchor]] = {
        Action.NORTH: (middle, top + height, CELL - 4, "middle"),
        Action.EAST: (right, centre, half, "end"),
        Action.SOUTH: (middle, foot, CELL - 4, "middle"),
        Action.WEST: (left, centre, half, "start"),
    }
    for action, (x, bottom, width, anchor) in places.items():
        value = values[action]
        if value is not None:
            strong = value == best
            yield from number_label(
                value, x, bottom, width, precision, colors, anchor, height, strong
            )


def _infinity(x: float, y: float) -> tuple[Command, ...]:
    return (
        ("M", (x, y)),
        ("C", (x + 2.5, y - 4, x + 6, y - 3.5, x + 6, y)),
        ("C", (x + 6, y + 3.5, x + 2.5, y + 4, x, y)),
        ("C", (x - 2.5, y - 4, x - 6, y - 3.5, x - 6, y)),
        ("C", (x - 6, y + 3.5, x - 2.5, y + 4, x, y)),
        ("Z", ()),
    )
