"""Frames of one level, fast: the level is painted once, and the robot composited on a copy."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from babyrobot_levels.render.raster import composite, to_rgb, translucent
from babyrobot_levels.render.scene.build import build_layers
from babyrobot_levels.render.scene.layout import CELL, Layout, layout_of
from babyrobot_levels.render.scene.overlay import Overlay
from babyrobot_levels.render.scene.pose import STANDING, Pose
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.scene.shapes import Scene

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from babyrobot_levels.mdp.gridworld import GridWorld
    from babyrobot_levels.render.raster import Translucent

    _Patch = tuple[slice, slice, NDArray[np.uint8]]

MAX_FRAME_SIDE = 2048
"""The largest width and height of a frame without a given size."""

IMAGE_CELL = 16
"""The default side of a cell in image observations, in pixels."""

MIN_IMAGE_SIDE = 36
"""The smallest picture that common convolutional networks accept."""

MAX_IMAGE_SIDE = 1024

_GRAY = (0.299, 0.587, 0.114)
"""The brightness of red, green and blue (ITU-R BT.601)."""

_POSES = 64
"""The number of poses that are cached."""

_PATCH_BYTES = 8 * 1024 * 1024
"""The memory for cached cells."""

_Key = TypeVar("_Key", bound=Hashable)
_Value = TypeVar("_Value")


class FramePainter:
    """Paints frames of a level, one for each state and pose of the robot.

    The level is painted once, and the robot once for each pose. A frame is a copy of the level
    with one patch on it: the robot's cell. The most recent patches are cached.

    Args:
        level: the level; a maze needs a seed.
        size: width and height in pixels, to which the cells alone are stretched, without panels
            and margin: what an agent should see. None gives the whole picture at 64 pixels a
            cell; fewer for large levels, so that no side exceeds 2,048 pixels.
        grayscale: whether frames have one channel instead of three.
        overlay: values, arrows and texts shown over the cells and in the panels.

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
    ) -> None:
        cells_only = size is not None
        layout = layout_of(level, cells_only=cells_only, overlay=overlay)
        self.width, self.height = size or _whole_size(layout)
        layers = build_layers(level, robot=False, cells_only=cells_only, overlay=overlay)
        below = [layers[name] for name in ("base", "grid", "underlay")]
        above = [layers[name] for name in ("overlay", "text")]
        self._theme, self._grayscale = level.resolved_theme, grayscale
        self._below = self._painted(below)
        self._above = self._translucent(above, (self.width, self.height)) if overlay else None
        self._base = self._below if self._above is None else composite(self._above, self._below)
        scale_x, scale_y = self.width / layout.width, self.height / layout.height
        self._left = _offsets(layout.margin, layout.columns, scale_x)
        self._top = _offsets(layout.margin, layout.rows, scale_y)
        self._cell = max(1, round(scale_x * CELL)), max(1, round(scale_y * CELL))
        self._robots: dict[Pose, Translucent] = {}
        self._patches: dict[tuple[int, Pose], _Patch] = {}
        self._limit = max(16, _PATCH_BYTES // (3 * self._cell[0] * self._cell[1]))

    def frame(self, state: int, pose: Pose = STANDING) -> NDArray[np.uint8]:
        """Return the picture with the robot in a state: a fresh array, `[height, width, channels]`.

        Args:
            state: the cell, `y * width + x` of the level.
            pose: the robot's pose.

        Raises:
            ValueError: the level has no such state.
        """
        patch = self._patches.get((state, pose))
        if patch is None:
            patch = self._patch(state, pose)
        rows, columns, pixels = patch
        frame = self._base.copy()
        frame[rows, columns] = pixels
        return frame

    def _patch(self, state: int, pose: Pose) -> _Patch:
        """Paint a cell with the robot in it, and cache it."""
        y, x = divmod(state, len(self._left))
        if not 0 <= y < len(self._top):
            raise ValueError(f"state {state} is not on the level")
        robot = self._robots.get(pose)
        if robot is None:
            shapes = robot_shapes(self._theme, 0.0, 0.0, pose)
            robot = self._translucent([Scene(CELL, CELL, shapes)], self._cell)
            _remember(self._robots, pose, robot, _POSES)
        left, top = self._left[x], self._top[y]
        rows, columns = slice(top, top + self._cell[1]), slice(left, left + self._cell[0])
        pixels = composite(robot, self._below[rows, columns])
        if self._above is not None:
            ink, through = self._above
            pixels = composite((ink[rows, columns], through[rows, columns]), pixels)
        patch = rows, columns, pixels
        _remember(self._patches, (state, pose), patch, self._limit)
        return patch

    def _painted(
        self, scenes: list[Scene], size: tuple[int, int] | None = None, ground: str = "white"
    ) -> NDArray[np.uint8]:
        shapes = tuple(shape for scene in scenes for shape in scene.shapes)
        pixels = to_rgb(
            replace(scenes[0], shapes=shapes), size or (self.width, self.height), ground
        )
        return _gray(pixels) if self._grayscale else pixels

    def _translucent(self, scenes: list[Scene], size: tuple[int, int]) -> Translucent:
        return translucent(lambda ground: self._painted(scenes, size, ground))


def _remember(cache: dict[_Key, _Value], key: _Key, value: _Value, limit: int) -> None:
    """Add an entry to a cache; a full cache drops its oldest entry."""
    if len(cache) >= limit:
        del cache[next(iter(cache))]
    cache[key] = value


def default_image_size(width: int, height: int) -> tuple[int, int]:
    """Return height and width in pixels of image observations of a level.

    Cells are squares of 16 pixels: more if a side would be below 36 pixels, fewer if one would
    exceed 1,024. Where a level is too narrow for both, the cells are stretched.

    Args:
        width: the number of columns of cells.
        height: the number of rows of cells.
    """
    cell = max(IMAGE_CELL, math.ceil(MIN_IMAGE_SIDE / min(width, height)))
    cell = min(cell, MAX_IMAGE_SIDE // max(width, height))
    return max(MIN_IMAGE_SIDE, height * cell), max(MIN_IMAGE_SIDE, width * cell)


def _whole_size(layout: Layout) -> tuple[int, int]:
    scale = min(1.0, (MAX_FRAME_SIDE + 0.5) / max(layout.width, layout.height))
    if scale < 1:
        # Cells of whole pixels, at least one.
        scale = max(1, math.floor(scale * CELL)) / CELL
    return round(scale * layout.width), round(scale * layout.height)


def _offsets(margin: float, count: int, scale: float) -> list[int]:
    """Return the pixel at which each column (or row) of cells begins."""
    return [round((margin + index * CELL) * scale) for index in range(count)]


def _gray(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    brightness: NDArray[np.float64] = np.rint(pixels @ np.array(_GRAY))
    return brightness[..., np.newaxis].astype(np.uint8)
