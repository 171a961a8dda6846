"""Observations: each kind is defined once, as a space and as what every state of a level shows.

All environments use these definitions: single and vector ones, both stepping engines, and the
adapter for Stable-Baselines3. Levels of several sizes share the space of the largest one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from babyrobot_levels.library.level import Level

Ints = NDArray[np.int64]
Size = tuple[int, int]
"""Width and height in cells, those of the largest level where several share a space."""


@dataclass(frozen=True, slots=True)
class NumericObservation:
    """An observation of whole numbers.

    Attributes:
        space: returns the space for levels up to a size. In a `Discrete` space, an observation is
            an int; in a `MultiDiscrete` one, an int64 array.
        table: returns what each state of a level shows, int64 `[states, numbers]`, in the space
            for levels up to a size.
    """

    space: Callable[[Size], spaces.Space[Any]]
    table: Callable[[Level, Size], Ints]


def _columns_and_rows(level: Level) -> tuple[Ints, Ints]:
    width, height = level.size
    states = np.arange(width * height)
    return states % width, states // width


def _position(level: Level, largest: Size) -> Ints:
    return np.stack(_columns_and_rows(level), axis=1)


def _index(level: Level, largest: Size) -> Ints:
    x, y = _columns_and_rows(level)
    return (y * largest[0] + x)[:, None]


def _walls(level: Level, largest: Size) -> Ints:
    open_bits = np.frombuffer(level.grid().open_bits, np.uint8).astype(np.int64)
    is_open = [open_bits >> side & 1 for side in range(4)]
    return np.stack([*_columns_and_rows(level), *is_open], axis=1)


NUMERIC = {
    "position": NumericObservation(lambda largest: spaces.MultiDiscrete([*largest]), _position),
    "index": NumericObservation(lambda largest: spaces.Discrete(largest[0] * largest[1]), _index),
    "walls": NumericObservation(
        lambda largest: spaces.MultiDiscrete([*largest, 2, 2, 2, 2]), _walls
    ),
}
"""The observations that are numbers, by name."""

OBSERVATIONS = ("position", "index", "image", "walls")
"""The names of all observations."""


class Observer(Protocol):
    """Makes the observations of one level."""

    @property
    def space(self) -> spaces.Space[Any]:
        """The space of the observations."""

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that makes a new observation of the state at each call."""


class NumericObserver:
    """Makes the observations of one level that are numbers."""

    def __init__(self, level: Level, observation: str, largest: Size) -> None:
        kind = NUMERIC[observation]
        self.space = kind.space(largest)
        self._table = kind.table(level, largest)
        self._is_single = isinstance(self.space, spaces.Discrete)

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that makes a new array, or gives the int of a `Discrete` space."""
        row = self._table[state]
        return partial(int, row[0].item()) if self._is_single else row.copy


class ImageObserver:
    """Paints one level, uint8 `[height, width, 3]`, or `[height, width, 1]` in grey.

    Cells are as large as those of the largest level; where a smaller one has none, the picture is
    black.
    """

    def __init__(
        self, level: Level, largest: Size, image_size: tuple[int, int] | None, grayscale: bool
    ) -> None:
        # Pictures bring Pillow; the other observations do without it.
        from babyrobot_levels.render.frames import FramePainter

        self.space = image_space(largest, image_size, grayscale)
        height, width = self.space.shape[:2]
        right = max(1, round(width * level.size[0] / largest[0]))
        bottom = max(1, round(height * level.size[1] / largest[1]))
        self._painter = FramePainter(level, (right, bottom), grayscale)
        self._is_padded = (bottom, right) != (height, width)

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that paints a new picture."""
        return partial(self._padded if self._is_padded else self._painter.frame, state)

    def _padded(self, state: int) -> NDArray[np.uint8]:
        frame = self._painter.frame(state)
        picture = np.zeros(self.space.shape, np.uint8)
        picture[: frame.shape[0], : frame.shape[1]] = frame
        return picture


def image_space(largest: Size, image_size: tuple[int, int] | None, grayscale: bool) -> spaces.Box:
    """Return the space of pictures of levels up to a size.

    Args:
        largest: the largest width and height, in cells.
        image_size: `(height, width)` in pixels, None for the default.
        grayscale: whether the pictures are grey.
    """
    from babyrobot_levels.render.frames import default_image_size

    height, width = image_size or default_image_size(*largest)
    return spaces.Box(0, 255, (height, width, 1 if grayscale else 3), np.uint8)


def make_observer(
    level: Level,
    observation: str,
    largest: Size,
    image_size: tuple[int, int] | None,
    grayscale: bool,
) -> Observer:
    """Return the observer of a level, in the space that levels up to a size share.

    Args:
        level: the level.
        observation: one of `OBSERVATIONS`.
        largest: the width and height of the largest level, in cells.
        image_size: `(height, width)` in pixels of images, None for the default.
        grayscale: whether images are grey.
    """
    if observation == "image":
        return ImageObserver(level, largest, image_size, grayscale)
    return NumericObserver(level, observation, largest)
