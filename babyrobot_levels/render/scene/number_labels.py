"""Numbers in the cells: one form for all numbers of a picture."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

from babyrobot_levels.render.scene.layout import CHARACTER_WIDTH, Layout
from babyrobot_levels.render.scene.shapes import (
    MAX_SIDE,
    Command,
    Path,
    Rect,
    Shape,
    Text,
    polyline,
)
from babyrobot_levels.render.scene.slots import Box

Anchor = Literal["start", "middle", "end"]

_SIZE = 10.5
"""The largest font size."""

_SMALLEST = 7.5
"""The font size below which decimals are dropped instead."""

_READABLE = 7.0
"""The font size on a screen below which numbers are left out."""

_UNITS = (("T", 1e12), ("G", 1e9), ("M", 1e6), ("k", 1e3))
_LARGE = 99_999.5
"""The number from which on thousands, millions and so on are counted."""


@dataclass(frozen=True, slots=True)
class Form:
    """The form of the numbers of a picture.

    Attributes:
        decimals: how many decimals each of them has.
        size: the font size.
    """

    decimals: int
    size: float = _SIZE

    def text(self, value: float) -> str:
        """Return a finite number as it is written: 923k from a hundred thousand on."""
        if abs(value) >= _LARGE:
            for unit, worth in _UNITS:
                # What is rounded to a thousand of a unit is one of the next.
                if 0.9995 * worth <= abs(value) < 999.5e12:
                    return f"{value / worth:.3g}{unit}"
            return f"{value:.0e}".replace("e+", "e")
        text = f"{value:.{self.decimals}f}"
        return text.removeprefix("-") if float(text) == 0 else text

    def is_readable(self, layout: Layout) -> bool:
        """Whether numbers can be read on a screen."""
        return self.size * min(1.0, MAX_SIDE / max(layout.width, layout.height)) >= _READABLE


def form_of(values: Iterable[float | None], precision: int, room: float = math.inf) -> Form:
    """Return the form of numbers: as many decimals as any of them needs, fewer where room is short.

    Args:
        values: the numbers; None and infinite ones have no part in it.
        precision: the largest number of decimals.
        room: the largest width of a number in pixels.
    """
    finite = [value for value in values if value is not None and math.isfinite(value)]
    needed = (len(f"{value:.{precision}f}".rstrip("0").partition(".")[2]) for value in finite)
    decimals = max(needed, default=0) if precision else 0

    def width(form: Form) -> float:
        longest = max((len(form.text(value)) for value in finite), default=1)
        return max(longest, 3) * CHARACTER_WIDTH

    while decimals > 0 and width(Form(decimals)) * _SMALLEST > room:
        # Fewer decimals are readable, smaller ones are not.
        decimals -= 1
    return Form(decimals, min(_SIZE, room / width(Form(decimals))))


def short(value: float, precision: int = 2) -> str:
    """Return a finite number in few characters, with no more decimals than it needs.

    Args:
        value: the number.
        precision: the largest number of decimals.
    """
    return form_of([value], precision).text(value)


def number_shapes(
    value: float,
    form: Form,
    box: Box,
    ink: str,
    ground: str | None = None,
    *,
    anchor: Anchor = "middle",
    bold: bool = True,
) -> Iterator[Shape]:
    """Yield a number in a box.

    Args:
        value: the number; it may be infinite.
        form: how it is written.
        box: where, in pixels of the picture.
        ink: its colour.
        ground: the colour of a ground that hides what lies below; None for no ground.
        anchor: at which edge of the box it is.
        bold: whether it is in bold.
    """
    text = "" if math.isinf(value) else form.text(value)
    width = max(len(text), 3) * form.size * CHARACTER_WIDTH
    across = {"start": box.left, "middle": box.centre[0], "end": box.right}[anchor]
    left = across - {"start": 0.0, "middle": width / 2, "end": width}[anchor]
    y = box.centre[1]
    if ground is not None:
        height = form.size
        yield Rect(left - 2, y - height / 2, width + 4, height, ground, radius=height / 2)
    if text:
        yield Text(across, y + 0.342 * form.size, text, form.size, ink, anchor, bold=bold)
        return
    # Not every font has this character.
    x = left + width / 2 + (0 if value > 0 else 3.5)
    yield Path(_infinity(x, y), stroke=ink, width=1.3)
    if value < 0:
        yield Path(polyline([(x - 11, y), (x - 8, y)]), stroke=ink, width=1.3)


def _infinity(x: float, y: float) -> tuple[Command, ...]:
    return (
        ("M", (x, y)),
        ("C", (x + 2.5, y - 4, x + 6, y - 3.5, x + 6, y)),
        ("C", (x + 6, y + 3.5, x + 2.5, y + 4, x, y)),
        ("C", (x - 2.5, y - 4, x - 6, y - 3.5, x - 6, y)),
        ("C", (x - 6, y + 3.5, x - 2.5, y + 4, x, y)),
        ("Z", ()),
    )
