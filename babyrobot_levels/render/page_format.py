"""What a page's script reads, as compact JSON data: shapes, colours and numbers.

A layer is a list of groups `[x, y, shapes]`, whose shapes are relative to the point (x, y), so
that equal cells give equal text. Lengths are tenths of a pixel, opacities are percentages, and a
colour is its index in the palette, or -2 and less for the colours of the heat map's scale from the
lowest on. A shape is a list that begins with its kind:

- 0, a rectangle: fill, x, y, width, height, opacity, radius;
- 1, an ellipse: fill, x, y, rx, ry, opacity;
- 2, a path: fill (-1 for none), commands, opacity, stroke, width, cap (1 for round), dash, gap;
- 3, a text: fill, x, y, text, size, anchor, bold, opacity;
- 4, the outline of the last path again: fill, scale in thousandths, x, y, opacity; (x, y) is the
  fixed point;
- 5, a bar with colours of the scale from left to right: -1, x, y, width, height, and the indices of
  the first and the last of them.

Default values at the end are left out. Commands are one text: `m`, `l`, `c` and `z` as in SVG,
each number relative to the previous point, and `s`, the points of a closed smooth curve (a
Catmull-Rom spline), each relative to the previous one.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from typing import Any

from babyrobot_levels.mdp.actions import MOVES, Action
from babyrobot_levels.render.colors import gray, rgba
from babyrobot_levels.render.scene.layout import CELL
from babyrobot_levels.render.scene.shapes import (
    Command,
    Ellipse,
    Path,
    Point,
    Rect,
    Shape,
    Text,
    smooth,
)
from babyrobot_levels.render.situation import STANDING, Mood, Pose
from babyrobot_levels.render.svg import number

RECT, ELLIPSE, PATH, TEXT, AGAIN, BAR = range(6)
"""The kinds of shapes."""

ANCHORS = ("start", "middle", "end")

Group = list[Any]
Packed = list[Any]

_UNIT = 0.1
_NEAR = 0.1
"""The largest distance in pixels at which a path counts as a scaled copy of another."""


class TooLargeError(ValueError):
    """A level that is too large for a page or a link."""


class Palette:
    """The colours of a picture, each once, in the order of their first use.

    Args:
        names: names that are kept as they are, besides colours.
        is_gray: whether all colours become greys.
    """

    def __init__(self, names: Iterable[str] = (), *, is_gray: bool = False) -> None:
        self._names, self._is_gray = frozenset(names), is_gray
        self._scale: dict[str, int] = {}
        self._places: dict[str, int] = {}

    @property
    def colors(self) -> list[str]:
        """The colours, each `#rrggbb`, or `#rrggbbaa`, or one of the names."""
        return list(self._places)

    def use(self, scale: Sequence[str]) -> None:
        """From now on, refer to the colours of a scale by their numbers there."""
        self._scale = {color: -2 - step for step, color in enumerate(scale)}

    def place(self, color: str | None) -> int:
        """Return the number of a colour; -1 for none."""
        if color is None:
            return -1
        if color in self._scale:
            return self._scale[color]
        key = color
        if color not in self._names:
            key = hexadecimal(gray(color) if self._is_gray else color)
        return self._places.setdefault(key, len(self._places))


def hexadecimal(color: str) -> str:
    """Return a colour as `#rrggbb`, or as `#rrggbbaa` if it is not opaque."""
    red, green, blue, alpha = rgba(color)
    text = f"#{red:02x}{green:02x}{blue:02x}"
    return text if alpha == 1 else f"{text}{round(255 * alpha):02x}"


def pack(shapes: Iterable[Shape], palette: Palette, margin: float = 0.0) -> list[Group]:
    """Return shapes as groups, one for each run of shapes that begin in the same cell.

    Args:
        shapes: the shapes, in painting order.
        palette: the colours so far, to which those of the shapes are added.
        margin: the margin around the cells, in pixels.
    """
    groups: list[Group] = []
    for (left, top), run in groupby(shapes, lambda shape: _corner(_start(shape), margin)):
        packed: list[Packed] = []
        last: Path | None = None
        for shape in run:
            packed.append(_packed(shape, (left, top), palette, last))
            if isinstance(shape, Path) and packed[-1][0] == PATH:
                last = shape
        groups.append([length(left), length(top), packed])
    return groups


def _start(shape: Shape) -> Point:
    if isinstance(shape, Path):
        x, y = shape.commands[0][1][:2]
        return x, y
    return shape.x, shape.y


def _corner(point: Point, margin: float) -> Point:
    x, y = ((place - margin) // CELL * CELL + margin for place in point)
    return x, y


def _packed(shape: Shape, origin: Point, palette: Palette, last: Path | None) -> Packed:
    x, y = (length(a - b) for a, b in zip(_start(shape), origin, strict=True))
    fill, opacity = palette.place(shape.fill), round(100 * shape.opacity)
    match shape:
        case Rect():
            size = length(shape.width), length(shape.height)
            return _trimmed([RECT, fill, x, y, *size], (opacity, 100), (length(shape.radius), 0))
        case Ellipse():
            size = length(shape.rx), length(shape.ry)
            return _trimmed([ELLIPSE, fill, x, y, *size], (opacity, 100))
        case Text():
            return _trimmed(
                [TEXT, fill, x, y, shape.text, length(shape.size)],
                (ANCHORS.index(shape.anchor), 1),
                (int(shape.bold), 0),
                (opacity, 100),
            )
        case Path():
            if shape.stroke is None and last is not None and (how := _scaled(shape, last, origin)):
                return _trimmed([AGAIN, fill, *how], (opacity, 100))
            dash, gap = shape.dash or (0, 0)
            return _trimmed(
                [PATH, fill, _commands(shape.commands, origin)],
                (opacity, 100),
                (palette.place(shape.stroke), -1),
                (length(shape.width), 10),
                (int(shape.cap == "round"), 0),
                (length(dash), 0),
                (length(gap), 0),
            )


def _trimmed(needed: Packed, *more: tuple[int, int]) -> Packed:
    """Return a shape without the default values at its end."""
    values = list(more)
    while values and values[-1][0] == values[-1][1]:
        values.pop()
    return needed + [value for value, _ in values]


def length(value: float) -> int:
    """Return a length in tenths of a pixel."""
    return round(value / _UNIT)


# -- paths ---------------------------------------------------------------------------------------


def _scaled(path: Path, other: Path, origin: Point) -> tuple[int, int, int] | None:
    """Return scale and fixed point of a scaled copy of another path; None if it is none."""
    letters = [letter for letter, _ in path.commands]
    if letters != [letter for letter, _ in other.commands]:
        return None
    ours, theirs = _places(path.commands), _places(other.commands)
    width = max(theirs[0]) - min(theirs[0])
    scale = (max(ours[0]) - min(ours[0])) / width if width else 1.0
    if abs(scale - 1) < 0.01:
        return None
    fixed = [(a[0] - scale * b[0]) / (1 - scale) for a, b in zip(ours, theirs, strict=True)]
    for there, mine, middle in zip(theirs, ours, fixed, strict=True):
        for a, b in zip(mine, there, strict=True):
            if abs(middle + scale * (b - middle) - a) > _NEAR:
                return None
    x, y = (length(place - start) for place, start in zip(fixed, origin, strict=True))
    return round(1000 * scale), x, y


def _places(commands: Sequence[Command]) -> tuple[list[float], list[float]]:
    """Return all x and all y of a path."""
    return (
        [x for _, numbers in commands for x in numbers[::2]],
        [y for _, numbers in commands for y in numbers[1::2]],
    )


def _commands(commands: Sequence[Command], origin: Point) -> str:
    last = length(origin[0]), length(origin[1])
    if points := _smooth_points(commands):
        return "s" + _joined(_steps(points, last))
    parts = []
    for letter, numbers in commands:
        points = list(zip(numbers[::2], numbers[1::2], strict=True))
        places = [(length(x), length(y)) for x, y in points]
        # A line of no length is seen only where it is all of the path.
        if letter == "L" and {*places} == {last} and len(commands) > 3:
            continue
        parts.append(letter.lower() + _joined((x - last[0], y - last[1]) for x, y in places))
        last = places[-1] if places else last
    return "".join(parts)


def _smooth_points(commands: Sequence[Command]) -> list[Point]:
    """Return the points of a closed smooth curve; none for other paths."""
    if len(commands) < 4 or {letter for letter, _ in commands[1:-1]} != {"C"}:
        return []
    points = [(numbers[-2], numbers[-1]) for _, numbers in commands[:-2]]
    return points if smooth(points) == tuple(commands) else []


def _steps(points: Sequence[Point], last: tuple[int, int]) -> Iterator[tuple[int, int]]:
    for x, y in points:
        place = length(x), length(y)
        yield place[0] - last[0], place[1] - last[1]
        last = place


def _joined(steps: Iterable[tuple[int, int]]) -> str:
    """Return numbers as short as SVG allows: a minus sign also separates."""
    return " ".join(str(number) for step in steps for number in step).replace(" -", "-")


# -- what is the same for all levels ---------------------------------------------------------------

EVENTS = ("stay", "move", "carried", "bump", "skid", "bounce")
"""The events of a step: warps and wind carry the robot, walls bump it, glass bounces it.

In an outcome, the number of the event is larger by `len(EVENTS)` times the number of the mover
that hits the robot, counted from 1.
"""

CHEER = 1
"""The index of the pose at a good end."""

POSES = (
    STANDING,
    Pose(mood=Mood.CHEER),
    *(Pose(action) for action in MOVES),
    *(Pose(action, Mood.SLIP) for action in (Action.STAY, *MOVES)),
)
"""All poses after a step; outcomes give their indices. The first one is that of the start."""

HEADING_POSES = [
    [POSES.index(Pose(action, mood)) for action in MOVES] for mood in (Mood.CALM, Mood.SLIP)
]
"""The indices of the poses of a robot that turns, by heading: calm, and slipping."""


# -- numbers ---------------------------------------------------------------------------------------


def rounded(value: float) -> str:
    """Return a return as text, with two decimals, or two digits where it is small."""
    if math.isinf(value):
        text = "-∞" if value < 0 else "∞"
    elif abs(value) >= 0.1 or abs(value) < 1e-6:
        text = number(value)
    else:
        text = f"{float(f'{value:.1e}'):.7f}".rstrip("0")
    return text.replace("-", "\N{MINUS SIGN}")


def short(value: float) -> float | int:
    """Return a number, as an integer if it is one."""
    return int(value) if float(value).is_integer() else value


def runs_of(cells: Sequence[int]) -> list[int]:
    """Return ascending numbers as runs: the first number and the length of each."""
    runs: list[int] = []
    for cell in cells:
        if runs and cell == runs[-2] + runs[-1]:
            runs[-1] += 1
        else:
            runs += [cell, 1]
    return runs
