"""The scene of a level: everything that its picture shows, in painting order."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from babyrobot_levels.scene.arrows import warp_shapes, wind_shapes
from babyrobot_levels.scene.ground import ground_shapes
from babyrobot_levels.scene.layout import Layout, layout_of
from babyrobot_levels.scene.overlays import Overlay, overlay_shapes
from babyrobot_levels.scene.panels import compass_shapes, panel_shapes
from babyrobot_levels.scene.puddles import puddle_shapes
from babyrobot_levels.scene.robot import robot_shapes
from babyrobot_levels.scene.shapes import Scene, Shape
from babyrobot_levels.scene.texts import coordinate_texts, end_texts, label_shapes
from babyrobot_levels.scene.walls import wall_shapes

if TYPE_CHECKING:
    from babyrobot_levels.level import Level


def build_scene(
    level: Level,
    *,
    state: int | None = None,
    robot: bool = True,
    cells_only: bool = False,
    overlay: Overlay | None = None,
) -> Scene:
    """Return the picture of a level, 64 pixels a cell.

    Args:
        level: the level; a maze needs a seed.
        state: the cell of the robot, `y * width + x`. None shows him on the first start, if the
            level's `display` shows him at all.
        robot: whether the robot is in the picture.
        cells_only: whether to leave out the free space around the grid, panels and compass.
        overlay: values and arrows that are written over the cells, and over the robot.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
        ValueError: the level has no such state, or the overlay is not as large as the level.
    """
    layout = layout_of(level, cells_only=cells_only)
    shapes = list(_base_shapes(level, layout))
    if robot and (state is not None or level.display.robot.show):
        shapes += robot_shapes(level.colors_and_widths, *_robot_corner(level, layout, state))
    if overlay is not None:
        shapes += overlay_shapes(level, overlay, layout)
    if not cells_only:
        shapes += panel_shapes(level, layout)
        shapes += compass_shapes(level, layout)
    title = level.title or level.name or "Level"
    return Scene(layout.width, layout.height, tuple(shapes), title)


def build_base(level: Level, *, cells_only: bool = False) -> Scene:
    """Return the picture of a level without the robot; see `build_scene`."""
    return build_scene(level, robot=False, cells_only=cells_only)


def _base_shapes(level: Level, layout: Layout) -> Iterator[Shape]:
    yield from ground_shapes(level, layout)
    yield from puddle_shapes(level, layout)
    yield from wind_shapes(level, layout)
    yield from warp_shapes(level, layout)
    yield from end_texts(level, layout)
    yield from wall_shapes(level, layout)
    yield from label_shapes(level, layout)
    yield from coordinate_texts(level, layout)


def _robot_corner(level: Level, layout: Layout, state: int | None) -> tuple[float, float]:
    if state is None:
        return layout.corner(*level.starts[0])
    if not 0 <= state < layout.columns * layout.rows:
        raise ValueError(f"state {state} is not on the level")
    y, x = divmod(state, layout.columns)
    return layout.corner(x, y)
