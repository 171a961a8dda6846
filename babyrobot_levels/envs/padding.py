"""What environments of several levels show: each level in a space that all of them share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from babyrobot_levels.envs.observations import Observer, make_observer
from babyrobot_levels.library.level import Level


@dataclass(frozen=True, slots=True)
class PaddedObserver:
    """Shows the states of one level in a space that others share."""

    space: spaces.Space[Any]
    at: Callable[[int], Callable[[], Any]]


class PaddedIndexObserver:
    """The cell's number in a level of the largest size, `y * largest width + x`."""

    def __init__(self, level: Level, largest: tuple[int, int]) -> None:
        self.columns, self.width = level.size[0], largest[0]
        self.space = padded_space("index", largest)

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that gives the number."""
        return partial(int, state // self.columns * self.width + state % self.columns)


class PaddedImageObserver:
    """The picture of the level, cells of all levels in one size, black where there are none."""

    def __init__(
        self,
        level: Level,
        largest: tuple[int, int],
        image_size: tuple[int, int] | None,
        grayscale: bool,
    ) -> None:
        from babyrobot_levels.render.frames import FramePainter

        self.space = padded_space("image", largest, image_size, grayscale)
        height, width = self.space.shape[:2]
        self.right = max(1, round(width * level.size[0] / largest[0]))
        self.bottom = max(1, round(height * level.size[1] / largest[1]))
        self.painter = FramePainter(level, (self.right, self.bottom), grayscale)

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that paints a new picture."""
        return partial(self._picture, state)

    def _picture(self, state: int) -> NDArray[np.uint8]:
        picture = np.zeros(self.space.shape, np.uint8)
        picture[: self.bottom, : self.right] = self.painter.frame(state)
        return picture


def padded_space(
    observation: str,
    largest: tuple[int, int],
    image_size: tuple[int, int] | None = None,
    grayscale: bool = False,
) -> Any:
    """Return the space of an observation of levels that are as large as this, or smaller.

    Args:
        observation: one of `OBSERVATIONS`.
        largest: the largest width and height, in cells.
        image_size: `(height, width)` in pixels of images.
        grayscale: whether images are grey.
    """
    width, height = largest
    if observation == "image":
        from babyrobot_levels.render.frames import default_image_size

        pixels = image_size or default_image_size(width, height)
        return spaces.Box(0, 255, (*pixels, 1 if grayscale else 3), np.uint8)
    if observation == "index":
        return spaces.Discrete(width * height)
    sides = [2] * 4 if observation == "walls" else []
    return spaces.MultiDiscrete([width, height, *sides])


def make_padded_observer(
    level: Level,
    largest: tuple[int, int],
    observation: str,
    image_size: tuple[int, int] | None,
    grayscale: bool,
) -> Observer:
    """Return the observer of a kind in `OBSERVATIONS`, its space that of the largest level."""
    if observation == "image":
        return PaddedImageObserver(level, largest, image_size, grayscale)
    if observation == "index":
        return PaddedIndexObserver(level, largest)
    own = make_observer(level, observation, image_size, grayscale)
    return PaddedObserver(padded_space(observation, largest), own.at)
