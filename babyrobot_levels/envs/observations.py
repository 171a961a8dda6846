"""What an environment shows of its state. Each kind has a space and makes fresh observations."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, Protocol

import numpy as np
from gymnasium import spaces

from babyrobot_levels.library.level import Level

OBSERVATIONS = ("position", "index", "image", "walls")


class Observer(Protocol):
    """Shows the states of one level."""

    @property
    def space(self) -> spaces.Space[Any]:
        """The space of the observations."""

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that makes a new observation of the state at each call."""


class PositionObserver:
    """`[x, y]`, int64: the robot's cell."""

    def __init__(self, level: Level):
        self.width, height = level.size
        self.space = spaces.MultiDiscrete([self.width, height])

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that makes a new `[x, y]`."""
        return np.array([state % self.width, state // self.width], np.int64).copy


class IndexObserver:
    """The state's number, `y * width + x`."""

    def __init__(self, level: Level):
        width, height = level.size
        self.space = spaces.Discrete(width * height)

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that gives the number."""
        return partial(int, state)


class WallsObserver:
    """`[x, y, north, east, south, west]`, int64: the cell, and 1 for each side that is open."""

    def __init__(self, level: Level):
        self.width, height = level.size
        self.open_bits = level.grid().open_bits
        self.space = spaces.MultiDiscrete([self.width, height, 2, 2, 2, 2])

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that makes a new array of six."""
        sides = [self.open_bits[state] >> side & 1 for side in range(4)]
        cell = [state % self.width, state // self.width]
        return np.array(cell + sides, np.int64).copy


class ImageObserver:
    """The picture of the level, uint8 `[height, width, 3]`, or `[height, width, 1]` in grey."""

    def __init__(self, level: Level, image_size: tuple[int, int] | None, grayscale: bool):
        # Pictures bring Pillow; the other observations do without it.
        from babyrobot_levels.render.frames import FramePainter, default_image_size

        height, width = image_size or default_image_size(*level.size)
        self.painter = FramePainter(level, (width, height), grayscale)
        shape = (height, width, 1 if grayscale else 3)
        self.space = spaces.Box(0, 255, shape, np.uint8)

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that paints a new picture."""
        return partial(self.painter.frame, state)


def make_observer(
    level: Level, observation: str, image_size: tuple[int, int] | None, grayscale: bool
) -> Observer:
    """Return the observer of a kind in `OBSERVATIONS`."""
    if observation == "image":
        return ImageObserver(level, image_size, grayscale)
    if observation == "walls":
        return WallsObserver(level)
    return IndexObserver(level) if observation == "index" else PositionObserver(level)
