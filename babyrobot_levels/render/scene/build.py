"""The scene of a level: all shapes of its picture, in painting order."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from babyrobot_levels.render.effects import effects_of
from babyrobot_levels.render.scene.ground import ground_shapes, line_shapes, puddle_shapes
from babyrobot_levels.render.scene.layout import Layout, layout_of
from babyrobot_levels.render.scene.marks import effect_shapes
from babyrobot_levels.render.scene.overlay import Overlay
from babyrobot_levels.render.scene.overlay_shapes import overlay_shapes
from babyrobot_levels.render.scene.panels import (
    compass_shapes,
    panel_shapes,
    rules_shapes,
    strip_shapes,
)
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.scene.shapes import Scene, Shape, toned
from babyrobot_levels.render.scene.situation import STANDING, Pose, place_of, situation_of
from babyrobot_levels.render.scene.slots import Slots
from babyrobot_levels.render.scene.texts import coordinate_texts, end_texts, label_shapes
from babyrobot_levels.render.scene.things import moving_pieces, pieces
from babyrobot_levels.render.scene.walls import casing_shapes, wall_shapes

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

LAYERS = ("base", "heat", "grid", "things", "underlay", "robot", "movers", "overlay", "text")
"""The layers of a picture, from the bottom up."""


def build_scene(
    level: GridWorld,
    *,
    state: int | None = None,
    configuration: int | None = None,
    heading: int | None = None,
    pose: Pose = STANDING,
    robot: bool = True,
    cells_only: bool = False,
    overlay: Overlay | None = None,
) -> Scene:
    """Return the picture of a level, 64 pixels a cell.

    Args:
        level: the level; a maze needs a seed.
        state: the configuration and the cell of the robot, `configuration * cells + y * width + x`
            as in `level.compile()`. None shows the robot on the first start, if the level's
            `display` shows it at all.
        configuration: what is where, if no state is given. None is the level as a whole: with
            everything where it begins, and all places of which one is drawn.
        heading: where the robot looks, 0 N, 1 E, 2 S, 3 W; None for one that does not turn.
        pose: the robot's pose.
        robot: whether the robot is in the picture.
        cells_only: whether to leave out the margin around the grid, panels and compass.
        overlay: values, arrows and texts shown over the cells and in the panels.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
        ValueError: the level has no such state, or the overlay has another size than the level.
    """
    # Layers, and frames, have no description.
    from babyrobot_levels.render.words.describe import describe

    layers = build_layers(
        level,
        state=state,
        configuration=configuration,
        heading=heading,
        pose=pose,
        robot=robot,
        cells_only=cells_only,
        overlay=overlay,
    )
    shapes = tuple(shape for layer in layers.values() for shape in layer.shapes)
    shown = robot and (state is not None or level.display.robot.show)
    return replace(layers["base"], shapes=shapes, description=describe(level, state, robot=shown))


def build_layers(
    level: GridWorld,
    *,
    state: int | None = None,
    configuration: int | None = None,
    heading: int | None = None,
    pose: Pose = STANDING,
    robot: bool = True,
    cells_only: bool = False,
    overlay: Overlay | None = None,
    layout: Layout | None = None,
) -> dict[str, Scene]:
    """Return the same picture as layers: painted in this order, they give that of `build_scene`.

    All are as large as the picture. What changes from step to step has layers of its own:

    - `base`: the ground, panels, the compass and the rules;
    - `heat`: values as colours, and their legend;
    - `grid`: puddles and walls, and the arrows and texts of the level itself;
    - `things`: items, switches, doors, drawn and locked exits, and what is held;
    - `underlay`: the part of an overlay that is below the robot;
    - `robot`: the robot;
    - `movers`: guards and wanderers;
    - `overlay`: arrows over the cells;
    - `text`: numbers and texts over the cells and in the panels.

    Args and errors are those of `build_scene`; `layout` is that of the picture, if it is known.
    """
    overlay = overlay or Overlay()
    layout = layout or layout_of(level, cells_only=cells_only, overlay=overlay)
    slots = Slots(level, layout, overlay)
    coordinates = level.display.coordinates and not overlay.has_colors
    layers: dict[str, tuple[Shape, ...]] = {
        "base": tuple(_base_shapes(level, overlay, layout, cells_only=cells_only)),
        "grid": (
            *floor_shapes(level, layout, slots),
            *sign_shapes(level, layout, slots, coordinates),
        ),
        "robot": (),
    }
    pose = pose.turned(heading)
    cell = level.starts[0] if level.display.robot.show else None
    if state is not None:
        place = place_of(level, state)
        configuration, cell = place.configuration, place.cell
    cell = cell if robot else None
    if cell is not None:
        corner = layout.corner(*cell)
        small = slots.is_crowded
        layers["robot"] = robot_shapes(level.resolved_theme, *corner, pose, small=small)
    situation = situation_of(level, configuration)
    layers["things"] = tuple(
        shape for piece in pieces(level, layout, situation, slots) for shape in piece.shapes
    )
    movers = moving_pieces(level, layout, situation, cell, crowded=overlay.fills_cells)
    layers["movers"] = tuple(shape for _, piece in movers for shape in piece.shapes)
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


def build_base(
    level: GridWorld, *, cells_only: bool = False, overlay: Overlay | None = None
) -> Scene:
    """Return the picture of a level without the robot; see `build_scene`."""
    return build_scene(level, robot=False, cells_only=cells_only, overlay=overlay)


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
    """Yield what the level tells of its cells: puddles, what they do, and texts."""
    yield from puddle_shapes(level, layout, slots)
    yield from effect_shapes(level, layout, slots, effects_of(level))
    yield from end_texts(level, layout, slots)
    yield from label_shapes(level, slots)
    if coordinates:
        yield from coordinate_texts(level, layout, slots)
