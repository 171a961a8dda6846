"""The first robots of many, side by side in one picture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.envs.vector.observations import LastOnes
from babyrobot_levels.library.level import Level

if TYPE_CHECKING:
    from babyrobot_levels.render.frames import FramePainter

MOST = 16
"""How many robots are shown at most."""

SIDE = 1024
"""The longer side of the picture in pixels, where cells can be made to fit."""

MAX_CELL = 64
GAP = 4


class Tiles:
    """Paints robots as tiles, row by row, in a picture that is as nearly square as they allow.

    Attributes:
        count: how many tiles there are.
    """

    def __init__(self, largest: tuple[int, int], num_robots: int) -> None:
        """Divide a picture.

        Args:
            largest: the largest width and height of a level, in cells.
            num_robots: how many robots there are.
        """
        self.count = min(num_robots, MOST)
        width, height = largest
        self._columns = _columns(self.count, width, height)
        self._rows = math.ceil(self.count / self._columns)
        longer = max(self._columns * width, self._rows * height)
        cell = min(MAX_CELL, max(1, SIDE // longer))
        self._step = height * cell + GAP, width * cell + GAP
        self._painters = LastOnes(partial(_painter, cell=cell), MOST)

    def picture(
        self, numbers: Sequence[int], levels: Sequence[Level], states: Sequence[int]
    ) -> NDArray[np.uint8]:
        """Return the picture, uint8 `[height, width, 3]`.

        Args:
            numbers: the number of the level that each robot plays.
            levels: the level that each robot plays.
            states: where each robot is, in its level's own numbering.
        """
        height, width = self._step
        shape = (self._rows * height - GAP, self._columns * width - GAP, 3)
        picture = np.full(shape, 255, np.uint8)
        for tile, (number, level, state) in enumerate(zip(numbers, levels, states, strict=True)):
            frame = self._painters.of(number, level).frame(state)
            row, column = divmod(tile, self._columns)
            top, left = row * height, column * width
            picture[top : top + frame.shape[0], left : left + frame.shape[1]] = frame
        return picture


def _painter(level: Level, cell: int) -> FramePainter:
    from babyrobot_levels.render.frames import FramePainter

    return FramePainter(level, (level.size[0] * cell, level.size[1] * cell))


def _columns(count: int, width: int, height: int) -> int:
    """Return into how many columns tiles of a size go, so that no side is longer than need be."""
    return min(
        range(1, count + 1),
        key=lambda columns: max(columns * width, math.ceil(count / columns) * height),
    )
