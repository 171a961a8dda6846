"""The ground of the cells: base, areas, blocked cells, grid lines, starts, exits, puddles."""

import math
from collections.abc import Callable, Iterable, Iterator
from operator import gt, or_

from babyrobot_levels.language.cells import Puddle
from babyrobot_levels.language.drawing import rectangles, runs
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.render.colors import BLACK, GRAPHICS, WHITE, contrast, ink_on, mixed, rim_on
from babyrobot_levels.render.scene.layout import CELL, Layout
from babyrobot_levels.render.scene.shapes import (
    Command,
    Commands,
    Ellipse,
    Path,
    Point,
    Rect,
    Shape,
    circle,
    curve,
    outline,
    placed,
    polyline,
    rectangle,
    smooth,
)
from babyrobot_levels.render.scene.slots import ICON, Slots


class CellGrounds:
    """The ground of the cells, as it is painted: base, areas, blocked cells, starts and exits.

    Args:
        level: the level.

    Attributes:
        base: the colour of the base, `#rrggbb`.
        own: the colours of the cells whose ground is another one.
    """

    def __init__(self, level: GridWorld) -> None:
        colors = level.resolved_theme.colors
        self.base = mixed(colors.base, WHITE)
        self.own: dict[Cell, str] = {}
        for area in level.areas:
            if area.color is not None:
                (left, top), (width, height) = area.at, area.size
                if area.size == level.size:
                    # It is the ground of the whole level.
                    self._lay(area.color, [*self.own])
                    self.base = mixed(area.color, self.base)
                    continue
                cells = ((left + x, top + y) for y in range(height) for x in range(width))
                self._lay(area.color, cells)
        width = level.size[0]
        blocked = (number for number, flag in enumerate(level.grid().blocked_cells) if flag)
        self._lay(colors.blocked, ((number % width, number // width) for number in blocked))
        self._lay(colors.start, level.starts)
        # A drawn exit is a tile that does not reach the edges of its cell.
        self._lay(colors.exit, level.exits if level.exit_one_of is None else ())
        self.own = {cell: color for cell, color in self.own.items() if color != self.base}

    def __getitem__(self, cell: Cell) -> str:
        return self.own.get(cell, self.base)

    def _lay(self, color: str, cells: Iterable[Cell]) -> None:
        for cell in cells:
            self.own[cell] = mixed(color, self[cell])


_DASH = 4.0
_LINE_WIDTH = 1.0
_EDGE = 3.0
"""How far blocked cells seem to rise above the ground, in pixels."""


def ground_shapes(level: GridWorld, layout: Layout) -> Iterator[Shape]:
    """Yield the ground, from the bottom up."""
    colors = level.resolved_theme.colors
    blocked, grounds = level.grid().blocked_cells, CellGrounds(level)
    yield Rect(layout.margin, layout.margin, layout.grid_width, layout.grid_height, colors.base)
    for area in level.areas:
        if area.color is not None:
            yield _cells(layout, area.at, area.size, area.color)
    yield from _blocked(layout, blocked, colors.blocked)
    for cell in level.starts:
        yield _cells(layout, cell, (1, 1), colors.start)
        yield from pad_shapes(layout, cell, ink_on([grounds[cell]], colors.start_text))
    # A drawn exit is another one in each episode.
    for cell in level.exits if level.exit_one_of is None else ():
        yield _cells(layout, cell, (1, 1), colors.exit)
        yield from flag_shapes(layout, cell, ink_on([grounds[cell]], colors.exit_text))


def line_shapes(level: GridWorld, layout: Layout) -> Iterator[Shape]:
    """Yield the lines between the cells."""
    blocked, color = level.grid().blocked_cells, level.resolved_theme.colors.lines
    if lines := tuple(_line_commands(layout, blocked)):
        yield Path(lines, stroke=color, width=_LINE_WIDTH, dash=(_DASH, _DASH))


def _cells(layout: Layout, at: tuple[int, int], size: tuple[int, int], fill: str) -> Rect:
    return Rect(*layout.corner(*at), size[0] * CELL, size[1] * CELL, fill)


def pad_shapes(layout: Layout, cell: tuple[int, int], color: str) -> Iterator[Shape]:
    """Yield the pin of a start that the robot does not stand on."""
    x, y = layout.corner(cell[0] + 0.5, cell[1] + 0.5)
    pin = outline("M0 13 C-3 6 -11 3 -11 -6 C-11 -21 11 -21 11 -6 C11 3 3 6 0 13 Z")
    yield Path(placed(pin, x, y, 1.0), stroke=color, width=2.8)
    yield Path(circle(x, y - 6, 3.6), fill=color)


def flag_shapes(layout: Layout, cell: tuple[int, int], color: str) -> Iterator[Shape]:
    """Yield the flag that marks an exit."""
    x, y = layout.corner(cell[0] + 0.5, cell[1] + 0.5)
    yield Ellipse(x - 8, y + 13, 9, 2.4, BLACK, 0.25)
    yield Path(polyline([(x - 8, y - 22), (x - 8, y + 13)]), stroke=color, width=3, cap="round")
    cloth: Commands = (
        ("M", (x - 7, y - 21)),
        ("C", (x - 1, y - 25, x + 5, y - 16, x + 13, y - 19)),
        ("L", (x + 13, y - 4)),
        ("C", (x + 5, y - 1, x - 1, y - 10, x - 7, y - 6)),
        ("Z", ()),
    )
    yield Path(cloth, fill=color)


def _blocked(layout: Layout, blocked: bytes, fill: str) -> Iterator[Shape]:
    """Yield the blocked cells as blocks that rise a little above the ground."""
    columns = layout.columns
    blocks = [
        _cells(layout, (x, y), (width, height), fill)
        for x, y, width, height in rectangles(blocked, columns)
    ]
    if len(blocks) > 1:
        # As one shape: where two meet within a pixel, the ground would shine through.
        outlines = (
            rectangle(each.x, each.y, each.x + each.width, each.y + each.height) for each in blocks
        )
        yield Path(tuple(step for outline in outlines for step in outline), fill=fill)
    else:
        yield from blocks
    for y in range(layout.rows):
        row = blocked[y * columns : (y + 1) * columns]
        above = blocked[(y - 1) * columns : y * columns] if y else b"\1" * columns
        below = blocked[(y + 1) * columns : (y + 2) * columns] or b"\1" * columns
        for x, length in runs(map(gt, row, above), True):
            left, top = layout.corner(x, y)
            yield Rect(left, top, length * CELL, _EDGE, WHITE, opacity=0.22)
        for x, length in runs(map(gt, row, below), True):
            left, bottom = layout.corner(x, y + 1)
            yield Rect(left, bottom - _EDGE, length * CELL, _EDGE, BLACK, opacity=0.3)


def _line_commands(layout: Layout, blocked: bytes) -> Iterator[Command]:
    """Yield the lines between free cells, inset so that their dashes meet evenly at corners."""
    inset = _DASH / 2 / CELL
    columns, rows = layout.columns, layout.rows
    for y in range(1, rows):
        above = blocked[(y - 1) * columns : y * columns]
        for x, length in runs(map(or_, above, blocked[y * columns : (y + 1) * columns]), 0):
            yield from _line(layout, (x + inset, y), (x + length - inset, y))
    for x in range(1, columns):
        left, right = blocked[x - 1 :: columns], blocked[x::columns]
        for y, length in runs(map(or_, left, right), 0):
            yield from _line(layout, (x, y + inset), (x, y + length - inset))


def _line(layout: Layout, start: tuple[float, float], end: tuple[float, float]) -> Commands:
    return polyline([layout.corner(*start), layout.corner(*end)])


_POINTS = 12
_FLATTEN = 0.84
_RADIUS = {"small": 14.0, "large": 23.5}
_AS_ICON = 0.8
"""How many times as large they are in proportion where they are icons: none leaves its cell."""
_HALF_HEIGHT = {"small": 18.0, "large": 24.0}
"""How far puddles reach up and down, at most, but for drops."""
_WAVES = ((1, 0.06), (2, 0.11), (3, 0.09), (4, 0.03))
"""The waves of the outline: how many in one turn, and their height as a share of the radius."""
_SHORE_WIDTH = 1.5


def puddle_shapes(level: GridWorld, layout: Layout, slots: Slots) -> Iterator[Shape]:
    """Yield the puddles: water, a lighter middle, a highlight, and drops beside small ones.

    Args:
        level: the level.
        layout: where its cells are.
        slots: what else stands in them: puddles make room for numbers.
    """
    fill, grounds = level.resolved_theme.colors.puddle, CellGrounds(level)
    for puddle in level.puddles:
        x, y = puddle.at
        centre_x, centre_y, radius = _puddle_place(layout, slots, puddle)
        outline = _puddle_outline(x, y, radius)
        if puddle.size == "small":
            yield from _drops(x, y, centre_x, centre_y, radius, fill)
        shore, strength = BLACK, 0.22
        if contrast(fill, ground := grounds[puddle.at]) < GRAPHICS:
            shore, strength = rim_on([ground, fill]), 1.0
        for scale, colour, opacity in (
            (1.06, shore, strength),
            (1.0, fill, 1.0),
            (0.74, WHITE, 0.16),
        ):
            points = [(centre_x + scale * dx, centre_y + scale * dy) for dx, dy in outline]
            yield Path(smooth(points), fill=colour, opacity=opacity)
        yield _highlight(centre_x, centre_y, radius)
        yield Ellipse(
            centre_x + 0.36 * radius,
            centre_y + 0.3 * radius,
            0.09 * radius,
            0.07 * radius,
            WHITE,
            0.7,
        )


def _puddle_place(layout: Layout, slots: Slots, puddle: Puddle) -> tuple[float, float, float]:
    """Return the centre and the radius of a puddle: an icon beside arrows."""
    x, y = layout.corner(*puddle.at)
    radius = _RADIUS[puddle.size]
    if slots.is_crowded:
        box = slots.icon(puddle.at)
        return *box.centre, _AS_ICON * radius * box.width / ICON
    if not slots.shown.fills_cells:
        return x + CELL / 2, y + CELL / 2, radius
    free = slots.plan(puddle.at).free
    scale = min(1.0, free.height / (2 * _HALF_HEIGHT[puddle.size]))
    return x + CELL / 2, y + free.centre[1], scale * radius


def shore_shapes(
    level: GridWorld, layout: Layout, slots: Slots, grounds: Callable[[Cell], Iterable[str]]
) -> Iterator[Shape]:
    """Yield what sets puddles off from other grounds than the level's own, such as a heat map.

    Args:
        level: the level.
        layout: where its cells are.
        slots: what else stands in them.
        grounds: returns the colours of the ground in a cell.
    """
    fill = level.resolved_theme.colors.puddle
    for puddle in level.puddles:
        if faint := [each for each in grounds(puddle.at) if contrast(fill, each) < GRAPHICS]:
            x, y, radius = _puddle_place(layout, slots, puddle)
            outline = _puddle_outline(*puddle.at, 1.06 * radius + _SHORE_WIDTH)
            rim = rim_on([*faint, fill])
            yield Path(smooth([(x + dx, y + dy) for dx, dy in outline]), fill=rim)
            if puddle.size == "small":
                yield from _drops(*puddle.at, x, y, radius, rim, _SHORE_WIDTH)


def _puddle_outline(x: int, y: int, radius: float) -> list[Point]:
    """Return points around (0, 0): a wavy circle, flattened a little."""
    phases = [2 * math.pi * _noise(x, y, waves) for waves, _ in _WAVES]
    points = []
    for index in range(_POINTS):
        angle = 2 * math.pi * index / _POINTS
        reach = radius * (
            1
            + sum(
                share * math.cos(waves * angle + phase)
                for (waves, share), phase in zip(_WAVES, phases, strict=True)
            )
        )
        points.append((reach * math.cos(angle), _FLATTEN * reach * math.sin(angle)))
    return points


def _drops(
    x: int, y: int, centre_x: float, centre_y: float, radius: float, fill: str, more: float = 0.0
) -> Iterator[Shape]:
    angle = 2 * math.pi * _noise(x, y, 200)
    scale = radius / _RADIUS["small"]
    for turn, size, distance in ((0.0, 3.4 * scale, 1.55), (0.75, 2.2 * scale, 1.5)):
        drop_x = centre_x + distance * radius * math.cos(angle + turn)
        drop_y = centre_y + _FLATTEN * distance * radius * math.sin(angle + turn)
        yield Ellipse(drop_x, drop_y, size + more, _FLATTEN * size + more, fill)


def _highlight(centre_x: float, centre_y: float, radius: float) -> Path:
    start = (centre_x - 0.56 * radius, centre_y + 0.02 * radius)
    end = (centre_x - 0.02 * radius, centre_y - 0.47 * radius)
    control = (centre_x - 0.5 * radius, centre_y - 0.42 * radius)
    return Path(
        curve(start, control, end), stroke=WHITE, width=0.1 * radius, cap="round", opacity=0.75
    )


def _noise(x: int, y: int, salt: int) -> float:
    """Return a pseudo-random number in 0..1 that depends on the arguments only."""
    mixed = (x * 0x9E3779B1 ^ y * 0x85EBCA77 ^ salt * 0xC2B2AE3D) & 0xFFFFFFFF
    for factor in (0x7FEB352D, 0x846CA68B):
        mixed = ((mixed ^ mixed >> 15) * factor) & 0xFFFFFFFF
    return (mixed ^ mixed >> 16) / 2**32
