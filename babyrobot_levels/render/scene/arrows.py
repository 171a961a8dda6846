"""What moves the robot besides its own actions: warps as arrows, wind as chevrons."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, NamedTuple

from babyrobot_levels.language.looks import Colors
from babyrobot_levels.language.moves import shifts
from babyrobot_levels.render.colors import GRAPHICS, contrast, rim_on
from babyrobot_levels.render.scene.cell_grounds import Cell, CellGrounds
from babyrobot_levels.render.scene.layout import CELL, Layout
from babyrobot_levels.render.scene.shapes import (
    QUARTER,
    Command,
    Ellipse,
    Path,
    Point,
    Shape,
    curve,
    polygon,
    polyline,
)
from babyrobot_levels.render.scene.slots import ICON, Box, Slots

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

_WIDTH = 3.0
_HEAD = 11.0
_HALO = 2.0
_RING = 9.0
_MAX_CHEVRONS = 3

Dash = tuple[float, float] | None


def warp_shapes(level: GridWorld, layout: Layout, slots: Slots) -> Iterator[Shape]:
    """Yield the warps: an arrow from a ring to a cell, or a turning one for the start.

    A warp that acts on entering is drawn solid, one that acts on leaving dashed.
    """
    colors, grounds = level.resolved_theme.colors, CellGrounds(level)
    rings = {warp.at for warp in level.warps}
    for warp in level.warps:
        centre = slots.icon(warp.at).centre
        dash = (6.0, 4.0) if warp.when == "leave" else None
        if isinstance(warp.to, str):
            rim = _rim(colors, [grounds[warp.at]])
            yield from _turning_arrow(centre, colors.arrows, rim, dash)
        else:
            if warp.to != warp.at:
                target = slots.icon(warp.to).centre
                gap = _RING + 3 if warp.to in rings else 0.0
                shaft, head = _arrow(centre, target, gap)
                below = {grounds[layout.cell(point)] for point in _places(shaft)}
                yield from _drawn(shaft, head, colors.arrows, _rim(colors, below), dash)
            rim = _rim(colors, [grounds[warp.at]])
            yield Ellipse(*centre, _RING + _HALO, _RING + _HALO, rim.color, rim.opacity)
            for radius, fill in ((_RING, colors.arrows), (6.0, rim.color), (3.0, colors.arrows)):
                yield Ellipse(*centre, radius, radius, fill)


def crossed_cells(level: GridWorld, layout: Layout) -> set[Cell]:
    """Return the cells that the arrows of warps cross."""
    centres = [
        [layout.corner(x + 0.5, y + 0.5) for x, y in (warp.at, warp.to)]
        for warp in level.warps
        if not isinstance(warp.to, str) and warp.to != warp.at
    ]
    return {
        layout.cell(point)
        for start, end in centres
        for point in _places(_arrow(start, end, 0.0)[0])
    }


class _Rim(NamedTuple):
    """What sets an arrow off from what it crosses."""

    color: str
    opacity: float


def _rim(colors: Colors, grounds: Iterable[str]) -> _Rim:
    """Return the rim of arrows: one like the base, unless their colour is like the ground."""
    if all(contrast(colors.arrows, ground) >= GRAPHICS for ground in grounds):
        return _Rim(colors.base, 0.6)
    return _Rim(rim_on([colors.arrows]), 1.0)


def _turning_arrow(centre: Point, color: str, rim: _Rim, dash: Dash) -> Iterator[Shape]:
    """Yield an arrow that turns clockwise."""
    x, y = centre[0], centre[1] + 4
    r, k = 11.0, 11.0 * QUARTER
    shaft: tuple[Command, ...] = (
        ("M", (x + r, y)),
        ("C", (x + r, y + k, x + k, y + r, x, y + r)),
        ("C", (x - k, y + r, x - r, y + k, x - r, y)),
        ("C", (x - r, y - k, x - k, y - r, x, y - r)),
    )
    head = polygon([(x - 1, y - r - 6), (x - 1, y - r + 6), (x + 8, y - r)])
    yield from _drawn(shaft, head, color, rim, dash)


def _arrow(start: Point, end: Point, gap: float) -> tuple[tuple[Command, ...], tuple[Command, ...]]:
    """Return shaft and head of a bowed arrow; `gap` is the distance from its tip to `end`."""
    length = math.dist(start, end)
    along_x, along_y = (end[0] - start[0]) / length, (end[1] - start[1]) / length
    bow = min(0.16 * length, CELL)
    control = (
        (start[0] + end[0]) / 2 + bow * along_y,
        (start[1] + end[1]) / 2 - bow * along_x,
    )
    reach = math.dist(control, end)
    toward_x, toward_y = (end[0] - control[0]) / reach, (end[1] - control[1]) / reach
    tip = (end[0] - gap * toward_x, end[1] - gap * toward_y)
    neck = (tip[0] - 0.8 * _HEAD * toward_x, tip[1] - 0.8 * _HEAD * toward_y)
    back = (tip[0] - _HEAD * toward_x, tip[1] - _HEAD * toward_y)
    half = 0.5 * _HEAD
    shaft = curve(start, control, neck)
    head = polygon(
        [
            tip,
            (back[0] - half * toward_y, back[1] + half * toward_x),
            neck,
            (back[0] + half * toward_y, back[1] - half * toward_x),
        ]
    )
    return shaft, head


def _places(shaft: tuple[Command, ...]) -> Iterator[Point]:
    """Yield points along a shaft, less than half a cell apart."""
    (_, start), (_, (x1, y1, x2, y2, *end)) = shaft
    count = math.ceil(3 * math.dist(start, end) / CELL)
    for t in (step / count for step in range(count + 1)):
        u = 1 - t
        a, b, c, d = u * u * u, 3 * u * u * t, 3 * u * t * t, t * t * t
        yield (
            a * start[0] + b * x1 + c * x2 + d * end[0],
            a * start[1] + b * y1 + c * y2 + d * end[1],
        )


def _drawn(
    shaft: tuple[Command, ...], head: tuple[Command, ...], color: str, rim: _Rim, dash: Dash
) -> Iterator[Shape]:
    """Yield an arrow on its rim."""
    yield Path(shaft, stroke=rim.color, width=_WIDTH + 2 * _HALO, opacity=rim.opacity)
    yield Path(head, stroke=rim.color, width=2 * _HALO, opacity=rim.opacity)
    yield Path(shaft, stroke=color, width=_WIDTH, dash=dash)
    yield Path(head, fill=color)


def wind_shapes(level: GridWorld, layout: Layout, slots: Slots) -> Iterator[Shape]:
    """Yield chevrons where the wind blows: one for each cell that it pushes, at most three."""
    if level.wind is None:
        return
    south, east = shifts(level.wind, layout.columns, layout.rows)
    still = {*level.exits}
    blocked = level.grid().blocked_cells
    commands = [
        command
        for y in range(layout.rows)
        for x in range(layout.columns)
        if (east[y] or south[x]) and (x, y) not in still and not blocked[y * layout.columns + x]
        for command in _chevrons(slots.icon((x, y)), east[y], south[x])
    ]
    if commands:
        yield Path(
            tuple(commands),
            stroke=level.resolved_theme.colors.arrows,
            width=2.5,
            cap="round",
            opacity=0.55,
        )


def _chevrons(box: Box, east: int, south: int) -> Iterator[Command]:
    centre, scale = box.centre, min(1.0, 1.3 * box.width / ICON)
    strength = math.hypot(east, south)
    along_x, along_y = east / strength, south / strength
    count = min(max(abs(east), abs(south)), _MAX_CHEVRONS)
    for index in range(count):
        middle = 11 * (index - (count - 1) / 2)
        points = ((middle - 3, -7), (middle + 3, 0), (middle - 3, 7))
        yield from polyline(
            (
                centre[0] + scale * (along * along_x - across * along_y),
                centre[1] + scale * (along * along_y + across * along_x),
            )
            for along, across in points
        )
