"""Bars: numbers side by side, between two marked lines that they are compared with."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from babyrobot_levels.render.scene.shapes import Path, Rect, Scene, Shape, Text, polyline

_ROW, _BAR = 22.0, 13.0
"""The heights of a row and of its bar, in pixels."""

_LEFT, _RIGHT, _TOP, _BOTTOM = 150.0, 60.0, 46.0, 14.0
"""The margins around the bars."""

_WIDTH = 360.0
"""The width of the bars' ground."""

_LETTERS = 21
"""The most characters of a name."""

_INK, _GROUND = "#333333", "#ffffff"
"""The colours of texts and of the ground, which is light in dark notebooks, too."""

_GOAL = "#b34700"
"""The colour of the line to reach: 5:1 on the ground, and told by its dashes as well."""

_FORWARD, _BACKWARD = "#0b4f8a", "#8f2f2f"
"""The colours of bars from 0 to the right, and to the left."""


@dataclass(frozen=True, slots=True)
class Bar:
    """A bar.

    Attributes:
        name: what it is of.
        value: its length; nan for none.
        low: the lower end of an interval around it; equal to `value` for none.
        high: the upper end.
    """

    name: str
    value: float
    low: float
    high: float


def bars_scene(bars: Sequence[Bar], *, title: str, zero: str, one: str) -> Scene:
    """Return bars as a picture; what is below -1 or above 1.2 is cut off.

    Args:
        bars: the bars, from top to bottom.
        title: what they tell.
        zero: the name of the line at 0.
        one: the name of the line at 1.
    """
    shown = [value for bar in bars for value in (bar.value, bar.low, bar.high)]
    least = max(-1.0, min([0.0, *filter(math.isfinite, shown)]))
    most = min(1.2, max([1.0, *filter(math.isfinite, shown)]))
    unit = _WIDTH / (most - least)

    def at(value: float) -> float:
        return _LEFT + (min(max(value, least), most) - least) * unit

    height = _TOP + _ROW * len(bars) + _BOTTOM
    width = _LEFT + _WIDTH + _RIGHT
    bottom = height - _BOTTOM + 4
    shapes: list[Shape] = [Rect(0, 0, width, height, _GROUND, radius=6)]
    for value, name, color, dash in ((0.0, zero, _INK, None), (1.0, one, _GOAL, (7.0, 4.0))):
        x = at(value)
        line = polyline([(x, _TOP - 6), (x, bottom)])
        shapes += [
            Text(x, _TOP - 12, f"{name} {value:g}", 12, color),
            Path(line, stroke=color, width=1.5, dash=dash),
        ]
    shapes.append(Text(_LEFT, 16, title, 13, _INK, "start", bold=True))
    for number, bar in enumerate(bars):
        shapes += _row(bar, _TOP + _ROW * number, at)
    described = "; ".join(f"{bar.name}: {_told(bar.value)}" for bar in bars[:40])
    return Scene(width, height, tuple(shapes), title, described)


def _row(bar: Bar, top: float, at: Callable[[float], float]) -> Iterator[Shape]:
    middle = top + _ROW / 2
    name = bar.name if len(bar.name) <= _LETTERS else f"{bar.name[: _LETTERS - 1]}…"
    yield Text(_LEFT - 10, middle + 4, name, 12, _INK, "end")
    if not math.isnan(bar.value):
        begin, end = sorted((at(0.0), at(bar.value)))
        color = _FORWARD if bar.value >= 0 else _BACKWARD
        yield Rect(begin, middle - _BAR / 2, end - begin, _BAR, color)
        if bar.low < bar.high:
            low, high = at(bar.low), at(bar.high)
            yield Path(polyline([(low, middle), (high, middle)]), stroke=_INK, width=2)
            for x in (low, high):
                yield Path(polyline([(x, middle - 4), (x, middle + 4)]), stroke=_INK, width=2)
    yield Text(_LEFT + _WIDTH + _RIGHT - 12, middle + 4, _told(bar.value), 12, _INK, "end")


def _told(value: float) -> str:
    # Without the sign of a zero.
    return "-" if math.isnan(value) else f"{round(value, 2) + 0.0:.2f}"
