"""The tables of levels as a pytree: what is passed to every step, and can be exchanged.

The states of all levels are numbered one after the other. Without padding, a level takes as much
room as it has states, however large the others are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.tree_util import register_dataclass
from numpy.typing import NDArray

from babyrobot_levels.envs.engine.tables import (
    NO_LIMIT,
    Part,
    info_dtype,
)
from babyrobot_levels.jax.observations import ObservationTables
from babyrobot_levels.jax.words import NEVER, below, thresholds

TERMINAL, HIT, REACHED, SKIDDED = 1, 2, 4, 8
"""The bits of what is told of an outcome."""

UNLIMITED = np.iinfo(np.int32).max
"""The time limit of levels without one."""

MAX_BYTES = 4 * 2**30
"""How much memory tables may take, by default."""


@register_dataclass
@dataclass(frozen=True)
class EnvParams:
    """Levels as arrays; see `babyrobot_levels.jax.make`.

    An action is looked up in row `state * num_actions + action`. Where it has several outcomes,
    `next_state` has `-1 - n`, with the number n of a stochastic row. Outcome k of this row is entry
    `rows + n * most_outcomes + k` of `next_state`, `reward` and `outcome`.

    Attributes:
        next_state: int32 `[rows + stochastic rows * most outcomes]`.
        reward: float32 (float64 with JAX's x64 mode), as `next_state`.
        outcome: uint8, as `next_state`: the sum of `TERMINAL`, `HIT`, `REACHED` and `SKIDDED`.
        threshold: uint32 `[stochastic rows, most outcomes - 1]`: a word that is not below the
            first k of these thresholds, and below the next, draws outcome k.
        probability: float, `[stochastic rows, most outcomes]`: the exact probabilities, of which
            the thresholds are those that 32 bits can tell apart; 0 for outcomes that do not exist.
        mask: uint8 `[states]`: the action mask, bit i for action i.
        held: bool `[states, items]`: which items are held.
        offset: int32 `[levels + 1]`: where each level's states begin.
        first_branch: int32 `[levels + 1]`: where its stochastic rows begin.
        starts: int32 `[starts]`: the states in which episodes start.
        first_start: int32 `[levels + 1]`: where each level's starts begin.
        limit: int32 `[levels]`: the time limit in steps, `UNLIMITED` for none.
        discount: float `[levels]`: the level's discount.
        number: int32 `[levels]`: the number that infos have as `level_index`.
        weights: uint32 `[levels - 1]`: cumulated chances of levels at resets, None if all are
            drawn equally often.
        observations: the observation of each state.
        num_actions: how many actions there are.
        most_outcomes: the most outcomes of an action.
        sizes: the most states, stochastic rows and starts of a level.
        draws_levels: whether each episode draws its level; if not, an environment stays in it.
        draws_outcomes: whether there are stochastic rows.
        draws_starts: whether a level has several starts.
        has_movers: whether a level has movers.
    """

    next_state: Array
    reward: Array
    outcome: Array
    threshold: Array
    probability: Array
    mask: Array
    held: Array
    offset: Array
    first_branch: Array
    starts: Array
    first_start: Array
    limit: Array
    discount: Array
    number: Array
    weights: Array | None
    observations: ObservationTables
    num_actions: int = field(metadata={"static": True})
    most_outcomes: int = field(metadata={"static": True})
    sizes: tuple[int, int, int] = field(metadata={"static": True})
    draws_levels: bool = field(metadata={"static": True})
    draws_outcomes: bool = field(metadata={"static": True})
    draws_starts: bool = field(metadata={"static": True})
    has_movers: bool = field(metadata={"static": True})

    @property
    def num_levels(self) -> int:
        """How many levels there are."""
        return int(self.limit.shape[-1])

    @property
    def num_states(self) -> int:
        """How many states there are, of all levels together."""
        return int(self.mask.shape[-1])

    @property
    def num_rows(self) -> int:
        """How many pairs of state and action there are."""
        return self.num_states * self.num_actions

    @property
    def max_steps_in_episode(self) -> Array:
        """The largest time limit of a level, under the name that gymnax uses."""
        return jnp.max(self.limit, axis=-1)

    @property
    def step_words(self) -> int:
        """How many words a step takes."""
        return int(self.draws_outcomes)

    @property
    def reset_words(self) -> int:
        """How many words a reset takes: one for the level, one for the start."""
        return int(self.draws_levels) + int(self.draws_starts)

    @property
    def nbytes(self) -> int:
        """How much memory the arrays take, in bytes."""
        return sum(leaf.nbytes for leaf in jax.tree.leaves(self))

    def weighted(self, weights: Any) -> EnvParams:
        """Return these levels, each drawn at resets with a probability proportional to its weight.

        Args:
            weights: `[levels]`, none below 0 and one at least above it.
        """
        cumulated = jnp.cumsum(jnp.asarray(weights, self.reward.dtype), axis=-1)
        share = cumulated[..., :-1] / cumulated[..., -1:]
        # The largest float32 below 1: 2**32 itself is no word.
        scaled = jnp.minimum(share, 1 - 2.0**-24) * 2.0**32
        words = jnp.where(share >= 1.0, NEVER, scaled.astype(jnp.uint32))
        return replace(self, weights=words)

    def drawn_level(self, word: Array) -> Array:
        """Return the level that a word draws, int32."""
        if self.weights is None:
            return below(word, jnp.int32(self.num_levels))
        return jnp.searchsorted(self.weights, word, side="right").astype(jnp.int32)

    def take(self, indices: Any) -> EnvParams:
        """Return single levels, along a first axis of all arrays, for `jax.vmap` over levels.

        Each of them has the room of the largest level, so that any can take the place of another
        without compiling anew. The indices may be traced.

        Args:
            indices: the numbers of the levels, `[n]`, or one number, for arrays without the axis.
        """
        indices = jnp.asarray(indices, jnp.int32)
        one = self._single
        for _ in range(indices.ndim):
            one = jax.vmap(one)
        return one(indices)

    def _single(self, level: Array) -> EnvParams:
        states, branches, starts = self.sizes
        actions, width = self.num_actions, self.most_outcomes
        base, first_branch = self.offset[level], self.first_branch[level]
        here = base + jnp.arange(states)
        rows = base * actions + jnp.arange(states * actions)
        entries = first_branch * width + jnp.arange(branches * width) + self.num_rows
        # Beyond its end, there is something of other levels, to which no state leads.
        picked = jnp.concatenate([rows, entries])
        next_state = self.next_state.at[picked].get(mode="clip")
        moved = jnp.where(next_state < 0, next_state + first_branch, next_state - base)
        first_start = self.first_start[level]
        count = self.first_start[level + 1] - first_start

        def of(array: Array, where: Array) -> Array:
            return array.at[where].get(mode="clip")

        return EnvParams(
            next_state=moved,
            reward=of(self.reward, picked),
            outcome=of(self.outcome, picked),
            threshold=of(self.threshold, first_branch + jnp.arange(branches)),
            probability=of(self.probability, first_branch + jnp.arange(branches)),
            mask=of(self.mask, here),
            held=of(self.held, here),
            offset=jnp.stack([jnp.zeros_like(base), self.offset[level + 1] - base]),
            first_branch=jnp.stack(
                [jnp.zeros_like(base), self.first_branch[level + 1] - first_branch]
            ),
            starts=of(self.starts, first_start + jnp.arange(starts)) - base,
            first_start=jnp.stack([jnp.zeros_like(count), count]),
            limit=self.limit[level][None],
            discount=self.discount[level][None],
            number=self.number[level][None],
            weights=None,
            observations=self.observations.take(level, base, states),
            num_actions=actions,
            most_outcomes=width,
            sizes=self.sizes,
            draws_levels=False,
            draws_outcomes=self.draws_outcomes,
            draws_starts=self.draws_starts,
            has_movers=self.has_movers,
        )


def params_of(
    parts: Sequence[Part],
    limits: Sequence[int],
    discounts: Sequence[float],
    observations: ObservationTables,
    draws_levels: bool,
) -> EnvParams:
    """Return the tables of levels.

    Args:
        parts: the levels.
        limits: the time limit of each level.
        discounts: the discount of each level.
        observations: the observations of all states.
        draws_levels: whether each episode draws its level.
    """
    offset = np.cumsum([0, *(part.state_info.size for part in parts)])
    branches = [int(np.count_nonzero(part.count > 1)) for part in parts]
    first_branch = np.cumsum([0, *branches])
    width = max(int(part.count.max(initial=1)) for part in parts)
    rows: dict[str, list[NDArray[Any]]] = {"next_state": [], "reward": [], "outcome": []}
    further: dict[str, list[NDArray[Any]]] = {name: [] for name in rows}
    cumulated = np.full((int(first_branch[-1]), width), 2.0)
    num_actions = parts[0].count.size // parts[0].state_info.size
    for part, base, branch in zip(parts, offset.tolist(), first_branch.tolist(), strict=False):
        is_stochastic = part.count > 1
        columns = {
            "next_state": part.columns["next_state"] + base,
            "reward": part.columns["reward"],
            "outcome": _outcomes(part.columns["outcome_info"], num_actions),
        }
        count, own = int(np.count_nonzero(is_stochastic)), part.threshold.shape[1]
        for name, column in columns.items():
            first = column[:, 0].copy()
            if name == "next_state":
                first[is_stochastic] = -1 - branch - np.arange(count)
            rows[name].append(first)
            padded = np.zeros((count, width), column.dtype)
            # Longer rows are padding.
            used = min(own, width)
            padded[:, :used] = column[is_stochastic][:, :used]
            further[name].append(padded.reshape(-1))
        cumulated[branch : branch + count, : min(own, width)] = part.threshold[
            is_stochastic, : min(own, width)
        ]
    tables = {name: np.concatenate([*rows[name], *further[name]]) for name in rows}
    starts = [part.starts + base for part, base in zip(parts, offset.tolist(), strict=False)]
    num_items = max(part.held.shape[1] for part in parts)
    held = np.zeros((offset[-1], num_items), np.bool_)
    for part, base in zip(parts, offset.tolist(), strict=False):
        held[base : base + len(part.held), : part.held.shape[1]] = part.held
    return EnvParams(
        next_state=jnp.asarray(tables["next_state"], jnp.int32),
        reward=jnp.asarray(tables["reward"], jnp.result_type(float)),
        outcome=jnp.asarray(tables["outcome"]),
        threshold=jnp.asarray(thresholds(cumulated[:, :-1])),
        probability=jnp.asarray(
            np.diff(np.minimum(cumulated, 1.0), axis=1, prepend=0.0), jnp.result_type(float)
        ),
        mask=jnp.asarray(np.concatenate([_mask_bits(part, num_actions) for part in parts])),
        held=jnp.asarray(held),
        offset=jnp.asarray(offset, jnp.int32),
        first_branch=jnp.asarray(first_branch, jnp.int32),
        starts=jnp.asarray(np.concatenate(starts), jnp.int32),
        first_start=jnp.asarray(np.cumsum([0, *map(len, starts)]), jnp.int32),
        limit=jnp.asarray(
            [UNLIMITED if limit == NO_LIMIT else min(limit, UNLIMITED) for limit in limits],
            jnp.int32,
        ),
        discount=jnp.asarray(discounts, jnp.result_type(float)),
        number=jnp.arange(len(parts), dtype=jnp.int32),
        weights=None,
        observations=observations,
        num_actions=num_actions,
        most_outcomes=width,
        sizes=(
            max(part.state_info.size for part in parts),
            max(branches),
            max(map(len, starts)),
        ),
        draws_levels=draws_levels,
        draws_outcomes=width > 1,
        draws_starts=any(len(each) > 1 for each in starts),
        has_movers=any(part.has_movers for part in parts),
    )


def _outcomes(words: NDArray[np.uint64], num_actions: int) -> NDArray[np.uint8]:
    """Return info words as sums of `TERMINAL`, `HIT`, `REACHED` and `SKIDDED`."""
    infos = words.view(info_dtype(num_actions))
    told: NDArray[np.uint8] = infos["end"] + REACHED * infos["reached"].view(np.uint8)
    return told + SKIDDED * infos["skidded"].view(np.uint8)


def _mask_bits(part: Part, num_actions: int) -> NDArray[np.uint8]:
    """Return action masks as bits, uint8 `[states]`."""
    masks = part.state_info.view(info_dtype(num_actions))["mask"]
    bits: NDArray[np.uint8] = (masks.astype(np.uint8) << np.arange(num_actions)).sum(axis=1)
    return bits.astype(np.uint8)


def shapes_of(params: EnvParams) -> dict[str, Any]:
    """Return what must be equal so that nothing is compiled anew: shapes and static values."""
    found: dict[str, Any] = {
        jax.tree_util.keystr(path): leaf.shape
        for path, leaf in jax.tree_util.tree_leaves_with_path(params)
    }
    for each in fields(params):
        if each.metadata.get("static"):
            found[each.name] = getattr(params, each.name)
    return found
