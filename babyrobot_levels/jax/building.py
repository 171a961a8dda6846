"""Building tables: each level as arrays of its own, then all of them in one set of arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Any

import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.envs.engine.tables import NO_LIMIT, Part, info_dtype
from babyrobot_levels.jax.observations import ObservationTables, joined
from babyrobot_levels.jax.params import REACHED, SKIDDED, TERMINAL, UNLIMITED, EnvParams
from babyrobot_levels.jax.room import Room
from babyrobot_levels.jax.words import NEVER, thresholds


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
        mask: uint8 `[states]`.
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
    part: Part, limit: int, discount: float, observations: ObservationTables
) -> LevelArrays:
    """Return a level as arrays.

    Args:
        part: the level, as the other engines have it.
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
        _outcomes(part.columns["outcome_info"], num_actions),
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


def _outcomes(words: NDArray[np.uint64], num_actions: int) -> NDArray[np.uint8]:
    """Return info words as sums of `TERMINAL`, `HIT`, `REACHED` and `SKIDDED`."""
    infos = words.view(info_dtype(num_actions))
    told: NDArray[np.uint8] = infos["end"] + REACHED * infos["reached"].view(np.uint8)
    return told + SKIDDED * infos["skidded"].view(np.uint8)


def _mask_bits(state_info: NDArray[np.uint64], num_actions: int) -> NDArray[np.uint8]:
    """Return action masks as bits, uint8 `[states]`."""
    masks = state_info.view(info_dtype(num_actions))["mask"]
    bits: NDArray[np.uint8] = np.packbits(masks.view(np.uint8), axis=1, bitorder="little")[:, 0]
    return bits


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
    mask = np.zeros(states, np.uint8)
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
