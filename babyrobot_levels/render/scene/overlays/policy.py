"""Arrows to where the best actions lead."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Sequence

from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.render.scene.layout import CELL, Layout
from babyrobot_levels.render.scene.overlays.rooms import Cell, Rooms
from babyrobot_levels.render.scene.shapes import (
    Command,
    Path,
    Point,
    Shape,
    circle,
    polygon,
    polyline,
)

SHORTEST = 8.0
"""The shortest arrow, from the middle to its tip; there are none longer amid numbers."""

_LONGEST = 18.0

_WIDTH = 3.2
_RING = 0.25
"""The radius of the ring that means stay, as a share of how far arrows reach."""
_RIM = "#ffffff"
_SHADE = "#000000"

TOWARDS = {
    Action.NORTH: (0, -1),
    Action.EAST: (1, 0),
    Action.SOUTH: (0, 1),
    Action.WEST: (-1, 0),
}


def arrow_shapes(
    cells: Iterable[tuple[Cell, Sequence[int]]],
    rooms: Rooms,
    layout: Layout,
    color: str,
    crowded: Container[Cell],
) -> Iterator[Shape]:
    """Yield all arrows at once, rimmed like stickers: they can be seen on every ground.

    Args:
        cells: the actions of each cell.
        rooms: what is free of the cells.
        layout: where the cells are.
        color: the colour of the arrows.
        crowded: the cells with numbers all around.
    """
    shafts: list[Command] = []
    heads: list[Command] = []
    for (x, y), actions in cells:
        top, foot = rooms[x, y]
        left, upper = layout.corner(x, y)
        longest = SHORTEST if (x, y) in crowded else _LONGEST
        reach = min(max((foot - top) / 2, SHORTEST), longest)
        # Where the room is too small for any arrow, it gives way at the top.
        middle = left + CELL / 2, upper + min((top + foot) / 2, foot - reach)
        start = 0.0
        if Action.STAY in actions:
            start = _RING * reach
            shafts += circle(*middle, start)
        for action in actions:
            if action != Action.STAY:
                shaft, head = _arrow(middle, TOWARDS[Action(action)], start, reach)
                shafts += shaft
                heads += head
    lines, tips = tuple(shafts), tuple(heads)
    for ink, rim, opacity in ((_SHADE, 3.2, 0.3), (_RIM, 2.0, 1.0)):
        if lines:
            yield Path(lines, stroke=ink, width=_WIDTH + 2 * rim, cap="round", opacity=opacity)
        if tips:
            yield Path(tips, stroke=ink, width=2 * rim, opacity=opacity)
    if lines:
        yield Path(lines, stroke=color, width=_WIDTH, cap="round")
    if tips:
        yield Path(tips, fill=color)


def _arrow(
    start: Point, towards: tuple[int, int], gap: float, reach: float
) -> tuple[tuple[Command, ...], tuple[Command, ...]]:
    """Return shaft and head of an arrow that begins and ends so far from `start`."""
    length = 0.5 * reach

    def at(along: float, across: float) -> Point:
        return (
            start[0] + along * towards[0] - across * towards[1],
            start[1] + along * towards[1] + across * towards[0],
        )

    neck = reach - length
    half = 0.6 * length
    shaft = polyline([at(min(gap, neck), 0), at(neck, 0)])
    return shaft, polygon([at(reach, 0), at(neck, half), at(neck, -half)])
