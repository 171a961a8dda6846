"""The shapes of scenes, paths built from points, and shapes moved, scaled and in greys.

A painter that supports these four shapes can paint every scene. Lengths are pixels, x grows to the
right, y downwards. Colours are CSS strings, as levels write them; `opacity` comes on top of a
colour's own alpha.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import wraps
from typing import Literal, ParamSpec

from babyrobot_levels.language.looks import Colors
from babyrobot_levels.render.colors import gray, is_gray
from babyrobot_levels.text import budget

Command = tuple[str, tuple[float, ...]]
"""A step of a path, in SVG's letters: `M` x y, `L` x y, `C` x1 y1 x2 y2 x y, or `Z`."""

Commands = tuple[Command, ...]
"""A path."""

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Rect:
    """A filled rectangle; `x`, `y` is its top-left corner, `radius` rounds its corners."""

    x: float
    y: float
    width: float
    height: float
    fill: str
    radius: float = 0.0
    opacity: float = 1.0


@dataclass(frozen=True, slots=True)
class Ellipse:
    """A filled ellipse; `x`, `y` is its centre."""

    x: float
    y: float
    rx: float
    ry: float
    fill: str
    opacity: float = 1.0


@dataclass(frozen=True, slots=True)
class Path:
    """Lines and curves, filled, stroked, or both; each `M` begins a new piece.

    Strokes have round joins. `dash` gives the lengths of a dash and of the gap after it; each
    piece begins with a dash.
    """

    commands: Commands
    fill: str | None = None
    stroke: str | None = None
    width: float = 1.0
    dash: tuple[float, float] | None = None
    cap: Literal["butt", "round"] = "butt"
    opacity: float = 1.0


@dataclass(frozen=True, slots=True)
class Text:
    """A line of text; `y` is its baseline, `x` its start, middle or end as `anchor` says."""

    x: float
    y: float
    text: str
    size: float
    fill: str
    anchor: Literal["start", "middle", "end"] = "middle"
    bold: bool = False
    opacity: float = 1.0


Shape = Rect | Ellipse | Path | Text


@dataclass(frozen=True, slots=True)
class Scene:
    """A picture: shapes in painting order, without a background; `width`, `height` in pixels.

    `title` and `description` are its texts for people who do not see it; they may be empty.
    """

    width: float
    height: float
    shapes: tuple[Shape, ...]
    title: str = ""
    description: str = ""


_SHAPE, _STEP, _NUMBER = 700, 250, 80
"""The work that a shape counts as, a step of a path, and each of its numbers, for the memory that
they take until the picture is written."""

_TEXT = 2_000
"""The work that a text counts as beside this: it is placed, coloured, encoded and written."""

P = ParamSpec("P")


def _counted(made: Callable[P, Commands]) -> Callable[P, Commands]:
    """Return the same function of paths; what it returns counts as work."""

    @wraps(made)
    def make(*given: P.args, **options: P.kwargs) -> Commands:
        commands = made(*given, **options)
        numbers = sum([len(numbers) for _, numbers in commands])
        budget.spend(_STEP * len(commands) + _NUMBER * numbers)
        return commands

    return make


def counted(shapes: Iterable[Shape]) -> Iterator[Shape]:
    """Yield shapes; each of them counts as work before the next one is made."""
    for shape in shapes:
        budget.spend(_SHAPE + _TEXT * isinstance(shape, Text))
        yield shape


@contextmanager
def told_as_shapes() -> Iterator[None]:
    """Say of too much work that the picture has too many shapes."""
    try:
        yield
    except budget.OverBudgetError as error:
        raise budget.OverBudgetError(
            "the picture of the level has too many shapes", f"show it as text, or {error.help}"
        ) from error


def mapped(commands: Iterable[Command], at: Callable[[float, float], Point]) -> Commands:
    """Return a path with each of its points elsewhere."""
    return tuple(
        (
            letter,
            tuple(
                place
                for x, y in zip(numbers[::2], numbers[1::2], strict=True)
                for place in at(x, y)
            ),
        )
        for letter, numbers in commands
    )


@_counted
def placed(commands: Iterable[Command], right: float, down: float, scale: float = 1.0) -> Commands:
    """Return a path so many times as large around (0, 0), and then elsewhere."""
    to = right, down
    return tuple(
        (letter, tuple([to[index & 1] + scale * number for index, number in enumerate(numbers)]))
        for letter, numbers in commands
    )


def shifted(shapes: Iterable[Shape], right: float, down: float) -> Iterator[Shape]:
    """Yield shapes as they are elsewhere: so many pixels to the right, and down."""
    for shape in shapes:
        if isinstance(shape, Path):
            yield replace(shape, commands=placed(shape.commands, right, down))
        else:
            yield replace(shape, x=shape.x + right, y=shape.y + down)


def scaled(
    shapes: Iterable[Shape], scale: float, x: float = 0.0, y: float = 0.0
) -> Iterator[Shape]:
    """Yield shapes as they are smaller or larger: so many times, from the fixed point (x, y)."""

    def at(across: float, down: float) -> Point:
        return x + scale * (across - x), y + scale * (down - y)

    for shape in shapes:
        match shape:
            case Rect():
                left, top = at(shape.x, shape.y)
                width, height, radius = (
                    scale * length for length in (shape.width, shape.height, shape.radius)
                )
                yield replace(shape, x=left, y=top, width=width, height=height, radius=radius)
            case Ellipse():
                middle = at(shape.x, shape.y)
                yield replace(
                    shape, x=middle[0], y=middle[1], rx=scale * shape.rx, ry=scale * shape.ry
                )
            case Text():
                start = at(shape.x, shape.y)
                yield replace(shape, x=start[0], y=start[1], size=scale * shape.size)
            case Path():
                dash = shape.dash and (scale * shape.dash[0], scale * shape.dash[1])
                commands, width = mapped(shape.commands, at), scale * shape.width
                yield replace(shape, commands=commands, width=width, dash=dash)


QUARTER = 0.5523
"""A quarter of a circle is the cubic curve with controls this share of the radius away, to a
thousandth of the radius."""


def outline(text: str) -> Commands:
    """Return a path that is written as in SVG, with blanks between its numbers."""
    steps = re.findall(r"([MLCZ])([^MLCZ]*)", text)
    return tuple((letter, tuple(map(float, numbers.split()))) for letter, numbers in steps)


@_counted
def polyline(points: Iterable[Point]) -> Commands:
    """Return straight lines from point to point."""
    return tuple(("L" if index else "M", point) for index, point in enumerate(points))


def polygon(points: Iterable[Point]) -> Commands:
    """Return straight lines from point to point and back to the first."""
    return (*polyline(points), ("Z", ()))


def rectangle(left: float, top: float, right: float, bottom: float) -> Commands:
    """Return the outline of a rectangle, from its upper left corner clockwise."""
    return polygon([(left, top), (right, top), (right, bottom), (left, bottom)])


def curve(start: Point, control: Point, end: Point) -> Commands:
    """Return a quadratic Bézier curve, as the cubic one that it is."""
    first = tuple(a + 2 / 3 * (b - a) for a, b in zip(start, control, strict=True))
    second = tuple(a + 2 / 3 * (b - a) for a, b in zip(end, control, strict=True))
    return ("M", start), ("C", (*first, *second, *end))


def cubic(start: Point, numbers: Sequence[float], share: float) -> Point:
    """Return the point of a cubic Bézier curve at a share, 0 to 1, of its way."""
    (x0, y0), (x1, y1, x2, y2, x3, y3) = start, numbers
    t, u = share, 1 - share
    a, b, c, d = u * u * u, 3 * u * u * t, 3 * u * t * t, t * t * t
    return a * x0 + b * x1 + c * x2 + d * x3, a * y0 + b * y1 + c * y2 + d * y3


@_counted
def smooth(points: Sequence[Point]) -> Commands:
    """Return the closed smooth curve through the points (a Catmull-Rom spline)."""
    commands: list[Command] = [("M", points[0])]
    count = len(points)
    for index, (x, y) in enumerate(points):
        before_x, before_y = points[index - 1]
        next_x, next_y = points[(index + 1) % count]
        after_x, after_y = points[(index + 2) % count]
        commands.append(
            (
                "C",
                (
                    x + (next_x - before_x) / 6,
                    y + (next_y - before_y) / 6,
                    next_x - (after_x - x) / 6,
                    next_y - (after_y - y) / 6,
                    next_x,
                    next_y,
                ),
            )
        )
    return (*commands, ("Z", ()))


@_counted
def circle(x: float, y: float, rx: float, ry: float | None = None) -> Commands:
    """Return a circle around (`x`, `y`), or an ellipse, from its rightmost point on."""
    ry = rx if ry is None else ry
    a, b = QUARTER * rx, QUARTER * ry
    return (
        ("M", (x + rx, y)),
        ("C", (x + rx, y + b, x + a, y + ry, x, y + ry)),
        ("C", (x - a, y + ry, x - rx, y + b, x - rx, y)),
        ("C", (x - rx, y - b, x - a, y - ry, x, y - ry)),
        ("C", (x + a, y - ry, x + rx, y - b, x + rx, y)),
        ("Z", ()),
    )


def rounded(x: float, y: float, width: float, height: float, radius: float) -> Commands:
    """Return a rectangle with round corners; (`x`, `y`) is its top-left corner."""
    r = min(radius, width / 2, height / 2)
    k = r - QUARTER * r
    right, bottom = x + width, y + height
    return (
        ("M", (x + r, y)),
        ("L", (right - r, y)),
        ("C", (right - k, y, right, y + k, right, y + r)),
        ("L", (right, bottom - r)),
        ("C", (right, bottom - k, right - k, bottom, right - r, bottom)),
        ("L", (x + r, bottom)),
        ("C", (x + k, bottom, x, bottom - k, x, bottom - r)),
        ("L", (x, y + r)),
        ("C", (x, y + k, x + k, y, x + r, y)),
        ("Z", ()),
    )


MAX_SIDE = 2048
"""The largest width and height of a picture on a screen, in pixels; larger ones are scaled."""


def screen_scale(scene: Scene) -> float:
    """Return the scale at which a scene is shown on a screen: 1, or less for a large one."""
    return min(1.0, MAX_SIDE / max(scene.width, scene.height))


def toned(shapes: Iterable[Shape], colors: Colors) -> tuple[Shape, ...]:
    """Return shapes as a theme shows them: all of them in greys if its colours are greys."""
    return tuple(map(_grayed, shapes) if is_gray(colors) else shapes)


def _grayed(shape: Shape) -> Shape:
    if not isinstance(shape, Path):
        return replace(shape, fill=gray(shape.fill))
    fill, stroke = (None if color is None else gray(color) for color in (shape.fill, shape.stroke))
    return replace(shape, fill=fill, stroke=stroke)
