"""Marks on cells and walls that differ from those of another level."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

from babyrobot_levels.render.scene.layout import CELL, Layout
from babyrobot_levels.render.scene.shapes import Command, Path, Scene, Shape, polyline, rounded

MARK, RIM = "#d6006c", "#ffffff"
"""The colour of a mark, and of its rim: one of the two stands out from any ground."""

_INSET = 6.0
"""How far the mark of a cell is from its sides, in pixels."""

_WIDTH, _RIM_WIDTH = 4.0, 8.0


class Side(NamedTuple):
    """A side of a cell.

    Attributes:
        cell: the cell, `(x, y)`.
        name: `E` or `S`.
        is_wall: whether there is a wall.
    """

    cell: tuple[int, int]
    name: str
    is_wall: bool


def marked(
    scene: Scene, layout: Layout, cells: Iterable[tuple[int, int]], sides: Sequence[Side]
) -> Scene:
    """Return a picture in which some cells and sides are marked.

    Args:
        scene: the picture.
        layout: its layout.
        cells: the cells, `(x, y)`.
        sides: the sides; those without a wall are dotted.
    """
    walls = _bars(layout, (side for side in sides if side.is_wall))
    others = _bars(layout, (side for side in sides if not side.is_wall))
    shapes = *_rings(layout, cells), *_lines(others, dotted=True), *_lines(walls)
    return replace(scene, shapes=(*scene.shapes, *shapes))


def _rings(layout: Layout, cells: Iterable[tuple[int, int]]) -> Iterator[Shape]:
    side = CELL - 2 * _INSET
    commands: list[Command] = []
    for x, y in cells:
        left, top = layout.corner(x, y)
        commands += rounded(left + _INSET, top + _INSET, side, side, 8.0)
    yield from _lines(commands)


def _bars(layout: Layout, sides: Iterable[Side]) -> list[Command]:
    commands: list[Command] = []
    for (x, y), side, _ in sides:
        end = layout.corner(x + 1, y + 1)
        begin = layout.corner(x + 1, y) if side == "E" else layout.corner(x, y + 1)
        commands += polyline([begin, end])
    return commands


def _lines(commands: list[Command], *, dotted: bool = False) -> Iterator[Shape]:
    dash = (0.01, CELL / 6) if dotted else None
    if commands:
        for color, width in ((RIM, _RIM_WIDTH), (MARK, _WIDTH)):
            yield Path(tuple(commands), stroke=color, width=width, cap="round", dash=dash)
