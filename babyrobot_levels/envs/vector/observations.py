"""What many robots are shown: a table of what each state shows, or pictures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from babyrobot_levels.envs.suite import PaddedImageObserver
from babyrobot_levels.level import Level

if TYPE_CHECKING:
    from babyrobot_levels.engine.robots import Results
    from babyrobot_levels.engine.tables import Ints


class TableObserver:
    """Shows numbers: `"position"`, `"index"` or `"walls"`.

    Attributes:
        space: the space of one robot's observations, large enough for the largest level.
        table: what each state of each level shows, int64 `[states, numbers]`.
    """

    def __init__(self, levels: Sequence[Level], observation: str) -> None:
        width, height = largest_of(levels)
        self.space: spaces.Space[Any]
        if observation == "index":
            self.space = spaces.Discrete(width * height)
        else:
            sides = [2] * 4 if observation == "walls" else []
            self.space = spaces.MultiDiscrete([width, height, *sides])
        self.table = np.concatenate([_numbers(level, observation, width) for level in levels])
        self._is_flat = observation == "index"

    def at(self, states: Ints) -> NDArray[Any]:
        """Return what states show, `[states, …]`, a new array."""
        shown = self.table.take(states, axis=0)
        return shown[:, 0] if self._is_flat else shown

    def batch(self, results: Results, states: Ints, copy: bool) -> NDArray[Any]:
        """Return what robots in these states are shown, of which an engine wrote the numbers."""
        return results.observations[:, 0] if self._is_flat else results.observations


class BatchImageObserver:
    """Shows pictures, all of one size, on which smaller levels are black where they have no cells.

    Attributes:
        space: the space of one robot's pictures.
        table: an engine needs one: int64 `[states, 0]`.
    """

    def __init__(
        self, levels: Sequence[Level], image_size: tuple[int, int] | None, grayscale: bool
    ) -> None:
        largest = largest_of(levels)
        self._observers = [
            PaddedImageObserver(level, largest, image_size, grayscale) for level in levels
        ]
        self._offset = np.cumsum([0, *(level.size[0] * level.size[1] for level in levels)])
        self.space: spaces.Space[Any] = self._observers[0].space
        self.table = np.empty((int(self._offset[-1]), 0), np.int64)
        self._buffer: NDArray[np.uint8] | None = None

    def at(self, states: Ints) -> NDArray[Any]:
        """Return the pictures of states, uint8 `[states, height, width, channels]`, a new array."""
        shape = self.space.shape or ()
        return self._painted(states, np.empty((states.size, *shape), np.uint8))

    def batch(self, results: Results, states: Ints, copy: bool) -> NDArray[Any]:
        """Return the pictures of robots in these states; without `copy`, always in one array."""
        if copy:
            return self.at(states)
        if self._buffer is None:
            self._buffer = np.empty((states.size, *(self.space.shape or ())), np.uint8)
        return self._painted(states, self._buffer)

    def _painted(self, states: Ints, pictures: NDArray[np.uint8]) -> NDArray[np.uint8]:
        # Many robots stand in few states: each picture is painted once.
        seen, which = np.unique(states, return_inverse=True)
        levels = np.searchsorted(self._offset, seen, side="right") - 1
        for number, (state, level) in enumerate(zip(seen.tolist(), levels.tolist(), strict=True)):
            observe = self._observers[level].at(state - int(self._offset[level]))
            pictures[which == number] = observe()
        return pictures


def make_batch_observer(
    levels: Sequence[Level],
    observation: str,
    image_size: tuple[int, int] | None,
    grayscale: bool,
) -> TableObserver | BatchImageObserver:
    """Return the observer of a kind in `OBSERVATIONS`."""
    if observation == "image":
        return BatchImageObserver(levels, image_size, grayscale)
    return TableObserver(levels, observation)


def largest_of(levels: Sequence[Level]) -> tuple[int, int]:
    """Return the width of the widest of levels, and the height of the highest."""
    widths, heights = zip(*(level.size for level in levels), strict=True)
    return max(widths), max(heights)


def _numbers(level: Level, observation: str, largest_width: int) -> NDArray[np.int64]:
    """Return what each state of a level shows, `[states, numbers]`."""
    width, height = level.size
    states = np.arange(width * height)
    columns = [states % width, states // width]
    if observation == "index":
        return (columns[1] * largest_width + columns[0])[:, None]
    if observation == "walls":
        open_bits = np.frombuffer(level.grid().open_bits, np.uint8).astype(np.int64)
        columns += [open_bits >> side & 1 for side in range(4)]
    return np.stack(columns, axis=1)
