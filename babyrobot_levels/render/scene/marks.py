"""The marks of what cells do: holes, glints, warps and wind; and of what differs between levels."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from babyrobot_levels.language.fields import as_cells
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.render.colors import BLACK, GRAPHICS, WHITE, contrast, mixed, rim_on
from babyrobot_levels.render.scene.ground import CellGrounds
from babyrobot_levels.render.scene.icons import INK, RIM, Spot
from babyrobot_levels.render.scene.layout import CELL, Layout
from babyrobot_levels.render.scene.shapes import (
    QUARTER,
    Command,
    Commands,
    Ellipse,
    Path,
    Point,
    Rect,
    Scene,
    Shape,
    circle,
    cubic,
    curve,
    outline,
    polygon,
    polyline,
    rounded,
)
from babyrobot_levels.render.scene.slots import ICON, LABEL_MARGIN, Arrow, Box, Slots
from babyrobot_levels.render.situation import STRENGTHS, Effects

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
    yield from grain_shapes(level, layout, slots, effects)
    yield from sheen_shapes(effects.skids, layout, slots)
    yield from wind_shapes(effects.winds, slots, level.resolved_theme.colors.arrows)
    yield from warp_shapes(level, layout, slots, effects)
    yield from mark_shapes(level, slots, effects)


def mark_shapes(level: GridWorld, slots: Slots, effects: Effects) -> Iterator[Shape]:
    """Yield the marks of what cells do; those of one kind and size are painted as one.

    Signs stand in rings of warps, and where the ground has no room for its grain. There and beside
    wind and the path of a guard they are small.

    Args:
        level: the level.
        slots: where the marks are.
        effects: what the cells do.
    """
    beside = _beside(level, effects)
    grained = {*_grained(level, slots, effects)}
    placed: dict[tuple[Figure, float], list[Spot]] = {}
    for cell, figure, wide, strength in _marks(effects):
        if cell in grained and figure in (_plus, _minus):
            continue
        box = slots.icon(cell)
        (x, y), scale = box.centre, round(_SIZES[strength - 1] * box.width / wide, 3)
        if cell in slots.rings or cell in beside:
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
            yield cell, _TRAP if end.costs else _HOLE, 46.0, STRENGTHS
    for figure, cells in ((_plus, effects.pays), (_minus, effects.costs)):
        for cell, strength in cells.items():
            yield cell, figure, 32.0, strength


def _beside(level: GridWorld, effects: Effects) -> set[Cell]:
    """Return the cells with wind, or the path of a guard, beside which signs are small."""
    return {cell for mover in level.movers for cell in mover.path or ()}.union(effects.winds)


def _chest(spot: Spot) -> Iterator[Path]:
    """Yield a closed chest: wood with two bands and a lock of metal."""
    chest = outline("M-16 13 L-16 -5 C-16 -10 -13 -14 -8 -14 L8 -14 C13 -14 16 -10 16 -5 L16 13 Z")
    yield from spot.body(chest, _WOOD)
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


def _pit(spot: Spot, wall: str) -> Iterator[Path]:
    edge = circle(0, 0, 21, 14.5)
    yield spot.line(edge, RIM, 4.4)
    yield spot.fill(edge, INK)
    yield spot.fill(circle(0, 0, 18.6, 12), wall)
    yield spot.fill(circle(0, 2.6, 17, 9.2), _DEPTH)


_HOLE, _TRAP = partial(_pit, wall=_WALL), partial(_pit, wall=_COSTS)
"""A hole in the ground, and one that costs something."""

_BAR = polyline([(-6, 0), (6, 0)])


def _plus(spot: Spot) -> Iterator[Path]:
    return spot.wire((*_BAR, *polyline([(0, -6), (0, 6)])), _PAYS, 4.0)


def _minus(spot: Spot) -> Iterator[Path]:
    return spot.wire(_BAR, _COSTS, 4.0)


# -- what the ground pays and costs ---------------------------------------------------------------

_COST_INK, _PAY_INK = "#a3271f", "#12643f"
"""The colours of grains, where the ground is not too much like them."""

_GRAIN, _GRAIN_WIDTH = 3.0, 2.0
"""Half the length of a grain, and its width, in pixels."""

_MOST_GRAINED = 400
"""The most cells with several grains: in larger grounds they would be finer than a pixel."""

_EDGE = 3.0
"""The width of the edge by which costly ground lies lower, in pixels."""


def grain_shapes(
    level: GridWorld, layout: Layout, slots: Slots, effects: Effects
) -> Iterator[Shape]:
    """Yield the grain of ground that pays or costs: signs like sand, more of them for more.

    Ground that costs lies lower: its upper edge is in the shade.

    Args:
        level: the level.
        layout: where its cells are.
        slots: what else stands there.
        effects: what the cells do.
    """
    grained, grounds = _grained(level, slots, effects), CellGrounds(level)
    for cell, is_cost in grained.items():
        (x, y), (left, top) = cell, layout.corner(*cell)
        if is_cost and not grained.get((x, y - 1)):
            yield Rect(left, top, CELL, _EDGE, BLACK, opacity=0.3)
        if is_cost and not grained.get((x, y + 1)):
            yield Rect(left, top + CELL - _EDGE, CELL, _EDGE, WHITE, opacity=0.3)
    grains: dict[str, list[Command]] = {}
    for cell, is_cost in grained.items():
        ink = _grain_ink(grounds[cell], _COST_INK if is_cost else _PAY_INK)
        strength = (effects.costs if is_cost else effects.pays)[cell]
        count = strength + 1 if len(grained) <= _MOST_GRAINED else 1
        left, top = layout.corner(*cell)
        step, grain, texts = (
            CELL / count,
            grains.setdefault(ink, []),
            [*_texts(cell, layout, slots)],
        )
        for row in range(count):
            shift = 0.2 * step * (1 if row % 2 else -1) if count > 1 else 0.0
            for column in range(count):
                across, down = left + (column + 0.5) * step + shift, top + (row + 0.5) * step
                if any(_is_in((across, down), box) for box in texts):
                    continue
                grain += polyline([(across - _GRAIN, down), (across + _GRAIN, down)])
                if not is_cost:
                    grain += polyline([(across, down - _GRAIN), (across, down + _GRAIN)])
    for ink, commands in grains.items():
        yield Path(tuple(commands), stroke=ink, width=_GRAIN_WIDTH, cap="round")


def _texts(cell: Cell, layout: Layout, slots: Slots) -> Iterator[Box]:
    """Yield the boxes of texts in a cell, with room for a grain around them."""
    plan, corner = slots.plan(cell), layout.corner(*cell)
    own = [box.moved(*corner) for box in (plan.coordinates, plan.word) if box is not None]
    for box in (*own, *slots.near(cell)):
        yield Box(box.left - 5, box.top - 3, box.right + 5, box.bottom + 3)


def _grain_ink(ground: str, preferred: str) -> str:
    """Return the colour of grains: that of their kind, or a shade of the ground that is seen."""
    rim = rim_on([ground])
    shades = (mixed(rim, ground, share) for share in (0.5, 0.6, 0.7, 0.8))
    return next((ink for ink in (preferred, *shades) if contrast(ink, ground) >= GRAPHICS), rim)


def _grained(level: GridWorld, slots: Slots, effects: Effects) -> dict[Cell, bool]:
    """Return the cells whose ground shows that it pays or costs, and whether it costs."""
    if slots.shown.fills_cells:
        return {}
    others = slots.rings | _beside(level, effects) | {*effects.ends}
    told = {**dict.fromkeys(effects.pays, False), **dict.fromkeys(effects.costs, True)}
    return {cell: is_cost for cell, is_cost in told.items() if cell not in others}


# -- slippery cells ------------------------------------------------------------------------------

_GLINTS = ((20.0, 24.0, 28.0), (32.0, 31.0, 18.0), (42.0, 38.0, 12.0))
"""The glints of a slippery cell, one more for each strength: middle `(x, y)`, width and height."""

_SMALL_GLINTS = 0.45, 41.0, 4.0
"""How many times as large they are beside answers, and where they begin."""

_MANY = 10_000
"""The number of slippery or windy cells from which on each has a single sign: all are tiny."""

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

_MARK_WIDTH, _MARK_RIM = 4.0, 8.0


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
        begin = layout.corner(x + 1, y) if side == "E" else layout.corner(x, y + 1)
        commands += polyline([begin, layout.corner(x + 1, y + 1)])
    return commands


def _lines(commands: list[Command], *, dotted: bool = False) -> Iterator[Shape]:
    dash = (0.01, CELL / 6) if dotted else None
    if commands:
        for color, width in ((RIM, _MARK_RIM), (MARK, _MARK_WIDTH)):
            yield Path(tuple(commands), stroke=color, width=width, cap="round", dash=dash)


# -- warps and wind --------------------------------------------------------------------------------

_WIDTH = 3.0
_HEAD = 11.0
_RIM = 1.8
_RING = 9.0
_DOT_RING, _SIGN_RING = (10.5, _RING, 6.0, 3.0), (15.5, 13.5, 10.5)
"""The radii of the discs of a ring, from the bottom up: with a dot in it, and with a sign."""

_SHRINK = 0.7
"""How much rings and chevrons shrink with their boxes: 1 is in proportion."""

_WAYS = ((0.16, 0.0), (0.06, 0.0), (0.16, 48.0), (0.16, 96.0))
"""The ways of arrows, the best one first: how far they bow, as a share of their length, and from
how far beside their targets they arrive, in pixels; 0 leaves that to the bow."""

_AWAY = LABEL_MARGIN
"""How far arrows keep away from the border, as from labels, if they can, in pixels."""

_MOST_POINTS = 64
"""In how many points the ways of an arrow are compared, at most."""

_MAX_CHEVRONS = 3

Dash = tuple[float, float] | None


def warp_shapes(
    level: GridWorld, layout: Layout, slots: Slots, effects: Effects
) -> Iterator[Shape]:
    """Yield the warps: an arrow from a ring to a cell, or a turning one for the start.

    A warp that acts on entering is drawn solid, one that acts on leaving dashed. Arrows keep away
    from the labels of areas, and rings have room for the sign of what a warp pays or costs.

    Args:
        level: the level.
        layout: where its cells are.
        slots: where rings and heads of arrows are.
        effects: what its cells do.
    """
    color = level.resolved_theme.colors.arrows
    rim = rim_on([color])
    for warp in level.warps:
        box = slots.icon(warp.at)
        centre, size = box.centre, _scale(box)
        dash = (6.0, 4.0) if warp.when == "leave" else None
        if isinstance(warp.to, str):
            yield from _outlined(*_turning_arrow(centre, size), color, rim, dash)
            continue
        for to in as_cells(warp.to):
            if to != warp.at:
                yield from _outlined(*_arrow(level, layout, slots, warp.at, to), color, rim, dash)
        has_sign = warp.at in effects.pays or warp.at in effects.costs
        for number, radius in enumerate(_SIGN_RING if has_sign else _DOT_RING):
            fill = color if number % 2 else rim
            yield Ellipse(*centre, size * radius, size * radius, fill)


def _scale(box: Box) -> float:
    """Return the scale of a ring or chevrons: in small boxes they take more of the room."""
    return round(math.pow(box.width / ICON, _SHRINK), 3)


def _turning_arrow(centre: Point, size: float) -> tuple[Commands, Commands]:
    """Return shaft and head of an arrow that turns clockwise."""
    x, y = centre[0], centre[1] + 2 * size
    r, k, h = 11.0 * size, 11.0 * size * QUARTER, 6.0 * size
    shaft: Commands = (
        ("M", (x + r, y)),
        ("C", (x + r, y + k, x + k, y + r, x, y + r)),
        ("C", (x - k, y + r, x - r, y + k, x - r, y)),
        ("C", (x - r, y - k, x - k, y - r, x, y - r)),
    )
    return shaft, polygon([(x - 1, y - r - h), (x - 1, y - r + h), (x + 1.3 * h, y - r)])


def crossed_cells(level: GridWorld, layout: Layout, slots: Slots) -> set[Cell]:
    """Return the cells that the arrows of warps cross."""
    return {
        layout.cell(point)
        for warp in level.warps
        if not isinstance(warp.to, str)
        for to in as_cells(warp.to)
        if to != warp.at
        for point in _points(_arrow(level, layout, slots, warp.at, to)[0])
    }


def _arrow(level: GridWorld, layout: Layout, slots: Slots, at: Cell, to: Cell) -> Arrow:
    """Return shaft and head of a bowed arrow, in the grid and around labels if that is possible."""
    if (at, to) in slots.arrows:
        return slots.arrows[at, to]
    start, target = slots.icon(at).centre, slots.icon(to)
    end = target.centre
    gap = _RING * _scale(target) + 4 if to in slots.rings else 0.0
    edge, width, height = layout.margin + _AWAY, layout.grid_width, layout.grid_height
    grid = Box(edge, edge, edge + width - 2 * _AWAY, edge + height - 2 * _AWAY)

    def bad(parts: Arrow) -> int:
        """Return how many points of the shaft lie outside of the grid or on labels."""
        return sum(
            not _is_in(point, grid)
            or any(_is_in(point, box) for box in slots.near(layout.cell(point)))
            for point in _points(parts[0], _MOST_POINTS)
        )

    ways = (
        _bowed(start, end, gap, side * bow, side * reach)
        for bow, reach in _WAYS
        for side in (1, -1)
    )
    found = slots.arrows[at, to] = _least(ways, bad)
    return found


def _least(ways: Iterable[Arrow], bad: Callable[[Arrow], int]) -> Arrow:
    """Return the first way with nothing bad; else, the first one with the least."""
    least, best = math.inf, None
    for way in ways:
        count = bad(way)
        if count < least:
            least, best = count, way
        if not count:
            break
    assert best is not None
    return best


def _is_in(point: Point, box: Box) -> bool:
    return box.left < point[0] < box.right and box.top < point[1] < box.bottom


def _bowed(start: Point, end: Point, gap: float, bow: float, reach: float) -> Arrow:
    """Return shaft and head of an arrow; see `_WAYS`. Negative numbers are for its other side.

    Args:
        start: where it begins.
        end: where it points to.
        gap: the distance in pixels from its tip to `end`.
        bow: how far it bows.
        reach: from how far it arrives.
    """
    length = math.dist(start, end)
    along_x, along_y = (end[0] - start[0]) / length, (end[1] - start[1]) / length
    away = max(-CELL, min(bow * length, CELL))
    middle = ((start[0] + end[0]) / 2 + away * along_y, (start[1] + end[1]) / 2 - away * along_x)
    control = (end[0] + reach * along_y, end[1] - reach * along_x) if reach else middle
    distance = math.dist(control, end)
    toward_x, toward_y = (end[0] - control[0]) / distance, (end[1] - control[1]) / distance

    def behind(back: float, aside: float = 0.0) -> Point:
        """Return a point so many pixels behind the tip, and beside the arrow."""
        back += gap
        return (
            end[0] - back * toward_x - aside * toward_y,
            end[1] - back * toward_y + aside * toward_x,
        )

    neck = behind(0.8 * _HEAD)
    head = polygon([behind(0), behind(_HEAD, 0.5 * _HEAD), neck, behind(_HEAD, -0.5 * _HEAD)])
    if not reach:
        return curve(start, middle, neck), head
    return (("M", start), ("C", (*middle, *control, *neck))), head


def _points(shaft: Commands, most: int | None = None) -> Iterator[Point]:
    """Yield points along a shaft, less than half a cell apart, but not many more than `most`."""
    (_, (x, y)), (_, numbers) = shaft
    count = math.ceil(4 * math.dist((x, y), numbers[-2:]) / CELL)
    if most is not None:
        count = min(count, most)
    for step in range(count + 1):
        yield cubic((x, y), numbers, step / count)


def _outlined(shaft: Commands, head: Commands, color: str, rim: str, dash: Dash) -> Iterator[Shape]:
    """Yield an arrow with the rim that sets it off on puddles and areas."""
    yield Path(shaft, stroke=rim, width=_WIDTH + 2 * _RIM)
    yield Path(head, stroke=rim, width=2 * _RIM)
    yield Path(shaft, stroke=color, width=_WIDTH, dash=dash)
    yield Path(head, fill=color)


def wind_shapes(winds: Mapping[Cell, tuple[int, int]], slots: Slots, color: str) -> Iterator[Shape]:
    """Yield chevrons where the wind blows: one for each cell that it pushes, at most three.

    In large levels there is one in each cell.

    Args:
        winds: how far the wind pushes in each cell, east and south.
        slots: where the chevrons are.
        color: their colour.
    """
    most = _MAX_CHEVRONS if len(winds) < _MANY else 1
    by_size: dict[float, list[Command]] = {}
    for cell, (east, south) in winds.items():
        box = slots.icon(cell)
        commands = by_size.setdefault(_scale(box), [])
        commands += _chevrons(box.centre, _scale(box), east, south, most)
    for size, commands in by_size.items():
        lines, width = tuple(commands), 3.4 * size
        yield Path(lines, stroke=rim_on([color]), width=width + 2.6, cap="round")
        yield Path(lines, stroke=color, width=width, cap="round")


def _chevrons(centre: Point, size: float, east: int, south: int, most: int) -> Iterator[Command]:
    strength = math.hypot(east, south)
    along_x, along_y = size * east / strength, size * south / strength
    count = min(max(abs(east), abs(south)), most)
    for index in range(count):
        middle = 10 * (index - (count - 1) / 2)
        yield from polyline(
            (
                centre[0] + along * along_x - across * along_y,
                centre[1] + along * along_y + across * along_x,
            )
            for along, across in ((middle - 4.5, -11), (middle + 4.5, 0), (middle - 4.5, 11))
        )
