"""What many robots are shown: a table of what each state shows, or pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from babyrobot_levels.envs.padding import PaddedImageObserver, padded_space
from babyrobot_levels.library.level import Level

if TYPE_CHECKING:
    from babyrobot_levels.envs.engine.robots import Results
    from babyrobot_levels.envs.engine.tables import Ints

_Thing = TypeVar("_Thing")


class BatchObserver(Protocol):
    """Shows the states of several levels, numbered one level after the other.

    Attributes:
        space: the space of one robot's observations, large enough for the largest level.
        table: what each state shows, int64 `[states, numbers]`, as an engine needs it.
    """

    space: spaces.Space[Any]
    table: NDArray[np.int64]

    def grow(self, offset: Ints) -> None:
        """Make room for more levels.

        Args:
            offset: intp `[levels + 1]`: where each level's states begin. Those that are there
                already stay where they are.
        """

    def write(self, number: int, level: Level) -> None:
        """Show a level in the place of the one that had its number, if there was one."""

    def show(self, offset: Ints, levels: Iterable[Level]) -> None:
        """Show all of these levels, whose states begin there."""
        self.grow(offset)
        for number, level in enumerate(levels):
            self.write(number, level)

    def at(self, states: Ints) -> NDArray[Any]:
        """Return what states show, `[states, …]`, a new array."""

    def batch(self, results: Results, states: Ints, copy: bool) -> NDArray[Any]:
        """Return what robots in these states are shown.

        Args:
            results: what an engine wrote, the numbers of `table` included.
            states: where the robots are.
            copy: whether it belongs to the user; if not, it is always the same array.
        """


class TableObserver(BatchObserver):
    """Shows numbers: `"position"`, `"index"` or `"walls"`."""

    def __init__(self, largest: tuple[int, int], observation: str) -> None:
        self.space: spaces.Space[Any] = padded_space(observation, largest)
        self._observation, self._largest_width = observation, largest[0]
        self._is_flat = observation == "index"
        self._offset: Ints = np.zeros(1, np.intp)
        self.table = np.zeros((0, *(self.space.shape or (1,))), np.int64)

    def grow(self, offset: Ints) -> None:
        """Make room for more levels, whose states begin there."""
        self._offset = offset
        self.table = np.pad(self.table, ((0, offset[-1] - len(self.table)), (0, 0)))

    def write(self, number: int, level: Level) -> None:
        """Show a level in the place of the one that had its number."""
        shown = _numbers(level, self._observation, self._largest_width)
        base = self._offset[number]
        self.table[base : base + len(shown)] = shown

    def at(self, states: Ints) -> NDArray[Any]:
        """Return what states show, `[states, …]`, a new array."""
        shown = self.table.take(states, axis=0)
        return shown[:, 0] if self._is_flat else shown

    def batch(self, results: Results, states: Ints, copy: bool) -> NDArray[Any]:
        """Return what robots in these states are shown, of which an engine wrote the numbers."""
        return results.observations[:, 0] if self._is_flat else results.observations


class BatchImageObserver(BatchObserver):
    """Shows pictures, all of one size, on which smaller levels are black where they have no cells.

    The table has no numbers in it.
    """

    def __init__(
        self,
        largest: tuple[int, int],
        image_size: tuple[int, int] | None,
        grayscale: bool,
        most: int,
    ) -> None:
        self.space: spaces.Space[Any] = padded_space("image", largest, image_size, grayscale)
        self.table = np.empty((0, 0), np.int64)
        self._offset: Ints = np.zeros(1, np.intp)
        self._levels: dict[int, Level] = {}
        make = partial(
            PaddedImageObserver, largest=largest, image_size=image_size, grayscale=grayscale
        )
        self._observers = LastOnes(make, most)
        self._buffer: NDArray[np.uint8] | None = None

    def grow(self, offset: Ints) -> None:
        """Make room for more levels, whose states begin there."""
        self._offset = offset
        self.table = np.empty((offset[-1], 0), np.int64)

    def write(self, number: int, level: Level) -> None:
        """Show a level in the place of the one that had its number."""
        self._levels[number] = level

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
        states = seen - self._offset.take(levels)
        for number, (level, state) in enumerate(zip(levels.tolist(), states.tolist(), strict=True)):
            observer = self._observers.of(level, self._levels[level])
            pictures[which == number] = observer.at(state)()
        return pictures


class LastOnes(Generic[_Thing]):
    """Things that are made of levels, of which the last ones are kept."""

    def __init__(self, make: Callable[[Level], _Thing], most: int) -> None:
        """Keep as many as `most`."""
        self._make, self._most = make, most
        self._things: dict[int, tuple[Level, _Thing]] = {}

    def of(self, number: int, level: Level) -> _Thing:
        """Return the thing of the level that has a number now."""
        of, thing = self._things.pop(number, (None, None))
        if of is not level or thing is None:
            thing = self._make(level)
        self._things[number] = level, thing
        if len(self._things) > self._most:
            del self._things[next(iter(self._things))]
        return thing


def make_batch_observer(
    largest: tuple[int, int],
    observation: str,
    image_size: tuple[int, int] | None,
    grayscale: bool,
    num_robots: int,
) -> BatchObserver:
    """Return the observer of a kind in `OBSERVATIONS`, which knows no level yet.

    Args:
        largest: the largest width and height of a level, in cells.
        observation: the kind.
        image_size: `(height, width)` in pixels of images.
        grayscale: whether images are grey.
        num_robots: how many robots there are.
    """
    if observation == "image":
        return BatchImageObserver(largest, image_size, grayscale, num_robots)
    return TableObserver(largest, observation)


def largest_of(levels: Iterable[Level]) -> tuple[int, int]:
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
