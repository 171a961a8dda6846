"""Things as they are drawn: pieces that change as one, each with the value that it shows."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from babyrobot_levels.language.cells import sides_of
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.language.things import Door, Switch, Target
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.render.colors import GRAPHICS, WHITE, ink_on, mixed, plate_for, rim_on
from babyrobot_levels.render.scene.ground import CellGrounds, flag_shapes
from babyrobot_levels.render.scene.icons import (
    INK,
    Spot,
    crate_shapes,
    default_color,
    figure_shapes,
    item_shapes,
    padlock_shapes,
    thing_color,
)
from babyrobot_levels.render.scene.layout import CELL, CHARACTER_WIDTH, Layout, fit
from babyrobot_levels.render.scene.shapes import (
    Commands,
    Ellipse,
    Path,
    Point,
    Rect,
    Shape,
    Text,
    circle,
    polyline,
    rounded,
)
from babyrobot_levels.render.scene.slots import ICON, Box, Slots
from babyrobot_levels.render.scene.team import teammate_shapes
from babyrobot_levels.render.scene.texts import end_text, label_shapes
from babyrobot_levels.render.situation import Situation

_TILE = 5.5
"""The distance of a drawn exit from the edges of its cell, in pixels."""


@dataclass(frozen=True, slots=True)
class Piece:
    """A part of the picture that changes as one.

    Attributes:
        name: what it is and what it shows: the same name gives the same shapes in all pictures of
            one layout of a level.
        box: left, top, right and bottom of the rectangle that contains its shapes, in pixels.
        draw: returns its shapes.
    """

    name: tuple[Any, ...]
    box: Box
    draw: Callable[[], Iterable[Shape]]

    @property
    def shapes(self) -> tuple[Shape, ...]:
        """Its shapes, in painting order."""
        return tuple(self.draw())


def pieces(
    level: GridWorld, layout: Layout, situation: Situation, slots: Slots | None = None
) -> Iterator[Piece]:
    """Yield everything but movers that may differ between configurations, from the bottom up.

    A door that is open, and a square for what is not held, are pieces as well; an item that does
    not lie anywhere is none.

    Args:
        level: the level.
        layout: where its cells are.
        situation: what is where.
        slots: what stands where in the cells, if they show answers.
    """
    if not level.has_things:
        return
    if situation.is_overview:
        whole = Box(0.0, 0.0, layout.width, layout.height)
        yield Piece(("tracks",), whole, partial(_tracks, level, layout, slots))
    yield from _exits(level, layout, situation)
    things = level.things()
    for number, (column, is_on) in enumerate(zip(things.fixed, situation.on, strict=True)):
        thing = things[column]
        paint = _target if thing.kind == "target" else _fixed
        draw = partial(paint, level, layout, thing.entry, is_on)
        yield Piece((thing.kind, number, is_on), _cell_box(layout, thing.entry.at), draw)
    for number, cells in enumerate(situation.items):
        for cell in cells:
            faint = len(cells) > 1
            draw = partial(_item, level, layout, number, cell, faint, slots)
            yield Piece(("item", number, cell, faint), _cell_box(layout, cell), draw)
    targets = {target.at: target for target in level.targets}
    for cell in situation.boxes:
        draw = partial(_crate, level, layout, cell, targets.get(cell), slots)
        yield Piece(("box", cell), _cell_box(layout, cell), draw)
    for number, closed in enumerate(situation.doors):
        door = level.doors[number]
        for x, y in sides_of(door):
            dx, dy = _SIDE_CENTRES[door.side]
            centre, is_upright = layout.corner(x + dx, y + dy), door.side in ("E", "W")
            draw = partial(_door, level, door, centre, is_upright, closed)
            reach = max(36.0, (door.width or 0.0) / 2 + 8)
            box = Box(-reach, -reach, reach, reach).moved(*centre)
            yield Piece(("door", number, (x, y), closed), box, draw)
    yield from held_pieces(level, layout, situation)


def _tracks(level: GridWorld, layout: Layout, slots: Slots | None) -> Iterator[Shape]:
    """Yield the tracks of movers, and the labels of areas over them."""
    yield from track_shapes(level, layout)
    if level.movers and slots is not None:
        yield from label_shapes(level, slots)


def _cell_box(layout: Layout, cell: Cell) -> Box:
    return Box(*layout.corner(*cell), *layout.corner(cell[0] + 1, cell[1] + 1))


def _centre(layout: Layout, cell: Cell) -> Point:
    return layout.corner(cell[0] + 0.5, cell[1] + 0.5)


# -- items ---------------------------------------------------------------------------------------


def _item(
    level: GridWorld, layout: Layout, number: int, cell: Cell, faint: bool, slots: Slots | None
) -> Iterator[Shape]:
    item, colors = level.items[number], level.resolved_theme.colors
    color = thing_color(item, colors)
    ground = colors.base if faint else None
    if slots is not None and slots.is_crowded:
        box = slots.icon(cell)
        yield from item_shapes(item.picture, color, Spot(*box.centre, box.width / ICON, ground))
        return
    x, y = _centre(layout, cell)
    # A label needs room below.
    y -= 5 if item.label else 0
    yield from item_shapes(item.picture, color, Spot(x, y, 1.0, ground))
    if faint:
        yield from _question_mark(x + 14, y + 13)
    yield from thing_label(level, layout, cell, item.label)


def _question_mark(x: float, y: float) -> Iterator[Shape]:
    """Yield the mark of one of several places."""
    yield Ellipse(x, y, 8.5, 8.5, WHITE)
    yield Ellipse(x, y, 7.3, 7.3, INK)
    yield Text(x, y + 4.1, "?", 11.5, WHITE, bold=True)


def thing_label(level: GridWorld, layout: Layout, cell: Cell, label: str | None) -> Iterator[Shape]:
    """Yield the label of a thing at the foot of its cell."""
    line = " ".join((label or "").split())
    if not line:
        return
    colors = level.resolved_theme.colors
    size, text = fit(line, CELL - 10)
    width, height = len(text) * size * CHARACTER_WIDTH + 0.8 * size, 1.3 * size
    centre, foot = layout.corner(cell[0] + 0.5, cell[1] + 1)
    plate = plate_for(colors.text_fg, colors.text_bg)
    yield Rect(centre - width / 2, foot - height - 2, width, height, plate, height / 2)
    yield Text(centre, foot - 2 - 0.32 * size, text, size, colors.text_fg)


# -- what is off or on -----------------------------------------------------------------------------


def _fixed(level: GridWorld, layout: Layout, entry: Switch, is_on: bool) -> Iterator[Shape]:
    """Yield a plate in the floor: an empty frame with a ring while off, filled while on.

    It is larger than the robot, which may stand on it.
    """
    spot = Spot(*_centre(layout, entry.at))
    color = thing_color(entry, level.resolved_theme.colors)
    plate = rounded(-22.5, -22.5, 45, 45, 9)
    if is_on:
        yield from spot.body(plate, color)
        yield spot.fill(rounded(-16.5, -16.5, 33, 33, 5), WHITE, 0.35)
        yield spot.line(polyline([(0, -8), (0, 8)]), INK, 6.0)
    else:
        yield from spot.wire(plate, color, 3.0)
        for ink, width in ((INK, 5.6), (color, 3.0)):
            yield spot.line(circle(0, 0, 7.5), ink, width)
    yield from thing_label(level, layout, entry.at, entry.label)


# -- boxes ---------------------------------------------------------------------------------------


def _target(level: GridWorld, layout: Layout, entry: Target, is_on: bool) -> Iterator[Shape]:
    """Yield the mark of a target on the floor; while it is covered, the box shows it."""
    spot = Spot(*_centre(layout, entry.at))
    color = thing_color(entry, level.resolved_theme.colors)
    for side in (1, -1):
        for end in (1, -1):
            corner = polyline([(20 * side, 11 * end), (20 * side, 20 * end), (11 * side, 20 * end)])
            yield spot.line(corner, INK, 6.6)
            yield spot.line(corner, color, 4.0)
    yield from spot.body(circle(0, 0, 6), color)
    yield from thing_label(level, layout, entry.at, entry.label)


def _crate(
    level: GridWorld, layout: Layout, cell: Cell, target: Target | None, slots: Slots | None
) -> Iterator[Shape]:
    """Yield a box, with a frame in the colour of the target that it covers."""
    colors = level.resolved_theme.colors
    covers = None if target is None else thing_color(target, colors)
    spot = Spot(*_centre(layout, cell))
    if slots is not None and slots.is_crowded:
        box = slots.icon(cell)
        spot = Spot(*box.centre, box.width / ICON * 0.8)
    yield from crate_shapes(default_color("box", colors), spot, covers)


# -- doors ---------------------------------------------------------------------------------------

_LEAF = 13.0
"""The thickness of a door without a width of its own."""


_SIDE_CENTRES = {"N": (0.5, 0.0), "E": (1.0, 0.5), "S": (0.5, 1.0), "W": (0.0, 0.5)}
"""The middle of each side of a cell."""


def door_color(level: GridWorld, door: Door) -> str:
    """Return the colour of a door: its own, that of the item it needs first, or that of wood."""
    colors = level.resolved_theme.colors
    if door.color is not None:
        return door.color
    named = {item.name: item for item in level.items}
    for name in door.keys:
        if name in named:
            return thing_color(named[name], colors)
    return default_color("door", colors)


def _door(
    level: GridWorld, door: Door, centre: Point, is_upright: bool, closed: bool
) -> Iterator[Shape]:
    """Yield the posts of a door, and its leaf between them, or what is seen of it while open."""
    spot, color = Spot(*centre), door_color(level, door)
    thick = _LEAF if door.width is None else max(1.0, door.width)

    def bar(first: float, last: float, thickness: float, radius: float) -> Commands:
        half = thickness / 2
        if is_upright:
            return rounded(-half, first, thickness, last - first, radius)
        return rounded(first, -half, last - first, thickness, radius)

    def at(along: float, across: float) -> Point:
        return (across, along) if is_upright else (along, across)

    if closed:
        yield from spot.body(bar(-24, 24, thick, 2), color)
        for along in (-12.5, 12.5):
            yield spot.line(polyline([at(along, -thick / 2), at(along, thick / 2)]), INK, 1.8, 0.7)
        if not {item.name for item in level.items}.isdisjoint(door.keys):
            yield spot.fill(circle(0, 0, 5.2), INK)
            yield spot.fill(circle(0, 0, 2.0), WHITE)
    else:
        for first, last in ((-25, -17), (17, 25)):
            yield from spot.body(bar(first, last, thick, 2), color)
    post = mixed(color, INK, 0.35)
    for along in (-28, 28):
        yield from spot.body(bar(along - 3.5, along + 3.5, thick + 3, 2), post)


# -- exits ---------------------------------------------------------------------------------------


def _exits(level: GridWorld, layout: Layout, situation: Situation) -> Iterator[Piece]:
    is_drawn = level.exit_one_of is not None
    if not (is_drawn or situation.is_locked):
        return
    faint = situation.is_overview and is_drawn
    for cell in situation.exits:
        box = _cell_box(layout, cell)
        if is_drawn:
            draw = partial(_drawn_exit, level, layout, cell, faint)
            yield Piece(("exit", cell, faint), box, draw)
        if situation.is_locked:
            yield Piece(("lock", cell), box, partial(_lock, level, layout, cell))
        if faint:
            x, y = _centre(layout, cell)
            yield Piece(("perhaps", cell), box, partial(_question_mark, x + 14, y + 13))


def _drawn_exit(level: GridWorld, layout: Layout, cell: Cell, faint: bool) -> Iterator[Shape]:
    """Yield the exit of one episode: a tile above the ground; faintly where it is only possible."""
    colors, (left, top) = level.resolved_theme.colors, layout.corner(*cell)
    ground = mixed(colors.exit, colors.base, 0.5) if faint else colors.exit
    side = CELL - 2 * _TILE
    if faint:
        outline = rounded(left + _TILE + 1, top + _TILE + 1, side - 2, side - 2, 5.0)
        rim = ink_on([CellGrounds(level)[cell]], colors.exit, GRAPHICS)
        yield Path(outline, fill=ground, stroke=rim, width=2.0)
    else:
        yield Rect(left + _TILE, top + _TILE, side, side, ground, radius=6.0)
    ink = ink_on([ground], colors.exit_text)
    yield from flag_shapes(layout, cell, ink)
    if level.display.exit_text:
        word = end_text("EXIT", layout, cell, ink)
        yield replace(word, y=word.y - _TILE + 2)


def _lock(level: GridWorld, layout: Layout, cell: Cell) -> Iterator[Shape]:
    """Yield the hatch that covers the flag of an exit whose needs are not met."""
    colors, (x, y) = level.resolved_theme.colors, _centre(layout, cell)
    yield from Spot(x, y - 5).body(rounded(-20, -20, 40, 38, 6), mixed(colors.exit, INK, 0.3))
    yield from padlock_shapes(default_color("key", colors), Spot(x, y - 5, 0.9))


# -- what is held --------------------------------------------------------------------------------

_SQUARE = 50.0
"""The side of a square for something held at which its picture is as large as on the grid."""

_NOT_HELD = 0.28
"""How strong what is not held looks."""


def held_pieces(level: GridWorld, layout: Layout, situation: Situation) -> Iterator[Piece]:
    """Yield the squares for what is held; what is not held is seen faintly in its own."""
    slots = layout.slots
    if slots is None:
        return
    colors = level.resolved_theme.colors
    for number, (item, cells) in enumerate(zip(level.items, situation.items, strict=True)):
        x, y = slots.centre(number)
        half = slots.side / 2
        color = thing_color(item, colors)
        spot = Spot(x, y, slots.side / _SQUARE, colors.text_bg if cells else None, _NOT_HELD)
        box = Box(x - half, y - half, x + half, y + half)
        draw = partial(item_shapes, item.picture, color, spot)
        yield Piece(("held", number, not cells), box, draw)


# -- movers --------------------------------------------------------------------------------------

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

    Robots but the first come after movers, and are drawn in the same way.

    Args:
        level: the level.
        layout: where its cells are.
        situation: what is where.
        robot: the robot's cell, None without it.
        crowded: whether cells show something else, beside which all movers are.
    """
    places = situation.figures
    things = level.things()
    lying = situation.lying | {things[column].entry.at for column in things.fixed}
    spots = []
    for number, cell in enumerate(places):
        centre = _centre(layout, cell)
        mate = number - len(situation.movers) + 1
        home = mate > 0 and situation.arrived[mate]
        alone = cell != robot and cell not in lying and places.count(cell) == 1
        if not crowded and not home and alone:
            spots.append(Spot(*centre))
            continue
        dx, dy = CORNERS[places[:number].count(cell) % len(CORNERS)]
        spots.append(Spot(centre[0] + dx * CELL, centre[1] + dy * CELL, SMALL))
    return tuple(spots)


def mover_shapes(
    level: GridWorld, number: int, spot: Spot, look: Cell = (0, 0), arrived: Sequence[bool] = ()
) -> Iterator[Shape]:
    """Yield the figure of a mover, by its number among the level's.

    Args:
        level: the level.
        number: the number of the mover; those of robots but the first come after them.
        spot: where it is drawn.
        look: where it looks, `(dx, dy)`.
        arrived: for each of several robots, whether it has arrived.
    """
    if (mate := number - len(level.movers) + 1) > 0:
        yield from teammate_shapes(level, mate, spot, arrived=arrived[mate])
        return
    mover = level.movers[number]
    color = thing_color(mover, level.resolved_theme.colors)
    yield from figure_shapes(mover.picture, color, spot, look)


def moving_pieces(
    level: GridWorld,
    layout: Layout,
    situation: Situation,
    robot: Cell | None,
    *,
    crowded: bool = False,
) -> Iterator[tuple[Cell, Piece]]:
    """Yield the movers, in front of the robot, each with its cell.

    Args:
        level: the level.
        layout: where its cells are.
        situation: what is where.
        robot: the robot's cell, None without it. Who shares a cell is drawn smaller, in a corner.
        crowded: whether cells show something else, such as arrows, beside which all movers are.
    """
    spots = mover_spots(level, layout, situation, robot, crowded=crowded)
    for number, (cell, spot) in enumerate(zip(situation.figures, spots, strict=True)):
        if number >= len(level.movers):
            mate = number - len(level.movers) + 1
            home = situation.arrived[mate]
            shapes = partial(teammate_shapes, level, mate, spot, arrived=home)
            yield cell, Piece(("robot", mate, cell, spot, home), _cell_box(layout, cell), shapes)
            continue
        mover = level.movers[number]
        faint = situation.is_overview and mover.within is not None and mover.start is None
        look = situation.looks[number]
        draw = partial(_mover, level, layout, number, cell, spot, look, faint)
        yield cell, Piece(("mover", number, cell, spot, look, faint), _cell_box(layout, cell), draw)


def _mover(
    level: GridWorld, layout: Layout, number: int, cell: Cell, spot: Spot, look: Cell, faint: bool
) -> Iterator[Shape]:
    if faint:
        ground = level.resolved_theme.colors.base
        yield from mover_shapes(level, number, replace(spot, faded_on=ground), look)
        yield from _question_mark(spot.x + 14 * spot.scale, spot.y + 13 * spot.scale)
    else:
        yield from mover_shapes(level, number, spot, look)
    yield from thing_label(level, layout, cell, level.movers[number].label)


_REGION = 0.15
"""The opacity of rectangles."""


def track_shapes(level: GridWorld, layout: Layout) -> Iterator[Shape]:
    """Yield the paths and the rectangles of movers, faintly."""
    colors = level.resolved_theme.colors
    for mover in level.movers:
        if mover.within is not None:
            color = thing_color(mover, colors)
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
