"""What moves the robot besides his own wheels: warps as arrows, wind as chevrons."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from babyrobot_levels.scene.layout import CELL, Layout
from babyrobot_levels.scene.paths import Point, curve, polygon, polyline
from babyrobot_levels.scene.shapes import Command, Ellipse, Path, Shape
from babyrobot_levels.spec.moves import shifts

if TYPE_CHECKING:
    from babyrobot_levels.level import Level

_WIDTH = 3.0
_HEAD = 11.0
_RING = 9.0
_MAX_CHEVRONS = 3


def warp_shapes(level: Level, layout: Layout) -> Iterator[Shape]:
    """Yield an arrow for each warp, from its cell to where it leads.

    A warp that acts on entering is drawn solid, one that acts on leaving dashed.
    """
    theme = level.colors_and_widths.colors
    for warp in level.warps:
        targets = level.starts if isinstance(warp.to, str) else (warp.to,)
        for target in targets:
            if target != warp.at:
                yield from _arrow(
                    layout.corner(warp.at[0] + 0.5, warp.at[1] + 0.5),
                    layout.corner(target[0] + 0.5, target[1] + 0.5),
                    theme.arrows,
                    dashed=warp.when == "leave",
                )
    for warp in level.warps:
        x, y = layout.corner(warp.at[0] + 0.5, warp.at[1] + 0.5)
        yield Ellipse(x, y, _RING, _RING, theme.arrows)
        yield Ellipse(x, y, _RING - _WIDTH, _RING - _WIDTH, theme.base)
        yield Ellipse(x, y, _RING - 2 * _WIDTH, _RING - 2 * _WIDTH, theme.arrows)


def _arrow(start: Point, end: Point, colour: str, *, dashed: bool) -> Iterator[Shape]:
    """Yield a bowed arrow that ends a little before the middle of the cell it points to."""
    length = math.dist(start, end)
    along_x, along_y = (end[0] - start[0]) / length, (end[1] - start[1]) / length
    bow = min(0.16 * length, CELL)
    control = (
        (start[0] + end[0]) / 2 + bow * along_y,
        (start[1] + end[1]) / 2 - bow * along_x,
    )
    reach = math.dist(control, end)
    toward_x, toward_y = (end[0] - control[0]) / reach, (end[1] - control[1]) / reach
    tip = (end[0] - 0.16 * CELL * toward_x, end[1] - 0.16 * CELL * toward_y)
    neck = (tip[0] - 0.8 * _HEAD * toward_x, tip[1] - 0.8 * _HEAD * toward_y)
    back = (tip[0] - _HEAD * toward_x, tip[1] - _HEAD * toward_y)
    half = 0.5 * _HEAD
    yield Path(
        curve(start, control, neck),
        stroke=colour,
        width=_WIDTH,
        dash=(8, 6) if dashed else None,
        opacity=0.85,
    )
    yield Path(
        polygon(
            [
                tip,
                (back[0] - half * toward_y, back[1] + half * toward_x),
                neck,
                (back[0] + half * toward_y, back[1] - half * toward_x),
            ]
        ),
        fill=colour,
    )


def wind_shapes(level: Level, layout: Layout) -> Iterator[Shape]:
    """Yield chevrons for the net wind of each free cell: one for each cell it pushes, at most 3."""
    if level.wind is None:
        return
    south, east = shifts(level.wind, layout.columns, layout.rows)
    blocked = level.grid().blocked_cells
    commands: list[Command] = []
    for y in range(layout.rows):
        for x in range(layout.columns):
            if not blocked[y * layout.columns + x]:
                centre = layout.corner(x + 0.5, y + 0.5)
                if east[y]:
                    commands += _chevrons(centre, east[y], vertical=False)
                if south[x]:
                    commands += _chevrons(centre, south[x], vertical=True)
    if commands:
        yield Path(
            tuple(commands),
            stroke=level.colors_and_widths.colors.arrows,
            width=2.5,
            cap="round",
            opacity=0.4,
        )


def _chevrons(centre: Point, strength: int, *, vertical: bool) -> list[Command]:
    commands: list[Command] = []
    count, sign = min(abs(strength), _MAX_CHEVRONS), 1 if strength > 0 else -1
    for index in range(count):
        middle = sign * 11 * (index - (count - 1) / 2)
        points = [(middle - 3 * sign, -7.0), (middle + 3 * sign, 0.0), (middle - 3 * sign, 7.0)]
        commands += polyline(
            (
                centre[0] + (across if vertical else along),
                centre[1] + (along if vertical else across),
            )
            for along, across in points
        )
    return commands
