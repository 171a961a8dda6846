"""Loading levels into tables: the first ones, and others in the same shapes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Any

import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.envs.arguments import limits_of
from babyrobot_levels.envs.engine.tables import (
    MOST_ACTIONS,
    NO_LIMIT,
    Part,
    info_dtype,
    masks_of,
    part_of,
)
from babyrobot_levels.envs.observations.base import Extent, Observation
from babyrobot_levels.envs.spaces import ActionSet
from babyrobot_levels.envs.vector.levels import misfit
from babyrobot_levels.jax.observations import (
    Counts,
    ObservationTables,
    Room,
    bytes_of,
    joined,
    tables_of,
)
from babyrobot_levels.jax.params import (
    EXIT,
    NEVER,
    REACHED,
    SKIDDED,
    TERMINAL,
    UNLIMITED,
    EnvParams,
    thresholds,
)
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import NUM_ACTIONS
from babyrobot_levels.mdp.states import exit_states
from babyrobot_levels.suites.sources import Bounds
from babyrobot_levels.suites.suite import Suite, named_levels

MAX_BYTES = 4 * 2**30
"""How much memory tables may take, by default."""

MOST_ROBOTS = 4
"""The most robots of a level."""

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

    @property
    def num_actions(self) -> int:
        """How many actions there are, of several robots joint ones."""
        return int(self.actions.num_actions**self.extent.robots)

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
        if (problem := room.misfit(needed)) is not None:
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
            observations = tables_of(level, part.state_info.size, self.observation, self.extent)
            limit = limits_of([level], self.max_episode_steps)[0]
            exits = exit_states(level, self.actions.tables(level))
            arrays.append(arrays_of(part, exits, limit, level.discount, observations))
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
        entries = room.total.states * self.num_actions + room.total.branches * room.outcomes
        if entries > MOST_ENTRIES:
            raise ValueError(
                f"{what} have {entries:,} outcomes, more than the {MOST_ENTRIES:,} that can be "
                "numbered; give fewer levels"
            )
        floats = jnp.result_type(float).itemsize
        dynamics = entries * (5 + floats) + room.total.starts * 4
        dynamics += room.total.branches * (4 * (room.outcomes - 1) + floats * room.outcomes)
        dynamics += room.total.states * (
            mask_type(self.num_actions).itemsize + self.bounds.num_items
        )
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
            self.num_actions,
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


# -- tables ----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class LevelArrays:
    """One level, with its own numbering of states.

    Attributes:
        next_state: int32 `[rows]`; -1 - n where stochastic row n is drawn from.
        reward: float64 `[rows]`.
        outcome: uint8 `[rows]`.
        drawn: the same three of stochastic rows, `[stochastic rows, outcomes]`; those that do not
            exist repeat the row's last one.
        threshold: uint32 `[stochastic rows, outcomes - 1]`.
        probability: float64 `[stochastic rows, outcomes]`.
        mask: `[states]`, of the type of `mask_type`.
        held: bool `[states, items]`.
        starts: int32 `[starts]`.
        limit: the time limit in steps.
        discount: the discount.
        observations: the observations of all states.
    """

    next_state: NDArray[Any]
    reward: NDArray[Any]
    outcome: NDArray[Any]
    drawn: tuple[NDArray[Any], ...]
    threshold: NDArray[Any]
    probability: NDArray[Any]
    mask: NDArray[Any]
    held: NDArray[Any]
    starts: NDArray[Any]
    limit: int
    discount: float
    observations: ObservationTables


def arrays_of(
    part: Part,
    exits: NDArray[np.bool_],
    limit: int,
    discount: float,
    observations: ObservationTables,
) -> LevelArrays:
    """Return a level as arrays.

    Args:
        part: the level, as the other engines have it.
        exits: bool `[states]`: in which states the robot is at an open exit.
        limit: its time limit, `NO_LIMIT` for none.
        discount: its discount.
        observations: the observations of its states.
    """
    num_actions = part.count.size // part.state_info.size
    is_drawn = part.count > 1
    last = part.count[is_drawn] - 1
    width = int(last.max(initial=0)) + 1
    columns: tuple[NDArray[Any], ...] = (
        part.columns["next_state"].astype(np.int32),
        part.columns["reward"],
        _outcomes(part, exits),
    )
    which = np.minimum(np.arange(width), last[:, None])
    next_state, reward, outcome = (column[:, 0].copy() for column in columns)
    next_state[is_drawn] = -1 - np.arange(last.size)
    cumulated = np.minimum(part.threshold[is_drawn, :width], 1.0)
    return LevelArrays(
        next_state=next_state,
        reward=reward,
        outcome=outcome,
        drawn=tuple(np.take_along_axis(column[is_drawn], which, axis=1) for column in columns),
        threshold=thresholds(cumulated[:, :-1]),
        probability=np.diff(cumulated, axis=1, prepend=0.0),
        mask=_mask_bits(part.state_info, num_actions),
        held=part.held,
        starts=part.starts.astype(np.int32),
        limit=min(limit, UNLIMITED) if limit < NO_LIMIT else UNLIMITED,
        discount=discount,
        observations=observations,
    )


def _outcomes(part: Part, exits: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """Return outcomes as sums of `TERMINAL`, `HIT`, `REACHED`, `SKIDDED` and `EXIT`."""
    infos = part.columns["outcome_info"].view(info_dtype(part.count.size // part.state_info.size))
    told: NDArray[np.uint8] = infos["end"] + REACHED * infos["reached"].view(np.uint8)
    told += SKIDDED * infos["skidded"].view(np.uint8)
    told += EXIT * (exits[part.columns["next_state"]] & ((told & TERMINAL) > 0)).view(np.uint8)
    return told


def mask_type(num_actions: int) -> np.dtype[Any]:
    """Return the type of action masks with a bit for each action, of several robots of each."""
    if num_actions > MOST_ACTIONS:
        return np.dtype(np.uint32)
    return np.dtype(np.uint8 if num_actions <= 8 else np.uint16)


def _mask_bits(state_info: NDArray[np.uint64], num_actions: int) -> NDArray[Any]:
    """Return action masks as bits, `[states]`; of several robots, bit 4 i + k for action i of k."""
    if num_actions > MOST_ACTIONS:
        robots = masks_of(state_info, NUM_ACTIONS).astype(np.uint32)
        return robots @ (1 << MOST_ROBOTS * np.arange(NUM_ACTIONS, dtype=np.uint32))
    bits = masks_of(state_info, num_actions) @ (1 << np.arange(num_actions))
    return bits.astype(mask_type(num_actions))


def build(
    levels: Sequence[LevelArrays],
    room: Room,
    num_actions: int,
    num_items: int,
    *,
    has_movers: bool,
    draws_levels: bool,
) -> EnvParams:
    """Return levels as one set of arrays. What is not used of the room is terminal states.

    Args:
        levels: the levels.
        room: the size of the arrays.
        num_actions: how many actions there are.
        num_items: how many items `held` tells of.
        has_movers: whether a level can have movers.
        draws_levels: whether each episode draws its level.
    """
    states, branches, width = room.total.states, room.total.branches, room.outcomes
    rows = states * num_actions
    next_state = np.zeros(rows + branches * width, np.int32)
    next_state[:rows] = np.arange(rows) // num_actions
    reward = np.zeros(next_state.size)
    outcome = np.full(next_state.size, TERMINAL, np.uint8)
    outcomes: tuple[NDArray[Any], ...] = next_state, reward, outcome
    threshold = np.full((branches, width - 1), NEVER)
    probability = np.zeros((branches, width))
    mask = np.zeros(states, mask_type(num_actions))
    held = np.zeros((states, num_items), np.bool_)
    starts = np.zeros(room.total.starts, np.int32)
    offset = [*accumulate((level.mask.size for level in levels), initial=0)]
    first_branch = [*accumulate((len(level.probability) for level in levels), initial=0)]
    first_start = [*accumulate((level.starts.size for level in levels), initial=0)]
    for level, base, branch, start in zip(levels, offset, first_branch, first_start, strict=False):
        begin, count, own = base * num_actions, len(level.probability), level.probability.shape[1]
        here = slice(begin, begin + level.next_state.size)
        is_drawn = level.next_state < 0
        next_state[here] = level.next_state + np.where(is_drawn, -branch, base)
        reward[here], outcome[here] = level.reward, level.outcome
        drawn = slice(rows + branch * width, rows + (branch + count) * width)
        for array, column in zip(outcomes, level.drawn, strict=True):
            array[drawn] = np.pad(column, ((0, 0), (0, width - own)), "edge").reshape(-1)
        next_state[drawn] += base
        threshold[branch : branch + count, : own - 1] = level.threshold
        probability[branch : branch + count, :own] = level.probability
        mask[base : base + level.mask.size] = level.mask
        held[base : base + level.mask.size, : level.held.shape[1]] = level.held
        starts[start : start + level.starts.size] = level.starts + base
    floats = jnp.result_type(float)
    return EnvParams(
        next_state=jnp.asarray(next_state),
        reward=jnp.asarray(reward, floats),
        outcome=jnp.asarray(outcome),
        threshold=jnp.asarray(threshold),
        probability=jnp.asarray(probability, floats),
        mask=jnp.asarray(mask),
        held=jnp.asarray(held),
        offset=jnp.asarray(offset, jnp.int32),
        first_branch=jnp.asarray(first_branch, jnp.int32),
        starts=jnp.asarray(starts),
        first_start=jnp.asarray(first_start, jnp.int32),
        limit=jnp.asarray([level.limit for level in levels], jnp.int32),
        discount=jnp.asarray([level.discount for level in levels], floats),
        number=jnp.arange(len(levels), dtype=jnp.int32),
        weights=None,
        observations=joined([level.observations for level in levels], room),
        num_actions=num_actions,
        most_outcomes=width,
        sizes=(room.most.states, room.most.branches, room.most.starts),
        draws_levels=draws_levels,
        draws_outcomes=width > 1,
        draws_starts=room.most.starts > 1,
        has_movers=has_movers,
    )
