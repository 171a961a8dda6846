"""What moves the robot besides its own actions: warps as arrows, wind as chevrons."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from babyrobot_levels.language.looks import Colors
from babyrobot_levels.language.moves import shifts
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
    colors = level.resolved_theme.colors
    rings = {warp.at for warp in level.warps}
    for warp in level.warps:
        centre = slots.icon(warp.at).centre
        dash = (6.0, 4.0) if warp.when == "leave" else None
        if isinstance(warp.to, str):
            yield from _turning_arrow(centre, colors, dash)
        else:
            if warp.to != warp.at:
                target = slots.icon(warp.to).centre
                gap = _RING + 3 if warp.to in rings else 0.0
                yield from _arrow(centre, target, gap, colors, dash)
            for radius, fill in ((_RING, colors.arrows), (6.0, colors.base), (3.0, colors.arrows)):
                yield Ellipse(*centre, radius, radius, fill)


def _turning_arrow(centre: Point, colors: Colors, dash: Dash) -> Iterator[Shape]:
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
    yield from _halo(shaft, head, colors.base)
    yield Path(shaft, stroke=colors.arrows, width=_WIDTH, dash=dash)
    yield Path(head, fill=colors.arrows)


def _arrow(start: Point, end: Point, gap: float, colors: Colors, dash: Dash) -> Iterator[Shape]:
    """Yield a bowed arrow; `gap` is the distance in pixels from its tip to `end`."""
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
    yield from _halo(shaft, head, colors.base)
    yield Path(shaft, stroke=colors.arrows, width=_WIDTH, dash=dash)
    yield Path(head, fill=colors.arrows)


def _halo(shaft: tuple[Command, ...], head: tuple[Command, ...], color: str) -> Iterator[Shape]:
    """Yield the outline that sets an arrow off where it crosses puddles and areas."""
    yield Path(shaft, stroke=color, width=_WIDTH + 2 * _HALO, opacity=0.6)
    yield Path(head, stroke=color, width=2 * _HALO, opacity=0.6)


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
