"""Many pictures of one level, fast: the ground is painted once, the robot is laid on a copy."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from babyrobot_levels.render.raster import to_rgb
from babyrobot_levels.scene.build import build_base
from babyrobot_levels.scene.layout import CELL, Layout, layout_of
from babyrobot_levels.scene.robot import robot_shapes
from babyrobot_levels.scene.shapes import Scene

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from babyrobot_levels.level import Level

MAX_FRAME_SIDE = 2048
"""A frame that is given no size is at most this many pixels wide and high."""

IMAGE_CELL = 16
"""The side of a cell in image observations, in pixels, where nothing else is asked for."""

MIN_IMAGE_SIDE = 36
"""The smallest picture that the usual convolutional networks take."""

MAX_IMAGE_SIDE = 1024

_GRAY = (0.299, 0.587, 0.114)
"""The brightness of red, green and blue (ITU-R BT.601)."""


class FramePainter:
    """Paints frames of a level, one for each state of the robot.

    Args:
        level: the level; a maze needs a seed.
        size: width and height in pixels, onto which the cells alone are stretched, without panels
            and free space: what an agent should see. None gives the whole picture at 64 pixels a
            cell; of large levels fewer, so that no side is over 2,048 pixels.
        grayscale: whether frames have one channel in the place of three.

    Attributes:
        width: the width of a frame in pixels.
        height: its height in pixels.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
        ValueError: the size is not positive, or too large.
    """

    def __init__(
        self, level: Level, size: tuple[int, int] | None = None, grayscale: bool = False
    ) -> None:
        layout = layout_of(level, cells_only=size is not None)
        self.width, self.height = size or _whole_size(layout)
        base = build_base(level, cells_only=size is not None)
        self._base = _channels(to_rgb(base, (self.width, self.height)), grayscale)
        scale_x, scale_y = self.width / layout.width, self.height / layout.height
        self._left = _offsets(layout.margin, layout.columns, scale_x)
        self._top = _offsets(layout.margin, layout.rows, scale_y)
        self._paint_robot(level, scale_x * CELL, scale_y * CELL, grayscale)

    def _paint_robot(
        self, level: Level, cell_width: float, cell_height: float, grayscale: bool
    ) -> None:
        """Paint the robot on black and on white: what differs is what shines through."""
        scene = Scene(CELL, CELL, robot_shapes(level.colors_and_widths, 0.0, 0.0))
        size = max(1, round(cell_width)), max(1, round(cell_height))
        on_black = _channels(to_rgb(scene, size, "black"), grayscale).astype(np.uint16)
        on_white = _channels(to_rgb(scene, size, "white"), grayscale).astype(np.uint16)
        # In 256ths, so that blending is one product and one shift.
        self._robot = on_black * 256 + 128
        self._through = (on_white - on_black) * 256 // 255

    def frame(self, state: int) -> NDArray[np.uint8]:
        """Return the picture with the robot in a state: a fresh array, `[height, width, channels]`.

        Args:
            state: the cell, `y * width + x` of the level.

        Raises:
            ValueError: the level has no such state.
        """
        y, x = divmod(state, len(self._left))
        if not 0 <= y < len(self._top):
            raise ValueError(f"state {state} is not on the level")
        frame = self._base.copy()
        height, width = self._robot.shape[:2]
        cell = frame[self._top[y] : self._top[y] + height, self._left[x] : self._left[x] + width]
        height, width = cell.shape[:2]
        cell[...] = (cell * self._through[:height, :width] + self._robot[:height, :width]) >> 8
        return frame


def default_image_size(width: int, height: int) -> tuple[int, int]:
    """Return height and width in pixels of image observations of a level.

    Cells are squares of 16 pixels: more where a side would be below 36 pixels, fewer where one
    would be over 1,024. Of a level so narrow that both cannot be, the cells are stretched.

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


def _channels(pixels: NDArray[np.uint8], grayscale: bool) -> NDArray[np.uint8]:
    if not grayscale:
        return pixels
    brightness: NDArray[np.float64] = np.rint(pixels @ np.array(_GRAY))
    return brightness[..., np.newaxis].astype(np.uint8)
