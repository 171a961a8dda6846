"""What many robots are shown: a table of what each state shows, or pictures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from babyrobot_levels.envs.observations import ImageObserver
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
        width, height = (max(level.size[axis] for level in levels) for axis in (0, 1))
        self.space: spaces.Space[Any]
        if observation == "index":
            most = max(level.size[0] * level.size[1] for level in levels)
            self.space = spaces.Discrete(most)
        else:
            sides = [2] * 4 if observation == "walls" else []
            self.space = spaces.MultiDiscrete([width, height, *sides])
        self.table = np.concatenate([_numbers(level, observation) for level in levels])
        self._is_flat = observation == "index"

    def at(self, states: Ints) -> NDArray[Any]:
        """Return what states show, `[states, …]`, a new array."""
        shown = self.table.take(states, axis=0)
        return shown[:, 0] if self._is_flat else shown

    def batch(self, results: Results, states: Ints, copy: bool) -> NDArray[Any]:
        """Return what robots in these states are shown, of which an engine wrote the numbers."""
        return results.observations[:, 0] if self._is_flat else results.observations


class BatchImageObserver:
    """Shows pictures, all of one size; every level's cells are stretched onto it.

    Attributes:
        space: the space of one robot's pictures.
        table: an engine needs one: int64 `[states, 0]`.
    """

    def __init__(
        self, levels: Sequence[Level], image_size: tuple[int, int] | None, grayscale: bool
    ) -> None:
        if image_size is None:
            from babyrobot_levels.render.frames import default_image_size

            image_size = default_image_size(
                max(level.size[0] for level in levels), max(level.size[1] for level in levels)
            )
        self._observers = [ImageObserver(level, image_size, grayscale) for level in levels]
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
            observer = self._observers[level]
            pictures[which == number] = observer.painter.frame(state - int(self._offset[level]))
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


def _numbers(level: Level, observation: str) -> NDArray[np.int64]:
    """Return what each state of a level shows, `[states, numbers]`."""
    width, height = level.size
    states = np.arange(width * height)
    if observation == "index":
        return states[:, None]
    columns = [states % width, states // width]
    if observation == "walls":
        open_bits = np.frombuffer(level.grid().open_bits, np.uint8).astype(np.int64)
        columns += [open_bits >> side & 1 for side in range(4)]
    return np.stack(columns, axis=1)
