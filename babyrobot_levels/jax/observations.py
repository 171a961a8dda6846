"""The observations of all states as arrays, from which a compiled step reads them.

They are those of the other environments, made by the same observers. The tables of one level have
NumPy arrays; `joined` puts those of many together, in the room that they take.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from math import prod
from typing import Any, NamedTuple, Self

import jax
import jax.numpy as jnp
import numpy as np
from gymnasium import spaces as gymnasium_spaces
from gymnax.environments import spaces
from jax import Array
from jax.tree_util import register_dataclass
from numpy.typing import NDArray

from babyrobot_levels.envs.observations import OBSERVATIONS, DictObserver, make_observer, space_of
from babyrobot_levels.envs.observations.base import Extent, Observation
from babyrobot_levels.envs.observations.planes import PlaneObserver
from babyrobot_levels.library.level import Level

# -- how much room levels take in tables, and whether others fit into it ---------------------


class Counts(NamedTuple):
    """How much a level has, or several together.

    Attributes:
        states: how many states.
        branches: how many stochastic rows: pairs of state and action with several outcomes.
        starts: how many states in which episodes start.
        configurations: how many configurations, if the observation has something for each.
    """

    states: int
    branches: int
    starts: int
    configurations: int


_NONE = Counts(0, 0, 0, 0)


@dataclass(frozen=True, slots=True)
class Room:
    """The size of tables, which compiled code depends on.

    Attributes:
        levels: how many levels there are.
        total: how much they have together.
        most: the most that one of them has.
        outcomes: the most outcomes of an action.
    """

    levels: int = 0
    total: Counts = _NONE
    most: Counts = _NONE
    outcomes: int = 1

    def and_level(self, counts: Counts, outcomes: int) -> Self:
        """Return the room for one more level."""
        return replace(
            self,
            levels=self.levels + 1,
            total=Counts(*map(sum, zip(self.total, counts, strict=True))),
            most=Counts(*map(max, self.most, counts)),
            outcomes=max(self.outcomes, outcomes),
        )

    def for_any(self, others: Iterable[tuple[Counts, int]]) -> Self:
        """Return the room for as many levels, each as large as the largest of these and others."""
        largest = self
        for counts, outcomes in others:
            largest = largest.and_level(counts, outcomes)
        total = Counts(*(self.levels * count for count in largest.most))
        return replace(self, total=total, most=largest.most, outcomes=largest.outcomes)

    def misfit(self, needed: Room) -> str | None:
        """Return why as many levels do not fit that need other room, None if they do."""
        for what, need, have in zip(_NAMES, needed.total, self.total, strict=True):
            if need > have:
                return f"they have {need:,} {what} together, and there is room for {have:,}"
        for what, need, have in zip(_NAMES, needed.most, self.most, strict=True):
            if need > have:
                return f"one of them has {need:,} {what}, and there is room for {have:,}"
        if needed.outcomes > self.outcomes:
            return (
                f"an action has {needed.outcomes} outcomes, and there is room for {self.outcomes}"
            )
        return None


_NAMES = ("states", "pairs of state and action with several outcomes", "starts", "configurations")


# -- the tables ------------------------------------------------------------------------------


def look_up(table: Array, index: Any) -> Array:
    """Return a row of a table, or rows; without the checks of `table[index]`, which take time.

    Args:
        table: `[rows, …]`.
        index: int32, from 0 on and below the number of rows.
    """
    return table.at[index].get(mode="promise_in_bounds")


@register_dataclass
@dataclass(frozen=True)
class RowTable:
    """An observation that has a row of an array for each state.

    Attributes:
        rows: `[states, …]`; of views uint8 `[states, bytes]`, the first of their numbers in the
            lowest bits, the next ones in the bits above: so whole vectors are unpacked at once.
        shape: the shape of a view; None if rows are observations.
    """

    rows: Array
    shape: tuple[int, ...] | None = field(default=None, metadata={"static": True})

    def at(self, states: Any) -> Array:
        """Return the observation of a state, or of each of an array of states."""
        rows = look_up(self.rows, states)
        if self.shape is None:
            return rows
        bits = jnp.concatenate([rows >> place & 1 for place in range(8)], axis=-1)
        return bits[..., : prod(self.shape)].reshape(rows.shape[:-1] + self.shape)

    def take(self, level: Array, base: Array, states: int) -> RowTable:
        """Return the rows of a level, which begin at `base`."""
        return replace(self, rows=self.rows.at[base + jnp.arange(states)].get(mode="clip"))

    @classmethod
    def join(cls, parts: Sequence[Self], room: Room) -> RowTable:
        """Return the tables of several levels as one, with this room."""
        rows = _filled([part.rows for part in parts], room.total.states)
        return replace(parts[0], rows=jnp.asarray(rows))


@register_dataclass
@dataclass(frozen=True)
class PlaneTables:
    """Planes in two parts: those of a configuration, to which the robot is added.

    Attributes:
        ground: int32 `[states]`: the row of `grounds`.
        robot: int32 `[states, places]`: where the robot is, as indices of flat planes.
        grounds: `[configurations, …]`: the planes without the robot.
        first_ground: int32 `[levels + 1]`: where the grounds of each level begin.
        one: what stands for 1.
        most: the most configurations of a level.
    """

    ground: Array
    robot: Array
    grounds: Array
    first_ground: Array
    one: int = field(metadata={"static": True})
    most: int = field(metadata={"static": True})

    def at(self, states: Any) -> Array:
        """Return the planes of a state, or of each of an array of states."""
        if jnp.ndim(states):
            return jax.vmap(self.at)(states)
        planes = look_up(self.grounds, look_up(self.ground, states))
        robot = look_up(self.robot, states)
        return planes.reshape(-1).at[robot].set(self.one).reshape(planes.shape)

    def take(self, level: Array, base: Array, states: int) -> PlaneTables:
        """Return the planes of a level, whose states begin at `base`."""
        here, first = base + jnp.arange(states), self.first_ground[level]
        ground = self.ground.at[here].get(mode="clip") - first
        return replace(
            self,
            # What is beyond the end is of other levels, and never looked up.
            ground=jnp.clip(ground, 0, self.most - 1),
            robot=self.robot.at[here].get(mode="clip"),
            grounds=self.grounds.at[first + jnp.arange(self.most)].get(mode="clip"),
            first_ground=jnp.stack([jnp.zeros_like(first), self.first_ground[level + 1] - first]),
        )

    @classmethod
    def join(cls, parts: Sequence[Self], room: Room) -> PlaneTables:
        """Return the tables of several levels as one, with this room."""
        first = np.cumsum([0, *(len(part.grounds) for part in parts)])
        ground = [part.ground + base for part, base in zip(parts, first, strict=False)]
        return PlaneTables(
            ground=jnp.asarray(_filled(ground, room.total.states), jnp.int32),
            robot=jnp.asarray(
                _filled([part.robot for part in parts], room.total.states), jnp.int32
            ),
            grounds=jnp.asarray(
                _filled([part.grounds for part in parts], room.total.configurations)
            ),
            first_ground=jnp.asarray(first, jnp.int32),
            one=parts[0].one,
            most=room.most.configurations,
        )


@register_dataclass
@dataclass(frozen=True)
class DictTables:
    """Several observations.

    Attributes:
        parts: each of them by its name.
    """

    parts: dict[str, ObservationTables]

    def at(self, states: Any) -> dict[str, Array]:
        """Return the observations of a state, or of each of an array of states."""
        return {name: part.at(states) for name, part in self.parts.items()}

    def take(self, level: Array, base: Array, states: int) -> DictTables:
        """Return the observations of a level, whose states begin at `base`."""
        return DictTables(
            {name: part.take(level, base, states) for name, part in self.parts.items()}
        )

    @classmethod
    def join(cls, parts: Sequence[Self], room: Room) -> DictTables:
        """Return the tables of several levels as one, with this room."""
        return DictTables(
            {name: joined([part.parts[name] for part in parts], room) for name in parts[0].parts}
        )


ObservationTables = RowTable | PlaneTables | DictTables


def joined(parts: Sequence[Any], room: Room) -> ObservationTables:
    """Return tables of the same kind, of one level each, as one with this room."""
    tables: ObservationTables = type(parts[0]).join(parts, room)
    return tables


def tables_of(
    level: Level, count: int, observation: Observation, extent: Extent
) -> ObservationTables:
    """Return the observations of all states of one level, as NumPy arrays.

    Args:
        level: the level.
        count: how many states it has.
        observation: which observation.
        extent: the extent of all levels.
    """
    observer, states = make_observer(level, observation, extent), np.arange(count)
    if isinstance(observer, DictObserver):
        parts = observation.parts().items()
        return DictTables({name: tables_of(level, count, part, extent) for name, part in parts})
    if isinstance(observer, PlaneObserver):
        return _planes(observer, states)
    if _is_bits(observer.space):
        # Not all at once, because they are packed into an eighth.
        rows = [_packed(observer.at(state)()) for state in range(count)]
        return RowTable(np.stack(rows), observer.space.shape)
    found = observer.rows(states)
    return RowTable(found.astype(np.int32) if found.dtype == np.int64 else found)


def _is_bits(space: gymnasium_spaces.Space[Any]) -> bool:
    """Return whether observations are zeros and ones, which are kept as bits."""
    if not isinstance(space, gymnasium_spaces.Box):
        return False
    return space.dtype == np.uint8 and bool((space.high == 1).all())


def _packed(view: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return a view in an eighth of its bytes; see `RowTable`."""
    bits = np.zeros((8, -(-view.size // 8)), np.uint8)
    bits.reshape(-1)[: view.size] = view.reshape(-1)
    packed: NDArray[np.uint8] = np.packbits(bits, axis=0, bitorder="little")[0]
    return packed


def _planes(observer: PlaneObserver, states: NDArray[np.int64]) -> PlaneTables:
    ground = states // observer.block
    configurations = int(ground[-1]) + 1
    return PlaneTables(
        ground=ground,
        robot=observer.robot(states),
        grounds=np.stack([observer.ground(number) for number in range(configurations)]),
        first_ground=np.array([0, configurations]),
        one=observer.one,
        most=configurations,
    )


@lru_cache
def bytes_of(observation: Observation, extent: Extent) -> tuple[int, int]:
    """Return how much memory observations take for each state, and for each configuration.

    Args:
        observation: which observation.
        extent: the extent of all levels.
    """
    if isinstance(observation.name, tuple):
        each = [bytes_of(part, extent) for part in observation.parts().values()]
        return sum(state for state, _ in each), sum(configuration for _, configuration in each)
    space = space_of(extent, observation)
    size, itemsize = prod(space.shape or ()), np.dtype(space.dtype).itemsize
    if OBSERVATIONS[observation.name] is PlaneObserver:
        places = 1 + (extent.headings > 1)
        return 4 * (1 + places), size * itemsize
    # Whole numbers of 64 bits are kept in 32.
    return (-(-size // 8) if _is_bits(space) else size * min(4, itemsize)), 0


def gymnax_space(space: gymnasium_spaces.Space[Any]) -> spaces.Space:
    """Return a space of Gymnasium as one of gymnax."""
    match space:
        case gymnasium_spaces.Discrete():
            return spaces.Discrete(int(space.n))
        case gymnasium_spaces.MultiDiscrete():
            highest = jnp.asarray(space.nvec - 1, jnp.int32)
            return spaces.Box(jnp.zeros_like(highest), highest, space.shape, jnp.int32)
        case gymnasium_spaces.Box():
            return spaces.Box(space.low.flat[0], space.high.flat[0], space.shape, space.dtype)
        case gymnasium_spaces.Dict():
            return spaces.Dict({name: gymnax_space(each) for name, each in space.items()})
    raise NotImplementedError(f"gymnax has no space like {space}")


def _filled(arrays: Sequence[NDArray[Any]], count: int) -> NDArray[Any]:
    """Return arrays one after the other, and zeros after them up to a count."""
    made = np.zeros((count, *arrays[0].shape[1:]), arrays[0].dtype)
    np.concatenate(arrays, out=made[: sum(map(len, arrays))])
    return made
