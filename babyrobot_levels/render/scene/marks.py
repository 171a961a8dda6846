"""The marks of what cells do, such as holes and glints, and of what differs between levels."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.render.effects import STRENGTHS, Effects
from babyrobot_levels.render.scene.arrows import warp_shapes, wind_shapes
from babyrobot_levels.render.scene.icons import INK, RIM, Spot
from babyrobot_levels.render.scene.layout import CELL, Layout
from babyrobot_levels.render.scene.shapes import (
    Command,
    Commands,
    Path,
    Scene,
    Shape,
    circle,
    polygon,
    polyline,
    rounded,
)
from babyrobot_levels.render.scene.slots import Slots

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

Figure = Callable[[Spot], Iterable[Path]]

_WOOD, _METAL = "#b8742f", "#ffd23f"
_PAYS, _COSTS = "#3ee08a", "#ff5d73"
_DEPTH, _WALL = "#0b0f16", "#5b7ea6"
"""The bottom of a hole, and the part of its wall that is seen."""

_SIZES = (0.75, 0.9, 1.0)
"""The sizes of marks by strength, as shares of the largest."""


def effect_shapes(
    level: GridWorld, layout: Layout, slots: Slots, effects: Effects
) -> Iterator[Shape]:
    """Yield what the cells of a level do: glints, wind, warps, and marks."""
    yield from sheen_shapes(effects.skids, layout, slots)
    yield from wind_shapes(effects.winds, slots, level.resolved_theme.colors.arrows)
    yield from warp_shapes(level, layout, slots, effects)
    yield from mark_shapes(level, slots, effects)


def mark_shapes(level: GridWorld, slots: Slots, effects: Effects) -> Iterator[Shape]:
    """Yield the marks of what cells do; those of one kind and size are painted as one.

    A sign is small in the ring of a warp, and beside wind and the path of a guard.

    Args:
        level: the level.
        slots: where the marks are.
        effects: what the cells do.
    """
    rings = {warp.at for warp in level.warps}
    beside = {cell for mover in level.movers for cell in mover.path or ()}.union(effects.winds)
    placed: dict[tuple[Figure, float], list[Spot]] = {}
    for cell, figure, wide, strength in _marks(effects):
        box = slots.icon(cell)
        (x, y), scale = box.centre, round(_SIZES[strength - 1] * box.width / wide, 3)
        if cell in rings or cell in beside:
            scale /= 2
        if cell in beside:
            x, y = x + 0.3 * box.width, y + 0.3 * box.height
        placed.setdefault((figure, scale), []).append(Spot(x, y, scale))
    for (figure, _), spots in placed.items():
        for alike in zip(*map(figure, spots), strict=True):
            commands = tuple(command for path in alike for command in path.commands)
            yield replace(alike[0], commands=commands)


def _marks(effects: Effects) -> Iterator[tuple[Cell, Figure, float, int]]:
    """Yield cells with their marks, the widths for which these are designed, and strengths."""
    for cell, end in effects.ends.items():
        if end.is_good:
            yield cell, _chest, 40.0, end.strength
        else:
            yield cell, _trap if end.costs else _hole, 46.0, STRENGTHS
    for figure, cells in ((_plus, effects.pays), (_minus, effects.costs)):
        for cell, strength in cells.items():
            yield cell, figure, 32.0, strength


def _chest(spot: Spot) -> Iterator[Path]:
    """Yield a closed chest: wood with two bands and a lock of metal."""
    outline: Commands = (
        ("M", (-16, 13)),
        ("L", (-16, -5)),
        ("C", (-16, -10, -13, -14, -8, -14)),
        ("L", (8, -14)),
        ("C", (13, -14, 16, -10, 16, -5)),
        ("L", (16, 13)),
        ("Z", ()),
    )
    yield from spot.body(outline, _WOOD)
    bands = [
        polygon([(side * 11.5, -13.2), (side * 7.5, -14), (side * 7.5, 13), (side * 11.5, 13)])
        for side in (-1, 1)
    ]
    yield spot.fill((*bands[0], *bands[1]), _METAL)
    yield spot.line(polyline([(-16, -2.5), (16, -2.5)]), INK, 2.2)
    lock = rounded(-4, -6, 8, 9, 1.5)
    yield spot.line(lock, INK, 3.0)
    yield spot.fill(lock, _METAL)
    yield spot.fill(circle(0, -1.6, 1.5), INK)


def _hole(spot: Spot) -> Iterator[Path]:
    """Yield a hole in the ground."""
    return _pit(spot, _WALL)


def _trap(spot: Spot) -> Iterator[Path]:
    """Yield a hole that costs something."""
    return _pit(spot, _COSTS)


def _pit(spot: Spot, wall: str) -> Iterator[Path]:
    edge = circle(0, 0, 21, 14.5)
    yield spot.line(edge, RIM, 4.4)
    yield spot.fill(edge, INK)
    yield spot.fill(circle(0, 0, 18.6, 12), wall)
    yield spot.fill(circle(0, 2.6, 17, 9.2), _DEPTH)


_BAR = polyline([(-6, 0), (6, 0)])


def _plus(spot: Spot) -> Iterator[Path]:
    return spot.wire((*_BAR, *polyline([(0, -6), (0, 6)])), _PAYS, 4.0)


def _minus(spot: Spot) -> Iterator[Path]:
    return spot.wire(_BAR, _COSTS, 4.0)


# -- slippery cells ------------------------------------------------------------------------------

_GLINTS = ((20.0, 24.0, 28.0), (32.0, 31.0, 18.0), (42.0, 38.0, 12.0))
"""The glints of a slippery cell, one more for each strength: middle `(x, y)`, width and height."""

_SMALL_GLINTS = 0.45, 41.0, 4.0
"""How many times as large they are beside answers, and where they begin."""

_MANY = 10_000
"""The number of slippery cells from which on each has a single glint: all are tiny."""

_GLINT_SHADE = "#2b5d8c"


def sheen_shapes(skids: Mapping[Cell, int], layout: Layout, slots: Slots) -> Iterator[Shape]:
    """Yield the glints of slippery cells; the shade below them is seen on light grounds.

    They give way to values of actions, which fill the cells.

    Args:
        skids: the slippery cells, with a strength from 1 to 3.
        layout: where the cells are.
        slots: what else stands there.
    """
    if slots.shown.actions:
        return
    most = STRENGTHS if len(skids) < _MANY else 1
    scale, right, down = _SMALL_GLINTS if slots.is_crowded else (1.0, 0.0, 0.0)
    for color, opacity, width, away in ((_GLINT_SHADE, 0.5, 2.0, 1.0), (RIM, 0.75, 2.4, 0.0)):
        commands: list[Command] = []
        for cell, strength in skids.items():
            left, top = layout.corner(*cell)
            for x, y, size in _GLINTS[: min(strength, most)]:
                middle_x, middle_y = left + right + scale * x + away, top + down + scale * y + away
                half = scale * size / 2
                commands += polyline(
                    [(middle_x - half, middle_y + half), (middle_x + half, middle_y - half)]
                )
        if commands:
            yield Path(tuple(commands), stroke=color, width=width, cap="round", opacity=opacity)


# -- what differs from another level ---------------------------------------------------------------

MARK = "#d6006c"
"""The colour of a mark of what differs: it, or its rim, stands out from any ground."""

_INSET = 6.0
"""How far the mark of a cell is from its sides, in pixels."""

_WIDTH, _RIM_WIDTH = 4.0, 8.0


class MarkedSide(NamedTuple):
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
    scene: Scene, layout: Layout, cells: Iterable[tuple[int, int]], sides: Sequence[MarkedSide]
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


def _bars(layout: Layout, sides: Iterable[MarkedSide]) -> list[Command]:
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
