"""Movers: a guard on its path, a wanderer in its rectangle, and where they are allowed to be."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from babyrobot_levels.render.colors import rim_on
from babyrobot_levels.render.scene.icons import INK, Commands, Spot, default_color
from babyrobot_levels.render.scene.layout import CELL, Layout
from babyrobot_levels.render.scene.shapes import (
    Command,
    Path,
    Rect,
    Shape,
    circle,
    curve,
    polygon,
    polyline,
    rounded,
)
from babyrobot_levels.render.scene.situation import Situation

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

Cell = tuple[int, int]

_WHITE = "#ffffff"
CORNERS = ((0.2, -0.2), (0.2, 0.2), (-0.2, -0.2), (-0.2, 0.2))
"""Where movers are that share their cell, as shares of a cell from its centre."""
SMALL = 0.62
"""The scale of a mover that shares its cell."""


def mover_spots(
    level: GridWorld,
    layout: Layout,
    situation: Situation,
    robot: Cell | None,
    *,
    crowded: bool = False,
) -> tuple[Spot, ...]:
    """Return where each mover is drawn: smaller, in a corner, where it shares its cell.

    Args:
        level: the level.
        layout: where its cells are.
        situation: what is where.
        robot: the robot's cell, None without it.
        crowded: whether cells show something else, beside which all movers are.
    """
    places = situation.movers
    lying = situation.lying | {switch.at for switch in level.switches}
    spots = []
    for number, cell in enumerate(places):
        centre = layout.corner(cell[0] + 0.5, cell[1] + 0.5)
        if not crowded and cell != robot and cell not in lying and places.count(cell) == 1:
            spots.append(Spot(*centre))
            continue
        dx, dy = CORNERS[places[:number].count(cell) % len(CORNERS)]
        spots.append(Spot(centre[0] + dx * CELL, centre[1] + dy * CELL, SMALL))
    return tuple(spots)


def mover_shapes(level: GridWorld, number: int, spot: Spot, look: Cell = (0, 0)) -> Iterator[Shape]:
    """Yield the figure of a mover, by its number among the level's.

    Args:
        level: the level.
        number: the number of the mover.
        spot: where it is drawn.
        look: where it looks, `(dx, dy)`.
    """
    mover = level.movers[number]
    kind = "guard" if mover.within is None else "wanderer"
    color = mover.color or default_color(kind, level.resolved_theme.colors)
    yield from figure_shapes(kind, color, spot, look)


def figure_shapes(kind: str, color: str, spot: Spot, look: Cell = (0, 0)) -> Iterator[Shape]:
    """Yield the figure of a `guard`, or of a `wanderer`."""
    yield from (_guard if kind == "guard" else _wanderer)(color, spot, look)


def _guard(color: str, spot: Spot, look: Cell) -> Iterator[Shape]:
    """Yield a ghost with two large eyes."""
    body: Commands = (
        ("M", (-15, 15.5)),
        ("L", (-15, -2)),
        ("C", (-15, -22.5, 15, -22.5, 15, -2)),
        ("L", (15, 15.5)),
        ("C", (12.5, 15.5, 12, 10.5, 10, 10.5)),
        ("C", (8, 10.5, 7.5, 15.5, 5, 15.5)),
        ("C", (2.5, 15.5, 2, 10.5, 0, 10.5)),
        ("C", (-2, 10.5, -2.5, 15.5, -5, 15.5)),
        ("C", (-7.5, 15.5, -8, 10.5, -10, 10.5)),
        ("C", (-12, 10.5, -12.5, 15.5, -15, 15.5)),
        ("Z", ()),
    )
    yield from spot.body(body, color)
    shine = curve((-11.4, -4.0), (-10.6, -11.4), (-4.4, -13.6))
    yield spot.line(shine, _WHITE, 2.2, 0.6)
    yield from _eyes(spot, -2.5, 5.6, 4.4, 5.2, look)


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
    figure = (*wings, *ears, *head)
    yield from spot.body(figure, color)
    yield spot.fill(wings, "#000000", 0.3)
    yield spot.line(circle(0, 1, 11.5, 11.5), INK, 1.8)
    yield spot.fill(head, color)
    yield from _eyes(spot, -0.5, 4.6, 3.6, 4.2, look)
    yield spot.line(curve((-3.2, 7.2), (0, 9.4), (3.2, 7.2)), INK, 1.8)


def _eyes(spot: Spot, y: float, apart: float, rx: float, ry: float, look: Cell) -> Iterator[Shape]:
    for side in (-1, 1):
        yield spot.fill(circle(apart * side, y, rx, ry), _WHITE)
        yield spot.line(circle(apart * side, y, rx, ry), INK, 1.2)
        x, down = apart * side + 0.42 * rx * look[0], 0.42 * ry * look[1]
        yield spot.fill(circle(x, y + 0.6 + down, 0.54 * rx, 0.54 * ry), INK)


# -- where they may be, in the picture of the level as a whole --------------------------------

_REGION = 0.15
"""The opacity of rectangles."""


def track_shapes(level: GridWorld, layout: Layout) -> Iterator[Shape]:
    """Yield the paths and the rectangles of movers, faintly."""
    colors = level.resolved_theme.colors
    for mover in level.movers:
        if mover.within is not None:
            color = mover.color or default_color("wanderer", colors)
            (left, top), (width, height) = mover.within.at, mover.within.size
            x, y = layout.corner(left, top)
            box = x + 7, y + 7, width * CELL - 14, height * CELL - 14
            yield Rect(*box, color, radius=12, opacity=_REGION)
            yield from _dotted(rounded(*box, 12), colors.arrows, 2.0)
        elif track := _track(mover.path or (), is_loop=not mover.back):
            points = [layout.corner(x + 0.5, y + 0.5) for x, y in track]
            yield from _dotted(polyline(points), colors.arrows, 3.0)


def _dotted(commands: Commands, color: str, width: float) -> Iterator[Path]:
    """Yield a dotted line whose dots have a rim."""
    for ink, more in ((rim_on([color]), 2.4), (color, 0.0)):
        yield Path(commands, stroke=ink, width=width + more, dash=(2.0, 7.0), cap="round")


def _track(path: Sequence[Cell], *, is_loop: bool) -> Sequence[Cell]:
    """Return the line of a path; nothing for one that stays where it is."""
    if len({*path}) < 2:
        return ()
    return (*path, path[0]) if is_loop and path[0] != path[-1] else path
