"""Observations: each kind is a class, which all environments use.

Single and vector environments, both stepping engines, JAX and the adapter for Stable-Baselines3
take their observations from here. Levels that share a space share the one of their `Extent`.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from babyrobot_levels.envs.observations.base import BatchObserver, Extent, Observation, Observer
from babyrobot_levels.envs.observations.numbers import NumericObserver, VectorObserver
from babyrobot_levels.envs.observations.planes import PlaneObserver
from babyrobot_levels.envs.observations.views import ViewObserver
from babyrobot_levels.library.level import Level
from babyrobot_levels.registry.entries import Entries


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


_OWN: dict[str, type[Observer]] = {
    "position": NumericObserver,
    "index": NumericObserver,
    "walls": NumericObserver,
    "vector": VectorObserver,
    "planes": PlaneObserver,
    "image": ImageObserver,
    "view": ViewObserver,
}


OBSERVATIONS = Entries(
    "observations", _OWN, lambda found: isinstance(found, type) and issubclass(found, Observer)
)
"""What makes each observation, by its name."""


class DictObserver(Observer):
    """Makes dicts of several observations of one level, in the order of their names."""

    space: spaces.Dict

    def __init__(self, level: Level, extent: Extent, observation: Observation) -> None:
        super().__init__(level, extent, observation)
        parts = observation.parts()
        self._observers = {name: make_observer(level, parts[name], extent) for name in self.space}

    @classmethod
    def space_of(cls, extent: Extent, observation: Observation) -> spaces.Dict:
        """Return a space with that of each observation."""
        return spaces.Dict({k: space_of(extent, each) for k, each in observation.parts().items()})

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that makes a new dict of new observations."""
        return partial(_made, {name: each.at(state) for name, each in self._observers.items()})

    def rows(self, states: NDArray[np.int64]) -> dict[str, Any]:
        """Return a dict of the observations of states."""
        return {name: each.rows(states) for name, each in self._observers.items()}


def _made(makers: dict[str, Callable[[], Any]]) -> dict[str, Any]:
    return {name: make() for name, make in makers.items()}


class BatchDictObserver(BatchObserver):
    """Dicts of several observations, each of which has an array of its own."""

    space: spaces.Dict

    def __init__(
        self, kind: type[Observer], extent: Extent, observation: Observation, most: int
    ) -> None:
        super().__init__(kind, extent, observation, most)
        parts = observation.parts()
        self._parts = {name: make_batch_observer(parts[name], extent, most) for name in self.space}

    def grow(self, offset: NDArray[np.intp]) -> None:
        """Make room for levels, whose states begin at `offset`."""
        super().grow(offset)
        for observer in self._parts.values():
            observer.grow(offset)

    def write(self, number: int, level: Level) -> None:
        """Set the level with a number."""
        for observer in self._parts.values():
            observer.write(number, level)

    def observe(self, states: NDArray[np.intp], out: Any) -> None:
        """Write the observations of states into a dict of arrays."""
        for name, observer in self._parts.items():
            observer.observe(states, out[name])

    def gather(self, states: NDArray[np.intp], copy: bool = True) -> dict[str, Any]:
        """Return the observations of states; see `BatchObserver.gather`."""
        return {name: each.gather(states, copy) for name, each in self._parts.items()}

    def each(self, states: NDArray[np.intp]) -> list[Any]:
        """Return the observation of each state, as a single environment gives it."""
        columns = (observer.each(states) for observer in self._parts.values())
        return [dict(zip(self._parts, row, strict=True)) for row in zip(*columns, strict=True)]


DictObserver.many = BatchDictObserver


def _kind(observation: Observation) -> type[Observer]:
    name = observation.name
    return OBSERVATIONS[name] if isinstance(name, str) else DictObserver


def space_of(extent: Extent, observation: Observation) -> spaces.Space[Any]:
    """Return the space of an observation that the levels of an extent share."""
    return _kind(observation).space_of(extent, observation)


def make_observer(level: Level, observation: Observation, extent: Extent) -> Observer:
    """Return the observer of a level, in the space that the levels of an extent share."""
    return _kind(observation)(level, extent, observation)


def make_batch_observer(observation: Observation, extent: Extent, most: int) -> BatchObserver:
    """Return an observer without levels.

    Args:
        observation: the observation.
        extent: that of all levels.
        most: of how many levels the observers are kept, where they are slow to make.
    """
    kind = _kind(observation)
    return kind.many(kind, extent, observation, most)
