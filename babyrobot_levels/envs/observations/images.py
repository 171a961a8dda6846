"""Pictures of a level as observations."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from babyrobot_levels.envs.observations.base import Extent, Observation, Observer
from babyrobot_levels.library.level import Level


class ImageObserver(Observer):
    """Paints one level, uint8 `[height, width, 3]`, or `[height, width, 1]` in grey.

    Cells are as large as those of the largest level; where a smaller one has none, the picture is
    black. In a level with items, a row below the cells shows what is held.
    """

    options = ("image_size", "grayscale")
    space: spaces.Box

    def __init__(self, level: Level, extent: Extent, observation: Observation) -> None:
        # Pictures bring Pillow; the other observations do without it.
        from babyrobot_levels.render.frames import FramePainter
        from babyrobot_levels.render.situation import STANDING

        super().__init__(level, extent, observation)
        height, width = self.space.shape[:2]
        columns, rows = extent.picture
        right = max(1, round(width * level.size[0] / columns))
        bottom = max(1, round(height * (level.size[1] + bool(level.items)) / rows))
        self._painter = FramePainter(level, (right, bottom), observation.grayscale)
        turns = extent.headings > 1
        self._poses = [STANDING.turned(each if turns else None) for each in range(extent.headings)]
        self._cells = level.size[0] * level.size[1]
        self._is_padded = (bottom, right) != (height, width)

    @classmethod
    def space_of(cls, extent: Extent, observation: Observation) -> spaces.Box:
        """Return the space of pictures of one size, which the largest level fills."""
        from babyrobot_levels.render.frames import default_image_size

        height, width = observation.image_size or default_image_size(*extent.picture)
        channels = 1 if observation.grayscale else 3
        return spaces.Box(0, 255, (height, width, channels), np.uint8)

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that paints a new picture."""
        return partial(self._padded if self._is_padded else self._frame, state)

    def _frame(self, state: int) -> NDArray[np.uint8]:
        rest, cell = divmod(state, self._cells)
        configuration, heading = divmod(rest, self._extent.headings)
        return self._painter.frame(configuration * self._cells + cell, self._poses[heading])

    def _padded(self, state: int) -> NDArray[np.uint8]:
        frame = self._frame(state)
        picture = np.zeros(self.space.shape, np.uint8)
        picture[: frame.shape[0], : frame.shape[1]] = frame
        return picture
