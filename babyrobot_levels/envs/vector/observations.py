"""Observations of vector environments: those of many states at once, of all their levels."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from functools import partial
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from babyrobot_levels.envs.observations import Observation
from babyrobot_levels.envs.observations.extent import Extent
from babyrobot_levels.envs.observations.images import ImageObserver, image_space
from babyrobot_levels.envs.observations.numbers import NumericObserver, numeric_space
from babyrobot_levels.envs.observations.planes import PlaneForm, PlaneTable
from babyrobot_levels.envs.observations.vectors import VectorObserver, vector_space
from babyrobot_levels.envs.observations.views import ViewTable, view_space
from babyrobot_levels.library.level import Level

if TYPE_CHECKING:
    from babyrobot_levels.envs.engine.state import Results
    from babyrobot_levels.envs.engine.tables import Ints

_Made = TypeVar("_Made")


class BatchObserver(ABC):
    """Makes the observations of several levels, whose states are numbered one after the other.

    Attributes:
        space: the space of one environment's observations, that of the largest level.
        table: what engines write of each state, int64 `[states, numbers]`. Only observations that
            are whole numbers need it; of the others, it has no columns.
    """

    def __init__(self, space: spaces.Space[Any]) -> None:
        self.space = space
        self.table = np.empty((0, 0), np.int64)
        self._kept: NDArray[Any] | None = None

    def grow(self, offset: Ints) -> None:
        """Make room for levels. Those that were set before have to be set again.

        Args:
            offset: intp `[levels + 1]`: where each level's states begin.
        """
        self.table = np.empty((offset[-1], 0), np.int64)

    @abstractmethod
    def write(self, number: int, level: Level) -> None:
        """Set the level with a number."""

    def write_all(self, offset: Ints, levels: Iterable[Level]) -> None:
        """Set all levels, whose states begin at `offset`."""
        self.grow(offset)
        for number, level in enumerate(levels):
            self.write(number, level)

    @abstractmethod
    def observe(self, states: Ints, out: NDArray[Any]) -> None:
        """Write the observations of states into an array `[states, …]`."""

    def gather(self, states: Ints, copy: bool = True) -> Any:
        """Return the observations of states, `[states, …]`.

        Args:
            states: the states.
            copy: whether to return a new array; if not, it is always the same one.
        """
        out = self._kept
        if copy or out is None:
            out = np.empty((states.size, *(self.space.shape or ())), self.space.dtype)
        if not copy:
            self._kept = out
        self.observe(states, out)
        return out

    def each(self, states: Ints) -> list[Any]:
        """Return the observation of each state, as a single environment gives it."""
        found = self.gather(states)
        return list(found) if found.ndim > 1 else found.tolist()

    def batch(self, results: Results, states: Ints, copy: bool) -> Any:
        """Return the observations of environments in these states.

        Args:
            results: what an engine wrote, which includes the numbers of `table`.
            states: the states of the environments.
            copy: as for `gather`.
        """
        return self.gather(states, copy)


class BatchNumericObserver(BatchObserver):
    """Observations that are whole numbers: `"position"`, `"index"` or `"walls"`."""

    def __init__(self, observation: str, extent: Extent) -> None:
        super().__init__(numeric_space(observation, extent))
        self._observation, self._extent = observation, extent
        self._is_single = isinstance(self.space, spaces.Discrete)
        self._offset: Ints = np.zeros(1, np.intp)

    def grow(self, offset: Ints) -> None:
        """Make room for levels, whose states begin at `offset`."""
        self._offset = offset
        self.table = np.zeros((offset[-1], *(self.space.shape or (1,))), np.int64)

    def write(self, number: int, level: Level) -> None:
        """Set the level with a number."""
        table = NumericObserver(level, self._observation, self._extent).table()
        base = self._offset[number]
        self.table[base : base + len(table)] = table

    def observe(self, states: Ints, out: NDArray[Any]) -> None:
        """Write the observations of states into an array `[states, …]`."""
        self.table.take(states, axis=0, out=out.reshape(states.size, -1), mode="clip")

    def batch(self, results: Results, states: Ints, copy: bool) -> Any:
        """Return the observations that an engine wrote."""
        return results.observations[:, 0] if self._is_single else results.observations


class BatchVectorObserver(BatchObserver):
    """Vectors."""

    def __init__(self, extent: Extent) -> None:
        super().__init__(vector_space(extent))
        self._extent = extent
        self._offset: Ints = np.zeros(1, np.intp)
        self._vectors = np.empty((0, *(self.space.shape or ())), np.float32)

    def grow(self, offset: Ints) -> None:
        """Make room for levels, whose states begin at `offset`."""
        super().grow(offset)
        self._offset = offset
        self._vectors = np.zeros((offset[-1], *(self.space.shape or ())), np.float32)

    def write(self, number: int, level: Level) -> None:
        """Set the level with a number."""
        table = VectorObserver(level, self._extent).table()
        base = self._offset[number]
        self._vectors[base : base + len(table)] = table

    def observe(self, states: Ints, out: NDArray[Any]) -> None:
        """Write the vectors of states into an array `[states, entries]`."""
        self._vectors.take(states, axis=0, out=out, mode="clip")


class BatchPlaneObserver(BatchObserver):
    """Planes."""

    def __init__(self, extent: Extent, form: PlaneForm) -> None:
        super().__init__(form.space(extent))
        self._planes = PlaneTable(extent, form)

    def grow(self, offset: Ints) -> None:
        """Make room for levels, whose states begin at `offset`."""
        super().grow(offset)
        self._planes.grow(offset)

    def write(self, number: int, level: Level) -> None:
        """Set the level with a number."""
        self._planes.write(number, level)

    def observe(self, states: Ints, out: NDArray[Any]) -> None:
        """Write the planes of states into an array `[states, …]`."""
        self._planes.observe(states, out)


class BatchImageObserver(BatchObserver):
    """Pictures of one size, on which smaller levels are black where they have no cells."""

    def __init__(
        self, extent: Extent, image_size: tuple[int, int] | None, grayscale: bool, most: int
    ) -> None:
        super().__init__(image_space(extent, image_size, grayscale))
        self._offset: Ints = np.zeros(1, np.intp)
        self._levels: dict[int, Level] = {}
        make = partial(ImageObserver, extent=extent, image_size=image_size, grayscale=grayscale)
        self._observers = LevelCache(make, most)

    def grow(self, offset: Ints) -> None:
        """Make room for levels, whose states begin at `offset`."""
        super().grow(offset)
        self._offset = offset

    def write(self, number: int, level: Level) -> None:
        """Set the level with a number."""
        self._levels[number] = level

    def observe(self, states: Ints, out: NDArray[Any]) -> None:
        """Write the pictures of states into an array `[states, height, width, channels]`."""
        # Many environments are in few states: each picture is painted once.
        seen, which = np.unique(states, return_inverse=True)
        levels = np.searchsorted(self._offset, seen, side="right") - 1
        states = seen - self._offset.take(levels)
        for number, (level, state) in enumerate(zip(levels.tolist(), states.tolist(), strict=True)):
            observer = self._observers.get(level, self._levels[level])
            out[which == number] = observer.at(state)()


class BatchViewObserver(BatchObserver):
    """Views."""

    def __init__(self, extent: Extent, radius: int, see_through: bool) -> None:
        super().__init__(view_space(radius))
        self._views = ViewTable(extent.headings, radius, see_through)

    def grow(self, offset: Ints) -> None:
        """Make room for more levels, whose states begin at `offset`."""
        super().grow(offset)
        self._views.grow(offset)

    def write(self, number: int, level: Level) -> None:
        """Set the level with a number."""
        self._views.write(number, level)

    def observe(self, states: Ints, out: NDArray[Any]) -> None:
        """Write the views of states into an array `[states, side, side, planes]`."""
        out[...] = self._views.at(states)

    def gather(self, states: Ints, copy: bool = True) -> Any:
        """Return the views of states; see `BatchObserver.gather`."""
        return self._views.at(states) if copy else super().gather(states, copy)


class BatchDictObserver(BatchObserver):
    """Dicts of several observations, each of which has an array of its own."""

    def __init__(self, observers: dict[str, BatchObserver]) -> None:
        space = spaces.Dict({name: each.space for name, each in observers.items()})
        super().__init__(space)
        self._observers = {name: observers[name] for name in space}

    def grow(self, offset: Ints) -> None:
        """Make room for levels, whose states begin at `offset`."""
        super().grow(offset)
        for observer in self._observers.values():
            observer.grow(offset)

    def write(self, number: int, level: Level) -> None:
        """Set the level with a number."""
        for observer in self._observers.values():
            observer.write(number, level)

    def observe(self, states: Ints, out: Any) -> None:
        """Write the observations of states into a dict of arrays."""
        for name, observer in self._observers.items():
            observer.observe(states, out[name])

    def gather(self, states: Ints, copy: bool = True) -> dict[str, Any]:
        """Return the observations of states; see `BatchObserver.gather`."""
        return {name: each.gather(states, copy) for name, each in self._observers.items()}

    def each(self, states: Ints) -> list[Any]:
        """Return the observation of each state, as a single environment gives it."""
        columns = (observer.each(states) for observer in self._observers.values())
        rows = zip(*columns, strict=True)
        return [dict(zip(self._observers, row, strict=True)) for row in rows]


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
    match observation.name:
        case tuple():
            parts = observation.parts().items()
            return BatchDictObserver(
                {name: make_batch_observer(part, extent, most) for name, part in parts}
            )
        case "image":
            image = observation.image_size, observation.grayscale
            return BatchImageObserver(extent, *image, most)
        case "view":
            return BatchViewObserver(extent, observation.view_radius, observation.see_through)
        case "planes":
            return BatchPlaneObserver(extent, observation.plane_form)
        case "vector":
            return BatchVectorObserver(extent)
        case name:
            return BatchNumericObserver(name, extent)
