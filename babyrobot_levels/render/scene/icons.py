"""The pictures of items, locks and movers: flat shapes with an outline and a light rim.

The dark outline holds on light grounds, the rim on dark ones, so that an icon stands out on any
theme, and on areas of any colour.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.language.looks import Colors
from babyrobot_levels.language.things import Item, Mover, Switch, Target
from babyrobot_levels.render.colors import BLACK, WHITE, gray, is_gray, mixed
from babyrobot_levels.render.scene.shapes import (
    Command,
    Commands,
    Path,
    Shape,
    circle,
    curve,
    outline,
    placed,
    polygon,
    polyline,
    rounded,
)

INK = "#232c38"
"""The colour of outlines: that of the robot's."""

RIM = WHITE
"""The colour around the outlines."""

_OUTLINE, _RIM = 2.2, 1.6
"""The widths of outline and rim in pixels."""


@dataclass(frozen=True, slots=True)
class Spot:
    """Where and how large a figure is drawn; it is designed around (0, 0), 64 pixels wide.

    Attributes:
        x: its centre in the picture.
        y: its centre in the picture.
        scale: its size.
        faded_on: the colour of the ground into which the whole figure fades; None for a clear one.
        strength: the share of its colours that a faded figure keeps.
    """

    x: float
    y: float
    scale: float = 1.0
    faded_on: str | None = None
    strength: float = 0.72

    def moved(self, commands: Iterable[Command]) -> Commands:
        """Return a path of the figure in the picture."""
        return placed(commands, self.x, self.y, self.scale)

    def ink(self, color: str) -> str:
        """Return the colour in which something of this colour is painted."""
        return color if self.faded_on is None else mixed(color, self.faded_on, self.strength)

    def fill(self, commands: Iterable[Command], color: str, opacity: float = 1.0) -> Path:
        """Return a filled outline."""
        return Path(self.moved(commands), fill=self.ink(color), opacity=opacity)

    def line(
        self, commands: Iterable[Command], color: str, width: float, opacity: float = 1.0
    ) -> Path:
        """Return a line with round ends."""
        return Path(
            self.moved(commands),
            stroke=self.ink(color),
            width=self.scale * width,
            cap="round",
            opacity=opacity,
        )

    def body(self, commands: Commands, color: str) -> Iterator[Path]:
        """Yield a filled outline with its rim."""
        yield self.line(commands, RIM, 2 * (_OUTLINE + _RIM))
        yield self.line(commands, INK, 2 * _OUTLINE)
        yield self.fill(commands, color)

    def wire(self, commands: Commands, color: str, width: float) -> Iterator[Path]:
        """Yield a thick line with its outline and rim."""
        yield self.line(commands, RIM, width + 2 * (_OUTLINE + _RIM))
        yield self.line(commands, INK, width + 2 * _OUTLINE)
        yield self.line(commands, color, width)


# -- colours -------------------------------------------------------------------------------------

_COLORS = {
    "key": "#ffc21a",
    "coin": "#ffd84d",
    "gem": "#35c9e8",
    "star": "#ffe14a",
    "box": "#d69552",
    "door": "#b9773a",
    "switch": "#3ee08a",
    "target": "#ff9ad1",
    "guard": "#ff5d73",
    "wanderer": "#b794ff",
}
"""The colours of things that have none of their own, by shape or kind."""

KINDS = tuple(_COLORS)


def default_color(kind: str, colors: Colors) -> str:
    """Return the colour of a kind of thing in a theme; a theme of greys takes a grey."""
    return gray(_COLORS[kind]) if is_gray(colors) else _COLORS[kind]


def thing_color(thing: Item | Switch | Target | Mover, colors: Colors) -> str:
    """Return the colour of a thing: its own, or that of its kind in a theme."""
    return thing.color or default_color(thing.picture, colors)


# -- items ---------------------------------------------------------------------------------------


def item_shapes(shape: str, color: str, spot: Spot) -> Iterator[Shape]:
    """Yield the picture of an item.

    Args:
        shape: one of `SHAPES` of the language.
        color: a CSS colour.
        spot: where.
    """
    yield from _PICTURES[shape](color, spot)


def _key(color: str, spot: Spot) -> Iterator[Shape]:
    bow = circle(-6.5, -6.5, 7.5)
    shaft = polyline([(-1.2, -1.2), (14.5, 14.5)])
    teeth = (*polyline([(7, 7), (12, 2)]), *polyline([(13.5, 13.5), (18.0, 9.0)]))
    yield from spot.wire((*bow, *shaft, *teeth), color, 5.4)
    yield spot.fill(circle(-6.5, -6.5, 4.0), INK)
    yield spot.line(curve((-13.2, -8.0), (-12.0, -12.0), (-8.0, -13.2)), WHITE, 1.8, 0.85)


def _coin(color: str, spot: Spot) -> Iterator[Shape]:
    yield from spot.body(circle(0, 0, 14.5), color)
    yield spot.line(circle(0, 0, 9.8), BLACK, 1.8, 0.28)
    yield spot.line(polyline([(0, -4.2), (0, 4.2)]), BLACK, 3.6, 0.55)
    yield spot.line(curve((-11.6, -3.6), (-9.6, -9.6), (-3.6, -11.6)), WHITE, 2.2, 0.9)


def _gem(color: str, spot: Spot) -> Iterator[Shape]:
    left, right = (-17.0, -4.0), (17.0, -4.0)
    crown_left, crown_right, foot = (-9.5, -13.5), (9.5, -13.5), (0.0, 16.0)
    yield from spot.body(polygon([left, crown_left, crown_right, right, foot]), color)
    inner_left, inner_right = (-6.0, -4.0), (6.0, -4.0)
    yield spot.fill(polygon([left, inner_left, foot]), BLACK, 0.16)
    yield spot.fill(polygon([right, inner_right, foot]), BLACK, 0.30)
    yield spot.fill(polygon([crown_left, crown_right, inner_right, inner_left]), WHITE, 0.5)
    yield spot.fill(polygon([left, crown_left, inner_left]), WHITE, 0.25)


def _star(color: str, spot: Spot) -> Iterator[Shape]:
    points = [
        (reach * math.sin(math.pi * index / 5), 1.4 - reach * math.cos(math.pi * index / 5))
        for index in range(10)
        for reach in ((17.5, 8.0)[index % 2],)
    ]
    yield from spot.body(polygon(points), color)
    # The facets that look to the lower right lie in the shade.
    yield spot.fill(polygon([(0.0, 1.4), *points[2:6]]), BLACK, 0.16)


def _box(color: str, spot: Spot) -> Iterator[Shape]:
    yield from spot.body(rounded(-15, -13, 30, 27, 2.5), color)
    yield spot.fill(rounded(-15, -13, 30, 8.5, 2.5), WHITE, 0.3)
    yield spot.line(polyline([(-15, -4.5), (15, -4.5)]), INK, 2.0)
    yield spot.fill(polygon([(-3.5, -13), (3.5, -13), (3.5, 0.5), (-3.5, 0.5)]), BLACK, 0.45)


_PICTURES: dict[str, Callable[[str, Spot], Iterator[Shape]]] = {
    "key": _key,
    "coin": _coin,
    "gem": _gem,
    "star": _star,
    "box": _box,
}


def crate_shapes(color: str, spot: Spot, covers: str | None = None) -> Iterator[Shape]:
    """Yield a box to push: planks, and on a target a frame in the target's colour.

    Args:
        color: a CSS colour.
        spot: where.
        covers: the colour of the target that it covers, None for none.
    """
    yield from spot.body(rounded(-22, -22, 44, 44, 4), color)
    for x in (-7.5, 7.5):
        yield spot.line(polyline([(x, -16), (x, 16)]), BLACK, 2.0, 0.35)
    yield spot.line(polyline([(-15, 15), (15, -15)]), BLACK, 6.5, 0.3)
    frame = rounded(-18.5, -18.5, 37, 37, 2.5)
    yield spot.line(frame, INK if covers else BLACK, 8.0 if covers else 6.0, 1.0 if covers else 0.3)
    if covers:
        yield spot.line(frame, covers, 4.6)


def padlock_shapes(color: str, spot: Spot) -> Iterator[Shape]:
    """Yield a padlock."""
    shackle = outline("M-6.5 -1 L-6.5 -6 C-6.5 -14.5 6.5 -14.5 6.5 -6 L6.5 -1")
    yield from spot.wire(shackle, color, 3.2)
    yield spot.fill(shackle, INK)
    yield spot.line(shackle, color, 3.2)
    yield from spot.body(rounded(-11.5, -2, 23, 16, 3.5), color)
    yield spot.fill(circle(0, 4.6, 2.7), INK)
    yield spot.line(polyline([(0, 5), (0, 9.4)]), INK, 2.4)


# -- movers --------------------------------------------------------------------------------------


def figure_shapes(kind: str, color: str, spot: Spot, look: Cell = (0, 0)) -> Iterator[Shape]:
    """Yield the figure of a `guard`, or of a `wanderer`."""
    yield from (_guard if kind == "guard" else _wanderer)(color, spot, look)


def _guard(color: str, spot: Spot, look: Cell) -> Iterator[Shape]:
    """Yield a sentry on two tracks, with a visor that looks where it goes."""
    for side in (-1, 1):
        yield from spot.body(rounded(9.5 * side - 5.5, 9, 11, 9, 3.5), INK)
    yield from spot.body(rounded(-16, -16, 32, 29, 9), color)
    yield spot.line(polyline([(-13, 8), (13, 8)]), BLACK, 2.4, 0.35)
    yield spot.line(curve((-12.4, -6.0), (-12.4, -12.4), (-6.0, -12.4)), WHITE, 2.2, 0.6)
    yield spot.fill(rounded(-12.5, -8, 25, 12, 6), INK)
    for side in (-1, 1):
        yield spot.fill(circle(5.2 * side + 3.0 * look[0], -2 + 1.8 * look[1], 2.5, 3.2), WHITE)


def _wanderer(color: str, spot: Spot, look: Cell) -> Iterator[Shape]:
    """Yield a bat with spread wings."""
    wings: list[Command] = []
    for side in (-1, 1):
        wings += [
            ("M", (7 * side, -3)),
            ("C", (12 * side, -12, 18 * side, -14, 24.5 * side, -13)),
            ("C", (22 * side, -7, 22.5 * side, -1, 24 * side, 7)),
            ("C", (20 * side, 3.5, 18 * side, 4.5, 16 * side, 8)),
            ("C", (13.5 * side, 5, 10.5 * side, 5.5, 7 * side, 8)),
            ("Z", ()),
        ]
    head = circle(0, 1, 11.5, 11.5)
    ears = [
        command
        for side in (-1, 1)
        for command in polygon([(10 * side, -4), (8.5 * side, -16), (2.5 * side, -9)])
    ]
    yield from spot.body((*wings, *ears, *head), color)
    yield spot.fill(wings, BLACK, 0.3)
    yield spot.line(circle(0, 1, 11.5, 11.5), INK, 1.8)
    yield spot.fill(head, color)
    yield from _eyes(spot, -0.5, 4.6, 3.6, 4.2, look)
    yield spot.line(curve((-3.2, 7.2), (0, 9.4), (3.2, 7.2)), INK, 1.8)


def _eyes(spot: Spot, y: float, apart: float, rx: float, ry: float, look: Cell) -> Iterator[Shape]:
    for side in (-1, 1):
        yield spot.fill(circle(apart * side, y, rx, ry), WHITE)
        yield spot.line(circle(apart * side, y, rx, ry), INK, 1.2)
        x, down = apart * side + 0.42 * rx * look[0], 0.42 * ry * look[1]
        yield spot.fill(circle(x, y + 0.6 + down, 0.54 * rx, 0.54 * ry), INK)
