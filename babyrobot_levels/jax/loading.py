"""Loading levels into tables: the first ones, and others in the same shapes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.envs.action_sets import ActionSet
from babyrobot_levels.envs.engine.factory import limits_of
from babyrobot_levels.envs.engine.tables import Part, part_of
from babyrobot_levels.envs.observations.base import Extent, Observation
from babyrobot_levels.envs.vector.levels import misfit
from babyrobot_levels.jax.building import LevelArrays, arrays_of, build
from babyrobot_levels.jax.observations import bytes_of, tables_of
from babyrobot_levels.jax.params import EnvParams
from babyrobot_levels.jax.room import Counts, Room
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.suites.named import named_levels
from babyrobot_levels.suites.sources import Bounds
from babyrobot_levels.suites.suite import Suite

MAX_BYTES = 4 * 2**30
"""How much memory tables may take, by default."""

MOST_ENTRIES = 2**31
"""Outcomes are numbered by int32."""


@dataclass(frozen=True, slots=True)
class Loader:
    """Puts levels into tables.

    Attributes:
        observation: which observation.
        bounds: the most that a level can have.
        extent: the same, as the spaces depend on it.
        actions: the actions.
        draw_levels: whether each episode draws its level.
        max_episode_steps: the time limit of all levels, None for each level's own.
        max_bytes: how much memory the tables may take.
    """

    observation: Observation
    bounds: Bounds
    extent: Extent
    actions: ActionSet
    draw_levels: bool
    max_episode_steps: int | None
    max_bytes: int

    def make(self, levels: Sequence[Level], others: Sequence[Level]) -> tuple[EnvParams, Room]:
        """Return the tables of levels, and their size.

        Args:
            levels: the levels.
            others: levels for which there has to be room, too.

        Raises:
            ValueError: the tables take too much memory.
        """
        arrays, room = self._read(levels, len(levels))
        if len(others):
            room = room.for_any(self._size(self._part(level), level) for level in others)
            self._check(room, f"{room.levels:,} levels as large as the largest")
        return self._build(levels, arrays, room), room

    def load(self, levels: Any, room: Room, *, weighted: bool) -> EnvParams:
        """Return the tables of other levels in the room of the first ones.

        Args:
            levels: the levels.
            room: the size of the tables.
            weighted: whether they must have weights.

        Raises:
            LevelNotFoundError: there is no such level.
            LevelError: a level is not valid.
            ValueError: the levels do not fit.
        """
        given = levels_in(levels)
        if len(given) != room.levels:
            raise ValueError(
                f"there must be {room.levels:,} levels, as many as the environment was made with, "
                f"not {len(given):,}; "
                + (
                    "give some of them several times, so that all together fill the number"
                    if len(given) < room.levels
                    else "give fewer, or make the environment with as many"
                )
            )
        arrays, needed = self._read(self._fitting(given), len(given))
        problem = room.misfit(needed)
        if problem is not None:
            raise ValueError(f"the levels do not fit: {problem}; {_MORE_ROOM}")
        params = self._build(given, arrays, room)
        if weighted and params.weights is None:
            return params.weighted(np.ones(len(given)))
        return params

    def _fitting(self, levels: Sequence[Level]) -> Iterator[Level]:
        """Yield levels that fit into the spaces."""
        most = self.bounds
        for level in levels:
            problem = misfit(level, self.extent, most.num_items, has_movers=most.has_movers)
            if problem is not None:
                raise ValueError(f"{level!r} does not fit: {problem}; {_MORE_ROOM}")
            yield level

    def _read(self, levels: Iterable[Level], count: int) -> tuple[list[LevelArrays], Room]:
        """Return levels as arrays, and how much room they need; one is made after the other."""
        arrays, room = [], Room()
        for number, level in enumerate(levels, 1):
            part = self._part(level)
            room = room.and_level(*self._size(part, level))
            # Before the observations are made, which take the most.
            self._check(room, f"{number:,} of {count:,} levels")
            states = part.state_info.size
            observations = tables_of(level, states, self.observation, self.extent)
            limit = limits_of([level], self.max_episode_steps)[0]
            arrays.append(arrays_of(part, limit, level.discount, observations))
        return arrays, room

    def _part(self, level: Level) -> Part:
        return part_of(level, self.actions.tables(level), self.actions.first)

    def _size(self, part: Part, level: Level) -> tuple[Counts, int]:
        """Return how much a level has, and the most outcomes of an action."""
        _, per_configuration = bytes_of(self.observation, self.extent)
        counts = Counts(
            states=part.state_info.size,
            branches=int(np.count_nonzero(part.count > 1)),
            starts=part.starts.size,
            configurations=level.compile().num_configurations if per_configuration else 0,
        )
        return counts, int(part.count.max())

    def _check(self, room: Room, what: str) -> None:
        """Raise a ValueError if tables would be too large."""
        entries = room.total.states * self.actions.num_actions + room.total.branches * room.outcomes
        if entries > MOST_ENTRIES:
            raise ValueError(
                f"{what} have {entries:,} outcomes, more than the {MOST_ENTRIES:,} that can be "
                "numbered; give fewer levels"
            )
        floats = jnp.result_type(float).itemsize
        dynamics = entries * (5 + floats) + room.total.starts * 4
        dynamics += room.total.branches * (4 * (room.outcomes - 1) + floats * room.outcomes)
        dynamics += room.total.states * (1 + self.bounds.num_items)
        dynamics += room.levels * (20 + floats)
        per_state, per_configuration = bytes_of(self.observation, self.extent)
        shown = room.total.states * per_state + room.total.configurations * per_configuration
        if dynamics + shown > self.max_bytes:
            raise ValueError(
                f"the tables of {what} take {_size_of(dynamics + shown)}, more than "
                f"max_bytes={self.max_bytes:,} ({_size_of(self.max_bytes)}): "
                f"{_size_of(dynamics)} for transitions, {_size_of(shown)} for the observation "
                f"{self.observation.name!r}; give fewer levels, choose a smaller observation, or "
                "raise max_bytes"
            )

    def _build(self, levels: Sequence[Level], arrays: list[LevelArrays], room: Room) -> EnvParams:
        params = build(
            arrays,
            room,
            self.actions.num_actions,
            self.bounds.num_items,
            has_movers=self.bounds.has_movers,
            draws_levels=self.draw_levels and room.levels > 1,
        )
        weights = _weights_of(levels)
        return params if weights is None else params.weighted(weights)


def levels_in(given: Any) -> Sequence[Level]:
    """Return the levels that an argument names.

    Args:
        given: the levels, as `named_levels` takes them.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid.
        ValueError: there are none, or one has `maze: {seed: random}`.
    """
    named = named_levels(given)
    levels: Sequence[Level] = named if isinstance(named, Suite) else [*map(load, named)]
    if not isinstance(levels, Suite):
        for level in levels:
            if level.has_random_maze:
                raise ValueError(
                    f"{level!r} has another maze in each episode; draw some of its mazes instead: "
                    "[level.with_maze_seed(seed) for seed in range(100)]"
                )
    if not len(levels):
        raise ValueError("there must be at least one level")
    return levels


def bounds_of(levels: Sequence[Level]) -> Bounds:
    """Return how much levels have at most; of a suite, how much they can have."""
    return levels.bounds if isinstance(levels, Suite) else Bounds.joined(map(Bounds.of, levels))


def _weights_of(levels: Sequence[Level]) -> NDArray[np.float64] | None:
    """Return how often the levels of a suite are drawn; None if equally often."""
    groups = levels.groups if isinstance(levels, Suite) else ()
    if len({weight for _, weight in groups}) < 2:
        return None
    counts, weights = zip(*groups, strict=True)
    return np.repeat(weights, counts)


def _size_of(count: float) -> str:
    """Return a number of bytes as people read it."""
    for unit in ("KiB", "MiB"):
        count /= 1024
        if count < 1024:
            return f"{count:,.1f} {unit}"
    return f"{count / 1024:,.1f} GiB"


_MORE_ROOM = "make the environment with room_for=…, these levels or others as large"
