"""Observations of vector environments: tables of all their levels, or pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from babyrobot_levels.envs.observations import (
    Extent,
    ImageObserver,
    NumericObserver,
    Observation,
    image_space,
    numeric_space,
    view_space,
)
from babyrobot_levels.envs.views import ViewTable
from babyrobot_levels.library.level import Level

if TYPE_CHECKING:
    from babyrobot_levels.envs.engine.state import Results
    from babyrobot_levels.envs.engine.tables import Ints

_Made = TypeVar("_Made")


class BatchObserver(Protocol):
    """Makes the observations of several levels, whose states are numbered one after the other.

    Attributes:
        space: the space of one environment's observations, that of the largest level.
        table: the observation of each state, int64 `[states, numbers]`, as engines need it.
    """

    space: spaces.Space[Any]
    table: NDArray[np.int64]

    def grow(self, offset: Ints) -> None:
        """Make room for levels. Those that were set before have to be set again.

        Args:
            offset: intp `[levels + 1]`: where each level's states begin.
        """

    def write(self, number: int, level: Level) -> None:
        """Set the level with a number."""

    def write_all(self, offset: Ints, levels: Iterable[Level]) -> None:
        """Set all levels, whose states begin at `offset`."""
        self.grow(offset)
        for number, level in enumerate(levels):
            self.write(number, level)

    def at(self, states: Ints) -> NDArray[Any]:
        """Return the observations of states, `[states, …]`, as a new array."""

    def batch(self, results: Results, states: Ints, copy: bool) -> NDArray[Any]:
        """Return the observations of environments in these states.

        Args:
            results: what an engine wrote, which includes the numbers of `table`.
            states: the states of the environments.
            copy: whether to return a new array; if not, it is always the same one.
        """


class BatchNumericObserver(BatchObserver):
    """Observations that are numbers: `"position"`, `"index"` or `"walls"`."""

    def __init__(self, observation: str, extent: Extent) -> None:
        self._observation, self._extent = observation, extent
        self.space: spaces.Space[Any] = numeric_space(observation, extent)
        self._is_single = isinstance(self.space, spaces.Discrete)
        self._offset: Ints = np.zeros(1, np.intp)
        self.table = np.zeros((0, *(self.space.shape or (1,))), np.int64)

    def grow(self, offset: Ints) -> None:
        """Make room for levels, whose states begin at `offset`."""
        self._offset = offset
        self.table = np.zeros((offset[-1], self.table.shape[1]), np.int64)

    def write(self, number: int, level: Level) -> None:
        """Set the level with a number."""
        table = NumericObserver(level, self._observation, self._extent).table()
        base = self._offset[number]
        self.table[base : base + len(table)] = table

    def at(self, states: Ints) -> NDArray[Any]:
        """Return the observations of states, `[states, …]`, as a new array."""
        rows = self.table.take(states, axis=0)
        return rows[:, 0] if self._is_single else rows

    def batch(self, results: Results, states: Ints, copy: bool) -> NDArray[Any]:
        """Return the observations that an engine wrote."""
        return results.observations[:, 0] if self._is_single else results.observations


class BatchImageObserver(BatchObserver):
    """Pictures of one size, on which smaller levels are black where they have no cells.

    The table has no numbers.
    """

    def __init__(
        self, extent: Extent, image_size: tuple[int, int] | None, grayscale: bool, most: int
    ) -> None:
        self.space: spaces.Space[Any] = image_space(extent, image_size, grayscale)
        self.table = np.empty((0, 0), np.int64)
        self._offset: Ints = np.zeros(1, np.intp)
        self._levels: dict[int, Level] = {}
        make = partial(ImageObserver, extent=extent, image_size=image_size, grayscale=grayscale)
        self._observers = LevelCache(make, most)
        self._buffer: NDArray[np.uint8] | None = None

    def grow(self, offset: Ints) -> None:
        """Make room for levels, whose states begin at `offset`."""
        self._offset = offset
        self.table = np.empty((offset[-1], 0), np.int64)

    def write(self, number: int, level: Level) -> None:
        """Set the level with a number."""
        self._levels[number] = level

    def at(self, states: Ints) -> NDArray[Any]:
        """Return the pictures of states, uint8 `[states, height, width, channels]`, a new array."""
        shape = self.space.shape or ()
        return self._painted(states, np.empty((states.size, *shape), np.uint8))

    def batch(self, results: Results, states: Ints, copy: bool) -> NDArray[Any]:
        """Return the pictures of environments in these states."""
        if copy:
            return self.at(states)
        if self._buffer is None:
            self._buffer = np.empty((states.size, *(self.space.shape or ())), np.uint8)
        return self._painted(states, self._buffer)

    def _painted(self, states: Ints, pictures: NDArray[np.uint8]) -> NDArray[np.uint8]:
        # Many environments are in few states: each picture is painted once.
        seen, which = np.unique(states, return_inverse=True)
        levels = np.searchsorted(self._offset, seen, side="right") - 1
        states = seen - self._offset.take(levels)
        for number, (level, state) in enumerate(zip(levels.tolist(), states.tolist(), strict=True)):
            observer = self._observers.get(level, self._levels[level])
            pictures[which == number] = observer.at(state)()
        return pictures


class BatchViewObserver(BatchObserver):
    """Views. The table has no numbers; the views are in a table of their own."""

    def __init__(self, extent: Extent, radius: int, see_through: bool) -> None:
        self.space: spaces.Space[Any] = view_space(radius)
        self.table = np.empty((0, 0), np.int64)
        self._views = ViewTable(extent.headings, radius, see_through)
        self._buffer: NDArray[np.uint8] | None = None

    def grow(self, offset: Ints) -> None:
        """Make room for more levels, whose states begin at `offset`."""
        self._views.grow(offset)
        self.table = np.empty((offset[-1], 0), np.int64)

    def write(self, number: int, level: Level) -> None:
        """Set the level with a number."""
        self._views.write(number, level)

    def at(self, states: Ints) -> NDArray[Any]:
        """Return the views of states, uint8 `[states, side, side, planes]`, as a new array."""
        return self._views.at(states)

    def batch(self, results: Results, states: Ints, copy: bool) -> NDArray[Any]:
        """Return the views of environments in these states."""
        views = self._views.at(states)
        if copy:
            return views
        if self._buffer is None:
            self._buffer = np.empty_like(views)
        self._buffer[...] = views
        return self._buffer


class LevelCache(Generic[_Made]):
    """An LRU cache of objects that are made from levels.

    Args:
        make: makes the object of a level.
        most: how many objects are kept.
    """

    def __init__(self, make: Callable[[Level], _Made], most: int) -> None:
        self._make, self._most = make, most
        self._entries: dict[int, tuple[Level, _Made]] = {}

    def get(self, number: int, level: Level) -> _Made:
        """Return the object of a level, made anew if another level had its number before."""
        key, made = self._entries.pop(number, (None, None))
        if key is not level or made is None:
            made = self._make(level)
        self._entries[number] = level, made
        if len(self._entries) > self._most:
            del self._entries[next(iter(self._entries))]
        return made


def make_batch_observer(observation: Observation, extent: Extent, most: int) -> BatchObserver:
    """Return an observer without levels.

    Args:
        observation: the observation.
        extent: that of all levels.
        most: of how many levels the painters are kept, for images.
    """
    if observation.name == "image":
        image = observation.image_size, observation.grayscale
        return BatchImageObserver(extent, *image, most)
    if observation.name == "view":
        return BatchViewObserver(extent, observation.view_radius, observation.see_through)
    return BatchNumericObserver(observation.name, extent)
