"""The scene of a level: all shapes of its picture, in painting order, with those of overlays."""

from __future__ import annotations

import math
from collections.abc import Container, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple, TypedDict, Unpack

from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.mdp.actions import DELTAS, Action
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.render.colors import rim_on
from babyrobot_levels.render.scene.ground import ground_shapes, line_shapes, puddle_shapes
from babyrobot_levels.render.scene.heat import Heat, lost_shapes, never_shapes
from babyrobot_levels.render.scene.layout import CELL, Layout, Overlay, each_cell, layout_of
from babyrobot_levels.render.scene.marks import effect_shapes
from babyrobot_levels.render.scene.panels import (
    compass_shapes,
    panel_shapes,
    panel_texts,
    rules_shapes,
    strip_shapes,
)
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.scene.shapes import (
    Command,
    Path,
    Point,
    Scene,
    Shape,
    circle,
    counted,
    polygon,
    polyline,
    toned,
)
from babyrobot_levels.render.scene.slots import Arrow, Box, Slots
from babyrobot_levels.render.scene.team import own_exit_shapes
from babyrobot_levels.render.scene.texts import (
    Anchor,
    Form,
    busy_cells,
    coordinate_texts,
    end_texts,
    form_of,
    label_shapes,
    note_shapes,
    number_shapes,
)
from babyrobot_levels.render.scene.things import moving_pieces, pieces
from babyrobot_levels.render.scene.walls import casing_shapes, wall_shapes
from babyrobot_levels.render.situation import STANDING, Pose, effects_of, place_of, situation_of

LAYERS = ("base", "heat", "grid", "things", "underlay", "robot", "movers", "overlay", "text")
"""The layers of a picture, from the bottom up."""


class SceneOptions(TypedDict, total=False):
    """What a picture of a level shows.

    Attributes:
        state: the configuration and the cell of the robot, `configuration * cells + y * width + x`
            as in `level.compile()`. None shows the robot on the first start, if the level's
            `display` shows it at all.
        configuration: what is where, if no state is given. None is the level as a whole: with
            everything where it begins, and all places of which one is drawn.
        heading: where the robot looks, 0 N, 1 E, 2 S, 3 W; None for one that does not turn.
        pose: the robot's pose.
        robot: whether the robot is in the picture, as it is by default.
        cells_only: whether to leave out the margin around the grid, panels and compass.
        overlay: values, arrows and texts shown over the cells and in the panels.
    """

    state: int | None
    configuration: int | None
    heading: int | None
    pose: Pose
    robot: bool
    cells_only: bool
    overlay: Overlay | None


def build_scene(level: GridWorld, **shown: Unpack[SceneOptions]) -> Scene:
    """Return the picture of a level, 64 pixels a cell.

    Args:
        level: the level; a maze needs a seed.
        shown: see `SceneOptions`.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
        ValueError: the level has no such state, or the overlay has another size than the level.
    """
    # Layers, and frames, have no description.
    from babyrobot_levels.render.words.describe import describe

    layers, state = build_layers(level, **shown), shown.get("state")
    shapes = tuple(shape for layer in layers.values() for shape in layer.shapes)
    robot = shown.get("robot", True) and (state is not None or level.display.robot.show)
    return replace(layers["base"], shapes=shapes, description=describe(level, state, robot=robot))


def build_layers(
    level: GridWorld, *, layout: Layout | None = None, **shown: Unpack[SceneOptions]
) -> dict[str, Scene]:
    """Return the same picture as layers: painted in this order, they give that of `build_scene`.

    All are as large as the picture. What changes from step to step has layers of its own:

    - `base`: the ground, panels, the compass and the rules;
    - `heat`: values as colours, what cannot occur, and their legends;
    - `grid`: puddles and walls, and the arrows and texts of the level itself;
    - `things`: what has a state and does not move, locked exits, and what is held;
    - `underlay`: the part of an overlay that is below the robot;
    - `robot`: the robot;
    - `movers`: guards and wanderers;
    - `overlay`: arrows over the cells;
    - `text`: numbers and texts over the cells and in the panels.

    Args and errors are those of `build_scene`; `layout` is that of the picture, if it is known.
    """
    state, configuration = shown.get("state"), shown.get("configuration")
    cells_only, overlay = shown.get("cells_only", False), shown.get("overlay") or Overlay()
    layout = layout or layout_of(level, cells_only=cells_only, overlay=overlay)
    slots = Slots(level, layout, overlay)
    coordinates = level.display.coordinates and not overlay.has_colors
    layers: dict[str, tuple[Shape, ...]] = {
        "base": tuple(counted(_base_shapes(level, overlay, layout, cells_only=cells_only))),
        "grid": (
            *counted(floor_shapes(level, layout, slots)),
            *counted(sign_shapes(level, layout, slots, coordinates)),
        ),
        "robot": (),
    }
    pose = shown.get("pose", STANDING).turned(shown.get("heading"))
    cell = level.starts[0] if level.display.robot.show else None
    if state is not None:
        place = place_of(level, state)
        configuration, cell = place.configuration, place.cell
    cell = cell if shown.get("robot", True) else None
    if cell is not None:
        corner = layout.corner(*cell)
        layers["robot"] = robot_shapes(level.resolved_theme, *corner, pose, small=slots.is_crowded)
    situation = situation_of(level, configuration)
    placed = pieces(level, layout, situation, slots)
    layers["things"] = tuple(counted(shape for piece in placed for shape in piece.shapes))
    movers = moving_pieces(level, layout, situation, cell, crowded=overlay.fills_cells)
    layers["movers"] = tuple(counted(shape for _, piece in movers for shape in piece.shapes))
    part = overlay.at(configuration, pose.heading)
    layers |= overlay_shapes(level, part, layout, slots)._asdict()
    title = level.title or level.name or "Level"
    colors = level.resolved_theme.colors
    return {
        name: Scene(layout.width, layout.height, toned(layers[name], colors), title)
        for name in LAYERS
    }


def ground_layer(level: GridWorld, layout: Layout) -> tuple[Shape, ...]:
    """Return the shapes of the layer `base` alone, without an overlay; see `build_layers`."""
    shapes = tuple(_base_shapes(level, Overlay(), layout, cells_only=False))
    return toned(shapes, level.resolved_theme.colors)


def _base_shapes(
    level: GridWorld, overlay: Overlay, layout: Layout, *, cells_only: bool
) -> Iterator[Shape]:
    yield from ground_shapes(level, layout)
    yield from casing_shapes(level, layout)
    yield from strip_shapes(level, layout)
    if not cells_only:
        yield from panel_shapes(level, overlay, layout)
        yield from compass_shapes(level, layout)
        yield from rules_shapes(level, overlay, layout)


def floor_shapes(level: GridWorld, layout: Layout, slots: Slots) -> Iterator[Shape]:
    """Yield lines and walls, which a heat map does not cover."""
    yield from line_shapes(level, layout)
    yield from wall_shapes(level, layout, slots)


def sign_shapes(
    level: GridWorld, layout: Layout, slots: Slots, coordinates: bool
) -> Iterator[Shape]:
    """Yield what the level tells of its cells: puddles, what they do, texts, and whose exits."""
    yield from puddle_shapes(level, layout, slots)
    yield from effect_shapes(level, layout, slots, effects_of(level))
    yield from end_texts(level, layout, slots)
    yield from label_shapes(level, slots)
    yield from own_exit_shapes(level, layout)
    if coordinates:
        yield from coordinate_texts(level, layout, slots)


# -- overlays --------------------------------------------------------------------------------------


class OverlayShapes(NamedTuple):
    """The shapes of an overlay by layer, from the bottom up."""

    heat: tuple[Shape, ...]
    underlay: tuple[Shape, ...]
    overlay: tuple[Shape, ...]
    text: tuple[Shape, ...]


def overlay_shapes(
    level: GridWorld, overlay: Overlay, layout: Layout, slots: Slots | None = None
) -> OverlayShapes:
    """Return the shapes of an overlay: heat map, arrows, numbers, and other texts.

    Args:
        level: the level.
        overlay: what is shown.
        layout: where the cells are.
        slots: what stands where in them, if it is known.

    Raises:
        ValueError: the overlay has another size than the level.
    """
    slots = slots or Slots(level, layout, overlay)
    heat, colors = Heat(level, layout, overlay, slots), level.resolved_theme.colors
    texts: list[Shape] = []
    # On a heat map, the level's own are written in the inks of their tiles.
    if overlay.has_colors if level.display.coordinates else overlay.coordinates:
        texts += counted(
            coordinate_texts(level, layout, slots, heat.colors_of, crossed=overlay.never)
        )
    texts += note_shapes(level, overlay.notes, layout)
    texts += panel_texts(level, overlay, layout)
    return OverlayShapes(
        # Rims of walls lie on the hatching.
        (*counted(never_shapes(level, overlay, layout)), *counted(heat.shapes)),
        # Starts and boxes are crossed, too.
        (
            *lost_shapes(heat),
            *arrow_shapes(arrow_lengths(overlay, slots, layout), slots, layout, colors.arrows),
        ),
        tuple(counted(number_labels(level, heat))),
        tuple(texts),
    )


# -- numbers -------------------------------------------------------------------------------------


def number_labels(level: GridWorld, heat: Heat) -> Iterator[Shape]:
    """Yield the numbers of a heat map, if they are readable on a screen."""
    overlay, slots, layout = heat.overlay, heat.slots, heat.layout
    if not overlay.has_colors:
        return
    colors = level.resolved_theme.colors
    covered = busy_cells(level, layout, slots) | {*level.starts}
    form = number_form(heat.values.values(), overlay.precision)
    if form.is_readable(layout) and slots.shown.number:
        for cell, value in heat.values.items():
            color = heat.scale.color(value)
            box = slots.plan(cell).number.moved(*layout.corner(*cell))
            ground = color if cell in covered else None
            yield from number_shapes(value, form, box, rim_on([color]), ground)
    form = form_of(
        heat.visits.values(), overlay.precision, CELL / 2 - 7 if slots.shown.second else CELL - 8
    )
    if form.is_readable(layout):
        for cell, count in heat.visits.items():
            plan, tile = slots.plan(cell), heat.tiles.get(cell)
            box = (plan.second if slots.shown.second else plan.number).moved(*layout.corner(*cell))
            anchor: Anchor = "end" if slots.shown.second else "middle"
            if tile is None:
                ink, ground = colors.text_fg, colors.text_bg
            else:
                ink, ground = rim_on([tile]), tile if cell in covered else None
            yield from number_shapes(count, form, box, ink, ground, anchor=anchor)
    yield from _action_labels(heat, covered)


def number_form(values: Iterable[float | None], precision: int) -> Form:
    """Return the form of values at the foot of cells."""
    return form_of(values, precision, CELL - 8)


def _action_labels(heat: Heat, covered: Container[Cell]) -> Iterator[Shape]:
    """Yield the values of moves in their triangles, the best in bold; `stay` has none."""
    slots, layout = heat.slots, heat.layout
    # Beside an arrow there is less room.
    room = CELL / 2 - _SIDE - (_MIDDLE if slots.shown.arrows else 2.0)
    numbers = [value for values in heat.action_values.values() for value in values[1:]]
    form = form_of(numbers, heat.overlay.precision, room)
    if not form.is_readable(layout):
        return
    for cell, values in heat.action_values.items():
        best = max(value for value in values if value is not None)
        plan = slots.plan(cell)
        top, foot, y = plan.free.top, plan.free.bottom, plan.arrow.centre[1]
        height = 1.4 * form.size
        boxes: dict[Action, tuple[Box, Anchor]] = {
            Action.NORTH: (Box(0, top, CELL, top + height), "middle"),
            Action.EAST: (Box(0, y, CELL - _SIDE, y), "end"),
            Action.SOUTH: (Box(0, foot - height, CELL, foot), "middle"),
            Action.WEST: (Box(_SIDE, y, CELL, y), "start"),
        }
        for action, (box, anchor) in boxes.items():
            value = values[action]
            if value is not None:
                box = box.moved(*layout.corner(*cell))
                color = heat.scale.color(value)
                # Away from the edges of a cell, its triangles are narrow.
                ground = color if cell in covered or top > _NARROW else None
                is_best = value >= best - _TIE * abs(best) if math.isfinite(best) else value == best
                yield from number_shapes(
                    value, form, box, rim_on([color]), ground, anchor=anchor, bold=is_best
                )


# -- arrows --------------------------------------------------------------------------------------

_SIDE, _MIDDLE, _NARROW = 6.0, 9.5, 8.0
"""The distance of values of actions from the sides of their cell, from arrows' centres, and from
its upper edge before they need a ground."""

_TIE = 1e-9
"""The relative difference up to which two values count as equal."""

_WIDTH, _RIM = 3.2, 2.0
"""The width of arrows, and of the rim that makes them visible on every background."""
_THIN = 2.0, 1.5
"""The same of the short arrows beside values of actions."""
_RING = 0.25
"""The radius of the ring that means `stay`, as a share of the arrows' length."""
_SHORTEST = 0.4
"""The length of the arrow of an improbable action, as a share of that of the most likely one."""
_LEAST = 0.005
"""The probability below which an action has no arrow."""
_MOST_RIMMED = 100
"""The most columns and rows with rims: in larger pictures they would be finer than a pixel."""

Lengths = Mapping[int, float]
"""The length of the arrow of each action, as a share of the longest."""


def arrow_lengths(overlay: Overlay, slots: Slots, layout: Layout) -> Iterator[tuple[Cell, Lengths]]:
    """Yield the arrows of the cells in which the robot can act."""
    if overlay.probabilities is not None:
        for cell, chances in each_cell(overlay.probabilities, layout):
            most = max(chances.values(), default=0.0)
            lengths = {
                action: _SHORTEST + (1 - _SHORTEST) * chance / most
                for action, chance in chances.items()
                if chance >= _LEAST * most > 0
            }
            if cell in slots.acting:
                yield cell, lengths
        return
    for cell, actions in each_cell(overlay.actions, layout):
        if cell in slots.acting:
            yield cell, dict.fromkeys(actions, 1.0)


def arrow_shapes(
    cells: Iterable[tuple[Cell, Lengths]], slots: Slots, layout: Layout, color: str
) -> Iterator[Shape]:
    """Yield the arrows of a policy, with a rim that makes them visible on every background.

    Args:
        cells: the lengths of the arrows of each cell.
        slots: what stands where in the cells.
        layout: where the cells are.
        color: the colour of the arrows.
    """
    shafts: list[Command] = []
    heads: list[Command] = []
    for cell, lengths in cells:
        box = slots.plan(cell).arrow.moved(*layout.corner(*cell))
        middle, reach, start = box.centre, box.width / 2, 0.0
        if Action.STAY in lengths:
            start = _RING * reach * lengths[Action.STAY]
            shafts += circle(*middle, start)
        for action, length in lengths.items():
            if action != Action.STAY:
                shaft, head = _arrow(middle, DELTAS[Action(action)], start, length * reach)
                shafts += shaft
                heads += head
    lines, tips = tuple(shafts), tuple(heads)
    width, around = _THIN if slots.shown.actions else (_WIDTH, _RIM)
    if max(layout.columns, layout.rows) <= _MOST_RIMMED:
        rim = rim_on([color])
        if lines:
            yield Path(lines, stroke=rim, width=width + 2 * around, cap="round")
        if tips:
            yield Path(tips, stroke=rim, width=2 * around)
    if lines:
        yield Path(lines, stroke=color, width=width, cap="round")
    if tips:
        yield Path(tips, fill=color)


def _arrow(start: Point, towards: tuple[int, int], gap: float, reach: float) -> Arrow:
    """Return shaft and head of an arrow that begins and ends `gap` and `reach` from `start`."""
    length, unit = 0.5 * reach, math.hypot(*towards)

    def at(along: float, across: float) -> Point:
        return (
            start[0] + (along * towards[0] - across * towards[1]) / unit,
            start[1] + (along * towards[1] + across * towards[0]) / unit,
        )

    neck = reach - length
    half = 0.6 * length
    shaft = polyline([at(min(gap, neck), 0), at(neck, 0)])
    return shaft, polygon([at(reach, 0), at(neck, half), at(neck, -half)])
