"""What all observations have: options, an extent, and objects that make them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import partial
from math import prod
from typing import TYPE_CHECKING, Any, ClassVar, Generic, Self, TypeVar

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import HEADINGS, NUM_MOVES
from babyrobot_levels.mdp.configurations import MAX_STATES, largest_radices

if TYPE_CHECKING:
    from babyrobot_levels.envs.engine.state import Results
    from babyrobot_levels.envs.engine.tables import Ints

_Made = TypeVar("_Made")

DEFAULT_RADIUS = 3
"""How many cells a view shows in each direction."""

Size = tuple[int, int]
"""Width and height in cells."""


@dataclass(frozen=True, slots=True)
class Observation:
    """An observation that was chosen, with its options; see `ObservationOptions`.

    Attributes:
        name: one of `OBSERVATIONS`, or a tuple of several: a dict with each of them.
        robot: of several robots, the number of the one whose observation it is.
    """

    name: str | tuple[str, ...] = "position"
    image_size: tuple[int, int] | None = None
    grayscale: bool = False
    view_radius: int = DEFAULT_RADIUS
    see_through: bool = False
    channels_last: bool = False
    planes_dtype: str = "float32"
    robot: int = 0

    def parts(self) -> dict[str, Observation]:
        """Return each of several observations by its name."""
        return {name: replace(self, name=name) for name in self.name}


@dataclass(frozen=True, slots=True)
class Extent:
    """How much the levels have that share a space of observations, and a way to move.

    Attributes:
        size: the largest width and height, in cells.
        radices: how many values a thing has, other robots left out: in each column of
            configurations the most of any level, for as many as the level with the most things has.
        configurations: the most configurations of a level.
        headings: 4 with `actions="turns"`, where states have a heading, else 1.
        has_items: whether a level has items: pictures then have a row below the cells for what is
            held.
        has_wind: whether a level has wind.
        has_boxes: whether a level has boxes or targets.
        robots: the number of robots.
        moves: the number of directions.
    """

    size: Size
    radices: tuple[int, ...] = ()
    configurations: int = 1
    headings: int = 1
    has_items: bool = False
    has_wind: bool = False
    has_boxes: bool = False
    robots: int = 1
    moves: int = NUM_MOVES

    @classmethod
    def of(cls, levels: Iterable[Level], *, turns: bool = False) -> Self:
        """Return the extent of some levels, at least one.

        A level whose mazes grow at resets counts as having all configurations that its things
        could have.

        Args:
            levels: the levels.
            turns: whether the robot turns.
        """
        size, configurations = (0, 0), 1
        has_items, has_wind, has_boxes = False, False, False
        radices: tuple[int, ...] = ()
        robots, moves = 1, NUM_MOVES
        for level in levels:
            robots, moves = max(robots, len(level.robots)), max(moves, level.moves)
            size = max(size[0], level.size[0]), max(size[1], level.size[1])
            has_items = has_items or bool(level.items)
            has_wind = has_wind or level.wind is not None
            has_boxes = has_boxes or bool(level.boxes or level.targets)
            if level.has_things:
                radices = largest_radices(radices, _radices(level))
                configurations = max(configurations, _configurations(level))
        headings = HEADINGS if turns else 1
        return cls(
            size, radices, configurations, headings, has_items, has_wind, has_boxes, robots, moves
        )

    @property
    def picture(self) -> Size:
        """The width and height of the largest picture, in cells."""
        return self.size[0], self.size[1] + self.has_items

    @property
    def cells(self) -> int:
        """The number of cells of a level of the largest width and height."""
        return self.size[0] * self.size[1]

    @property
    def has_things(self) -> bool:
        """Whether a level has things."""
        return bool(self.radices)


def _radices(level: Level) -> tuple[int, ...]:
    """Return how many values the things of a level have but its robots."""
    things = level.things()
    kinds = zip(things.kinds, things.radices, strict=True)
    return tuple(radix for kind, radix in kinds if kind != "robot")


def _configurations(level: Level) -> int:
    if level.has_random_maze:
        return min(prod(level.things().radices), MAX_STATES // prod(level.size))
    return level.numbering().num_configurations


class Observer(ABC):
    """Makes the observations of one level: each kind is a class of its own.

    A class says what its space is, and what it shows `at` a state. All environments can then
    observe it; where there are faster ways for many states at once, it overrides `rows` and `many`.

    Attributes:
        space: the space, which the levels of an extent share.
        options: the names of those options that this kind alone has.
        many: the class that makes the observations of several levels.
    """

    options: ClassVar[tuple[str, ...]] = ()
    many: ClassVar[type[BatchObserver]]

    def __init__(self, level: Level, extent: Extent, observation: Observation) -> None:
        """Prepare the observations of a level; a maze needs a seed."""
        self.space = self.space_of(extent, observation)
        self._level, self._extent = level, extent
        others = (number for number in range(extent.robots) if number != observation.robot)
        self._order = [observation.robot, *others]

    @classmethod
    @abstractmethod
    def space_of(cls, extent: Extent, observation: Observation) -> spaces.Space[Any]:
        """Return the space for levels of an extent."""

    @abstractmethod
    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that makes a new observation of the state at each call.

        With turning, the state is one of `Mdp.turning`, which has a heading.
        """

    def rows(self, states: NDArray[np.int64]) -> Any:
        """Return the observations of states, `[states, …]`."""
        return np.stack([self.at(state)() for state in states.tolist()])

    def states(self) -> NDArray[np.int64]:
        """Return all states of the level."""
        return np.arange(self._level.compile().num_configurations * self.block)

    def robots(self, states: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Return where robots are, the one that observes first, and which of them have arrived.

        Returns:
            Their cells, or those by which they left, int64 `[states, robots]`; bool, likewise.
        """
        area = prod(self._level.size)
        rest, cell = np.divmod(states, area)
        if self._extent.robots == 1:
            return cell[:, None], np.zeros((states.size, 1), np.bool_)
        columns = self._level.things().of_kind("robot")
        values = self._level.numbering().configurations[rest][:, columns].astype(np.int64)
        arrived, cells = values >= area, values % area
        # The cell of the first one is that of the state.
        arrived[:, 0], cells[:, 0] = values[:, 0] == 1, cell
        return cells[:, self._order], arrived[:, self._order]

    def standing(self, states: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Return the cells of robots as `robots` does, and which of them are in the level.

        The robot that observes always counts as being there.
        """
        cells, arrived = self.robots(states)
        is_there = ~arrived | (self._level.team.arrived == "stay")
        is_there[:, 0] = True
        return cells, is_there

    @property
    def block(self) -> int:
        """The number of states with one configuration."""
        return prod(self._level.size) * self._extent.headings


class BatchObserver:
    """Makes the observations of several levels, whose states are numbered one after the other.

    This one asks an `Observer` of each level, and each state only once, because many environments
    are in few states.

    Attributes:
        space: the space of one environment's observations, that of the largest level.
        table: what engines write of each state, int64 `[states, numbers]`. Only observations that
            are whole numbers need it; of the others, it has no columns.
    """

    def __init__(
        self, kind: type[Observer], extent: Extent, observation: Observation, most: int
    ) -> None:
        """Prepare the observations; there are no levels yet.

        Args:
            kind: what observes one level.
            extent: that of all levels.
            observation: the observation.
            most: of how many levels the observers are kept.
        """
        self.space: spaces.Space[Any] = kind.space_of(extent, observation)
        self.table = np.empty((0, 0), np.int64)
        self._make: Callable[[Level], Any] = partial(kind, extent=extent, observation=observation)
        self._offset: Ints = np.zeros(1, np.intp)
        self._levels: dict[int, Level] = {}
        self._observers: LevelCache[Observer] = LevelCache(self._make, most)
        self._kept: NDArray[Any] | None = None

    def grow(self, offset: Ints) -> None:
        """Make room for levels. Those that were set before have to be set again.

        Args:
            offset: intp `[levels + 1]`: where each level's states begin.
        """
        self._offset = offset
        self.table = np.empty((offset[-1], 0), np.int64)

    def write(self, number: int, level: Level) -> None:
        """Set the level with a number."""
        self._levels[number] = level

    def write_all(self, offset: Ints, levels: Iterable[Level]) -> None:
        """Set all levels, whose states begin at `offset`."""
        self.grow(offset)
        for number, level in enumerate(levels):
            self.write(number, level)

    def observe(self, states: Ints, out: NDArray[Any]) -> None:
        """Write the observations of states into an array `[states, …]`."""
        seen, which = np.unique(states, return_inverse=True)
        for index, (number, state) in enumerate(self._own(seen)):
            observer = self._observers.get(number, self._levels[number])
            out[which == index] = observer.at(state)()

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

    def _own(self, states: Ints) -> Iterable[tuple[int, int]]:
        """Return the number of the level of each state, and the state in its own numbering."""
        levels = np.searchsorted(self._offset, states, side="right") - 1
        return zip(levels.tolist(), (states - self._offset.take(levels)).tolist(), strict=True)


Observer.many = BatchObserver


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
