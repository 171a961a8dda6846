"""Frames of one level, fast: what stays is painted once, and the rest composited on a copy."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import replace
from typing import TYPE_CHECKING

from babyrobot_levels.render.grounds import Grounds, remember
from babyrobot_levels.render.scene.layout import CELL, STRIP, Layout, layout_of
from babyrobot_levels.render.scene.overlay import Overlay
from babyrobot_levels.render.scene.pose import STANDING, Pose
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.scene.shapes import Scene
from babyrobot_levels.render.scene.situation import Cell, place_of, situation_of
from babyrobot_levels.render.scene.things import moving_pieces

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from babyrobot_levels.mdp.gridworld import GridWorld
    from babyrobot_levels.render.grounds import Patch, Sprite
    from babyrobot_levels.render.raster import Translucent

MAX_FRAME_SIDE = 2048
"""The largest width and height of a frame without a given size."""

IMAGE_CELL = 16
"""The default side of a cell in image observations, in pixels."""

MIN_IMAGE_SIDE = 36
"""The smallest picture that common convolutional networks accept."""

MAX_IMAGE_SIDE = 1024

_ROOM = MAX_FRAME_SIDE, MAX_FRAME_SIDE

_POSES = 64
"""The number of poses that are cached."""

_PATCH_BYTES = 8 * 1024 * 1024
"""The memory for cached cells."""


class FramePainter:
    """Paints frames of a level, one for each state and pose of the robot.

    The level is painted once. What lies, stands open or is held is laid on it, once for each
    configuration in which these differ. A frame is a copy of that with patches on it: the cells of
    the robot and of movers. The most recent of all these are cached.

    Args:
        level: the level; a maze needs a seed.
        size: width and height in pixels, to which the cells alone are stretched, without panels
            and margin: what an agent should see. In a level with items, a row below the cells shows
            what is held. None gives the whole picture at 64 pixels a cell; fewer for large levels,
            so that no side exceeds 2,048 pixels.
        grayscale: whether frames have one channel instead of three.
        overlay: values, arrows and texts shown over the cells and in the panels.
        room: the largest width and height of the whole picture, whose cells are made smaller until
            it fits; by default, 2,048 pixels each.

    Attributes:
        width: the width of a frame in pixels.
        height: its height in pixels.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
        ValueError: the size is not positive or too large, or the overlay has another size than
            the level.
    """

    def __init__(
        self,
        level: GridWorld,
        size: tuple[int, int] | None = None,
        grayscale: bool = False,
        overlay: Overlay | None = None,
        room: tuple[int, int] | None = None,
    ) -> None:
        cells_only = size is not None
        # Without a legend: a film's frames are equally large, whatever they show.
        layout = replace(layout_of(level, cells_only=cells_only, overlay=overlay), legend=0.0)
        self.width, self.height = size or _whole_size(layout, room or _ROOM)
        self._level, self._layout = level, layout
        self._crowded = overlay is not None and overlay.fills_cells
        self._small = overlay is not None and overlay.is_crowded
        self._grounds = Grounds(
            level,
            layout,
            (self.width, self.height),
            cells_only=cells_only,
            grayscale=grayscale,
            overlay=overlay,
        )
        scale_x, scale_y = self._grounds.scale
        self._left = _offsets(layout.margin, layout.columns, scale_x)
        self._top = _offsets(layout.margin, layout.rows, scale_y)
        self._cell = max(1, round(scale_x * CELL)), max(1, round(scale_y * CELL))
        self._robots: dict[Pose, Translucent] = {}
        self._patches: dict[tuple[int, Pose], tuple[Hashable, list[Patch]]] = {}
        self._limit = max(16, _PATCH_BYTES // (3 * self._cell[0] * self._cell[1]))

    def frame(
        self, state: int, pose: Pose = STANDING, heading: int | None = None
    ) -> NDArray[np.uint8]:
        """Return the picture with the robot in a state: a fresh array, `[height, width, channels]`.

        Args:
            state: the configuration and the cell, `configuration * cells + y * width + x`, as in
                `level.compile()`.
            pose: the robot's pose.
            heading: where a robot that turns looks, 0 N, 1 E, 2 S, 3 W.

        Raises:
            ValueError: the level has no such state.
        """
        pose = pose if heading is None else pose.turned(heading)
        name, patches = self._patches.get((state, pose)) or self._patched(state, pose)
        ground = self._grounds.named(name)
        if ground is None:
            ground = self._grounds.at(place_of(self._level, state).configuration, pose.heading)
        frame = ground.whole.copy()
        for rows, columns, pixels in patches:
            frame[rows, columns] = pixels
        return frame

    def _patched(self, state: int, pose: Pose) -> tuple[Hashable, list[Patch]]:
        """Paint the cells of the robot and of movers, and cache them."""
        level, place = self._level, place_of(self._level, state)
        ground = self._grounds.at(place.configuration, pose.heading)
        situation = situation_of(level, place.configuration)
        figures: dict[Cell, list[Sprite]] = {place.cell: [self._robot(place.cell, pose)]}
        movers = moving_pieces(level, self._layout, situation, place.cell, crowded=self._crowded)
        for cell, piece in movers:
            figures.setdefault(cell, []).append(self._grounds.sprite(piece))
        patches = [ground.patch(sprites) for sprites in figures.values()]
        remember(self._patches, (state, pose), (ground.name, patches), self._limit)
        return ground.name, patches

    def _robot(self, cell: Cell, pose: Pose) -> Sprite:
        image = self._robots.get(pose)
        if image is None:
            theme = self._level.resolved_theme
            shapes = robot_shapes(theme, 0.0, 0.0, pose, small=self._small)
            image = self._grounds.translucent(Scene(CELL, CELL, shapes), self._cell)
            remember(self._robots, pose, image, _POSES)
        left, top = self._left[cell[0]], self._top[cell[1]]
        return slice(top, top + self._cell[1]), slice(left, left + self._cell[0]), image


def image_cells(level: GridWorld) -> tuple[int, int]:
    """Return the columns and rows of a picture of the cells alone, as agents see it.

    These are those of the level; in a level with items, a further row shows what is held.
    """
    width, height = level.size
    return width, height + bool(level.items)


def default_image_size(width: int, height: int) -> tuple[int, int]:
    """Return height and width in pixels of image observations of a level.

    Cells are squares of 16 pixels: more if a side would be below 36 pixels, fewer if one would
    exceed 1,024. Where a level is too narrow for both, the cells are stretched.

    Args:
        width: the number of columns of cells; see `image_cells`.
        height: the number of rows.
    """
    cell = max(IMAGE_CELL, math.ceil(MIN_IMAGE_SIDE / min(width, height)))
    cell = min(cell, MAX_IMAGE_SIDE // max(width, height))
    return max(MIN_IMAGE_SIDE, height * cell), max(MIN_IMAGE_SIDE, width * cell)


def largest_frame(level: GridWorld, size: tuple[int, int], num_items: int) -> tuple[int, int]:
    """Return width and height in pixels of the frames of a level of another size.

    Args:
        level: a level with the same theme and panels.
        size: the width and height of the other one in cells.
        num_items: how many items that has.
    """
    like = layout_of(level)
    strip = STRIP if num_items and like.held_in == "strip" else 0.0
    layout = replace(like, columns=size[0], rows=size[1], items=num_items, strip=strip)
    return _whole_size(layout, _ROOM)


def _whole_size(layout: Layout, room: tuple[int, int]) -> tuple[int, int]:
    scale = min(1.0, (room[0] + 0.5) / layout.width, (room[1] + 0.5) / layout.height)
    if scale < 1:
        # Cells of whole pixels, at least one.
        scale = max(1, math.floor(scale * CELL)) / CELL
    return round(scale * layout.width), round(scale * layout.height)


def _offsets(margin: float, count: int, scale: float) -> list[int]:
    """Return the pixel at which each column (or row) of cells begins."""
    return [round((margin + index * CELL) * scale) for index in range(count)]
