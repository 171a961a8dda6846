"""Charts: curves that develop, and bars side by side, with the lines that they should reach."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from babyrobot_levels.render.scene.shapes import Path, Rect, Scene, Shape, Text, polyline
from babyrobot_levels.render.svg import FONT, escaped, number

WIDTH, HEIGHT = 460, 260
"""The size of the picture, in pixels."""

MAX_POINTS = 400
"""The most points of a curve; longer ones are thinned out."""

_LEFT, _RIGHT, _TOP, _BOTTOM = 62, 16, 34, 44
"""The margins around the curves."""

_TICKS = 5
"""About how many ticks an axis has."""

_INK, _GRID, _GROUND = "#333333", "#dddddd", "#ffffff"
"""The colours of texts, of the grid and of the ground, which is light in dark notebooks, too."""

_GOAL = "#b34700"
"""The colour of the line to reach: 5:1 on the ground, and told by its dashes as well."""

STRONG, FAINT = "#0b4f8a", "#4d90cd"
"""The colours of a curve, and of a curve that only accompanies it."""


@dataclass(frozen=True, slots=True)
class Curve:
    """A curve.

    Attributes:
        name: its name in the legend.
        points: its points `(x, y)`, x ascending. Those that are infinite or nan are left out.
        color: its colour.
        width: the width of its line, in pixels.
    """

    name: str
    points: Sequence[tuple[float, float]]
    color: str = STRONG
    width: float = 2.0


@dataclass(frozen=True, slots=True)
class _Axis:
    """The range of an axis, and where it lies in the picture."""

    low: float
    high: float
    begin: float
    end: float

    def at(self, value: float) -> float:
        share = (value - self.low) / (self.high - self.low)
        return self.begin + share * (self.end - self.begin)

    def ticks(self) -> list[float]:
        """Return round numbers in the range: steps of 1, 2 or 5 times a power of ten."""
        rough = (self.high - self.low) / _TICKS
        power = 10.0 ** math.floor(math.log10(rough))
        step = next(power * times for times in (1, 2, 5, 10) if power * times >= rough)
        first, last = math.ceil(self.low / step), math.floor(self.high / step)
        return [step * index for index in range(first, last + 1)]


def curves_svg(
    curves: Sequence[Curve], *, goal: tuple[str, float] | None, x_title: str, y_title: str
) -> str:
    """Return curves as an SVG document with axes and a legend, or "" if there is no point.

    The range of y is that of the last curve and of the goal; what is outside of it is cut off.

    Args:
        curves: the curves, in painting order.
        goal: the name and the y of a dashed horizontal line; None for no such line.
        x_title: what x is.
        y_title: what y is.
    """
    shown = [replace(each, points=_thinned(each.points)) for each in curves]
    if not shown or not shown[-1].points:
        return ""
    if goal is not None and not math.isfinite(goal[1]):
        goal = None
    xs = [x for each in shown for x, _ in each.points]
    ys = [y for _, y in shown[-1].points] + ([] if goal is None else [goal[1]])
    x_axis = _Axis(*_range(xs, 0.0), _LEFT, WIDTH - _RIGHT)
    y_axis = _Axis(*_range(ys, 0.06), HEIGHT - _BOTTOM, _TOP)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" '
        f'viewBox="0 0 {WIDTH} {HEIGHT}" role="img" font-family="{FONT}" font-size="12">',
        f"<title>{escaped(f'{y_title} by {x_title}')}</title>",
        f'<rect width="{WIDTH}" height="{HEIGHT}" rx="6" fill="{_GROUND}"/>',
        f'<clipPath id="inside"><rect x="{_LEFT}" y="{_TOP}" width="{WIDTH - _LEFT - _RIGHT}" '
        f'height="{HEIGHT - _TOP - _BOTTOM}"/></clipPath>',
        *_scales(x_axis, y_axis, x_title, y_title),
        '<g clip-path="url(#inside)">',
        *(_line(each, x_axis, y_axis) for each in shown),
        "</g>",
    ]
    names = [(each.name, each.color, "") for each in shown]
    if goal is not None:
        y = number(y_axis.at(goal[1]))
        dashes = ' stroke-dasharray="7 4"'
        parts.append(
            f'<path d="M{_LEFT} {y}H{WIDTH - _RIGHT}" stroke="{_GOAL}" stroke-width="2"{dashes}/>'
        )
        names.append((goal[0], _GOAL, dashes))
    return "\n".join([*parts, *_legend(names), "</svg>"]) + "\n"


def _thinned(points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    finite = [(x, y) for x, y in points if math.isfinite(y)]
    step = max(1, math.ceil(len(finite) / MAX_POINTS))
    return finite if step == 1 else [*finite[::step], finite[-1]]


def _range(values: Sequence[float], margin: float) -> tuple[float, float]:
    low, high = min(values), max(values)
    if low == high:
        low, high = low - 1, high + 1
    return low - margin * (high - low), high + margin * (high - low)


def _line(curve: Curve, x_axis: _Axis, y_axis: _Axis) -> str:
    if len(curve.points) == 1:
        ((x, y),) = curve.points
        x, y = x_axis.at(x), y_axis.at(y)
        return f'<circle cx="{number(x)}" cy="{number(y)}" r="4" fill="{curve.color}"/>'
    points = " ".join(f"{number(x_axis.at(x))},{number(y_axis.at(y))}" for x, y in curve.points)
    return (
        f'<polyline points="{points}" fill="none" stroke="{curve.color}" '
        f'stroke-width="{number(curve.width)}"/>'
    )


def _scales(x_axis: _Axis, y_axis: _Axis, x_title: str, y_title: str) -> Iterator[str]:
    bottom, right = HEIGHT - _BOTTOM, WIDTH - _RIGHT
    for tick in y_axis.ticks():
        y = y_axis.at(tick)
        yield f'<path d="M{_LEFT} {number(y)}H{right}" stroke="{_GRID}"/>'
        yield _text(_LEFT - 8, y + 4, f"{tick:g}", "end")
    for tick in x_axis.ticks():
        x = x_axis.at(tick)
        yield f'<path d="M{number(x)} {bottom}v5" stroke="{_INK}"/>'
        yield _text(x, bottom + 18, f"{tick:,g}", "middle")
    yield f'<path d="M{_LEFT} {_TOP}V{bottom}H{right}" fill="none" stroke="{_INK}"/>'
    yield _text((_LEFT + right) / 2, HEIGHT - 8, x_title, "middle")
    middle = number((_TOP + bottom) / 2)
    yield (
        f'<text transform="translate(14 {middle}) rotate(-90)" text-anchor="middle" '
        f'fill="{_INK}">{escaped(y_title)}</text>'
    )


def _legend(names: Sequence[tuple[str, str, str]]) -> Iterator[str]:
    x = float(_LEFT)
    for name, color, dashes in names:
        yield f'<path d="M{number(x)} 18h22" stroke="{color}" stroke-width="2"{dashes}/>'
        yield _text(x + 28, 22, name, "start")
        x += 28 + 7 * len(name) + 16


def _text(x: float, y: float, text: str, anchor: str) -> str:
    return (
        f'<text x="{number(x)}" y="{number(y)}" text-anchor="{anchor}" fill="{_INK}">'
        f"{escaped(text)}</text>"
    )


# -- bars ------------------------------------------------------------------------------------------

_ROW, _BAR = 22.0, 13.0
"""The heights of a row and of its bar, in pixels."""

_BARS_LEFT, _BARS_RIGHT, _BARS_TOP, _BARS_BOTTOM = 150.0, 60.0, 46.0, 14.0
"""The margins around the bars."""

_BARS_WIDTH = 360.0
"""The width of the bars' ground."""

_LETTERS = 21
"""The most characters of a name."""

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
    unit = _BARS_WIDTH / (most - least)

    def at(value: float) -> float:
        return _BARS_LEFT + (min(max(value, least), most) - least) * unit

    height = _BARS_TOP + _ROW * len(bars) + _BARS_BOTTOM
    width = _BARS_LEFT + _BARS_WIDTH + _BARS_RIGHT
    bottom = height - _BARS_BOTTOM + 4
    shapes: list[Shape] = [Rect(0, 0, width, height, _GROUND, radius=6)]
    for value, name, color, dash in ((0.0, zero, _INK, None), (1.0, one, _GOAL, (7.0, 4.0))):
        x = at(value)
        shapes += [
            Text(x, _BARS_TOP - 12, f"{name} {value:g}", 12, color),
            Path(polyline([(x, _BARS_TOP - 6), (x, bottom)]), stroke=color, width=1.5, dash=dash),
        ]
    shapes.append(Text(_BARS_LEFT, 16, title, 13, _INK, "start", bold=True))
    for row, bar in enumerate(bars):
        shapes += _row(bar, _BARS_TOP + _ROW * row, at)
    described = "; ".join(f"{bar.name}: {_told(bar.value)}" for bar in bars[:40])
    return Scene(width, height, tuple(shapes), title, described)


def _row(bar: Bar, top: float, at: Callable[[float], float]) -> Iterator[Shape]:
    middle = top + _ROW / 2
    name = bar.name if len(bar.name) <= _LETTERS else f"{bar.name[: _LETTERS - 1]}…"
    yield Text(_BARS_LEFT - 10, middle + 4, name, 12, _INK, "end")
    if not math.isnan(bar.value):
        begin, end = sorted((at(0.0), at(bar.value)))
        # What is 0 is there, too.
        begin, end = min(begin, (begin + end) / 2 - 2), max(end, (begin + end) / 2 + 2)
        color = _FORWARD if bar.value >= 0 else _BACKWARD
        yield Rect(begin, middle - _BAR / 2, end - begin, _BAR, color)
        if bar.low < bar.high:
            low, high = at(bar.low), at(bar.high)
            yield Path(polyline([(low, middle), (high, middle)]), stroke=_INK, width=2)
            for x in (low, high):
                yield Path(polyline([(x, middle - 4), (x, middle + 4)]), stroke=_INK, width=2)
    yield Text(
        _BARS_LEFT + _BARS_WIDTH + _BARS_RIGHT - 12, middle + 4, _told(bar.value), 12, _INK, "end"
    )


def _told(value: float) -> str:
    # Without the sign of a zero.
    return "-" if math.isnan(value) else f"{round(value, 2) + 0.0:.2f}"
