"""The tables of levels as a pytree: what is passed to every step, and can be exchanged.

The states of all levels are numbered one after the other. Without padding, a level takes as much
room as it has states, however large the others are.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.tree_util import register_dataclass
from numpy.typing import NDArray

from babyrobot_levels.jax.observations import ObservationTables

TERMINAL, HIT, REACHED, SKIDDED, EXIT = 1, 2, 4, 8, 16
"""The bits of what is told of an outcome; `EXIT` is for episodes that end at an exit."""

UNLIMITED = np.iinfo(np.int32).max
"""The time limit of levels without one."""

_WEIGHTS = 2**30
"""What cumulated weights come to, about: products with words have 62 bits."""


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
        outcome: uint8, as `next_state`: the sum of `TERMINAL`, `HIT`, `REACHED`, `SKIDDED` and
            `EXIT`.
        threshold: uint32 `[stochastic rows, most outcomes - 1]`: a word that is above k of these
            thresholds draws outcome k.
        probability: float, `[stochastic rows, most outcomes]`: the exact probabilities, of which
            the thresholds are those that 32 bits can tell apart; 0 for outcomes that do not exist.
        mask: uint8 `[states]`, or uint16 if there are more than eight actions: the action mask,
            bit i for action i; of several robots uint32, bit 4 i + k for action i of robot k.
        held: bool `[states, items]`: which items are held.
        offset: int32 `[levels + 1]`: where each level's states begin.
        first_branch: int32 `[levels + 1]`: where its stochastic rows begin.
        starts: int32 `[starts]`: the states in which episodes start.
        first_start: int32 `[levels + 1]`: where each level's starts begin.
        limit: int32 `[levels]`: the time limit in steps, `UNLIMITED` for none.
        discount: float `[levels]`: the level's discount.
        number: int32 `[levels]`: the number that infos have as `level_index`.
        weights: int32 `[levels]`: cumulated weights, in proportion to which levels are drawn at
            resets; None if all are drawn equally often.
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
    def allowed(self) -> Array:
        """Which actions nothing refuses, bool `[states, actions]`."""
        bits = self.mask[:, None] >> jnp.arange(self.num_actions, dtype=self.mask.dtype)
        return (bits & 1) > 0

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
            weights: `[levels]`, none below 0 and one at least above it. A share of less than
                one in 2**30 counts as 0. In compiled code, only their shape is checked.

        Raises:
            ValueError: they are none.
        """
        given = jnp.asarray(weights, self.reward.dtype)
        if given.shape[-1:] != (self.num_levels,):
            raise ValueError(
                f"weights must be one for each of the {self.num_levels:,} levels, not an array of "
                f"shape {list(given.shape)}"
            )
        shares = given / jnp.sum(given, axis=-1, keepdims=True)
        whole = jnp.cumsum((shares * _WEIGHTS).astype(jnp.int32), axis=-1, dtype=jnp.int32)
        is_right = jnp.all((given >= 0) & (given < jnp.inf)) & jnp.all(whole[..., -1] > 0)
        if not isinstance(is_right, jax.core.Tracer) and not is_right:
            raise ValueError("weights must be finite, none of them below 0, and one above it")
        return replace(self, weights=whole)

    def drawn_level(self, word: Array) -> Array:
        """Return the level that a word draws, int32."""
        if self.weights is None:
            return below(word, jnp.int32(self.num_levels))
        place = below(word, self.weights[-1])
        return jnp.searchsorted(self.weights, place, side="right").astype(jnp.int32)

    @jax.jit
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
        base, num_states = self.offset[level], self.offset[level + 1] - self.offset[level]
        first_branch = self.first_branch[level]
        num_branches = self.first_branch[level + 1] - first_branch
        first_start = self.first_start[level]
        num_starts = self.first_start[level + 1] - first_start

        def of(array: Array, where: Array) -> Array:
            return array.at[where].get(mode="clip")

        row, drawn = jnp.arange(states * actions), jnp.arange(branches * width)
        entries = jnp.concatenate(
            [base * actions + row, self.num_rows + first_branch * width + drawn]
        )
        # What follows in the arrays is of other levels: it becomes terminal states.
        is_own = jnp.concatenate([row < num_states * actions, drawn < num_branches * width])
        itself = jnp.concatenate([row // actions, jnp.zeros_like(drawn)])
        next_state = of(self.next_state, entries)
        moved = jnp.where(next_state < 0, next_state + first_branch, next_state - base)
        here, branch = jnp.arange(states), first_branch + jnp.arange(branches)
        zero = jnp.zeros_like(base)
        return replace(
            self,
            next_state=jnp.where(is_own, moved, itself).astype(jnp.int32),
            reward=jnp.where(is_own, of(self.reward, entries), 0.0),
            outcome=jnp.where(is_own, of(self.outcome, entries), np.uint8(TERMINAL)),
            threshold=of(self.threshold, branch),
            probability=of(self.probability, branch),
            mask=jnp.where(here < num_states, of(self.mask, base + here), 0),
            held=of(self.held, base + here),
            offset=jnp.stack([zero, num_states]),
            first_branch=jnp.stack([zero, num_branches]),
            starts=of(self.starts, first_start + jnp.arange(starts)) - base,
            first_start=jnp.stack([zero, num_starts]),
            limit=self.limit[level][None],
            discount=self.discount[level][None],
            number=self.number[level][None],
            weights=None,
            observations=self.observations.take(level, base, states),
            draws_levels=False,
        )


# -- randomness as words ---------------------------------------------------------------------

# Comparing and scaling words of 32 bits is exact, whatever floats are in use. A word w stands for
# the draw `w / 2**32`, from 0 up to but not including 1.

NEVER = np.uint32(2**32 - 1)
"""The largest word: no word is above this threshold."""

_HALF = 16
_LOW = 2**_HALF - 1


def draw_words(key: Array, count: int) -> Array:
    """Return words, uint32 `[count]`; without randomness if none are needed."""
    if not count:
        return jnp.zeros(0, jnp.uint32)
    return jax.random.bits(key, (count,), jnp.uint32)


def below(word: Array, count: Array) -> Array:
    """Return a whole number below a count, int32: the draw times the count, rounded down.

    Args:
        word: uint32.
        count: at least 1.
    """
    count = jnp.asarray(count).astype(jnp.uint32)
    high, low = word >> _HALF, word & _LOW
    count_high, count_low = count >> _HALF, count & _LOW
    # The upper half of a product of 64 bits, from products of 32 bits.
    middle = high * count_low + (low * count_low >> _HALF)
    carried = low * count_high + (middle & _LOW)
    return (high * count_high + (middle >> _HALF) + (carried >> _HALF)).astype(jnp.int32)


def thresholds(cumulated: NDArray[np.float64]) -> NDArray[np.uint32]:
    """Return the largest word whose draw is below each of some cumulated probabilities.

    Args:
        cumulated: float64, above 0.
    """
    least_not_below = np.ceil(np.minimum(cumulated, 1.0) * 2.0**32)
    return (least_not_below - 1).astype(np.uint32)


def chosen(word: Array, limits: Array) -> Array:
    """Return how many of some rising thresholds a word is above, int32."""
    return jnp.sum(word > limits, axis=-1, dtype=jnp.int32)
