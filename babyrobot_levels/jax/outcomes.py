"""The distinct outcomes of actions in compiled code, as the compiler has them."""

from __future__ import annotations

from functools import reduce

import jax.numpy as jnp
from jax import Array

from babyrobot_levels.jax.params import EXIT, NEVER, REACHED, SKIDDED, TERMINAL

WIDTH = 4
"""The most outcomes of an action: the four cells around."""


def merged(
    branches: list[tuple[Array, Array, Array]],
    over: Array,
    target: Array,
    intended: Array,
    is_refused: Array | None,
) -> dict[str, Array]:
    """Return the distinct outcomes of a row of each cell, in the order of the compiler.

    Args:
        branches: the chance, the next state and the reward of each, `[cells]`.
        over: in which states the episode is over.
        target: int32: the cell of the exit.
        intended: where the action leads without chance.
        is_refused: whether a wall refuses it.
    """
    chance, to, paid = (jnp.stack(each) for each in zip(*branches, strict=True))
    count = len(branches)
    alike = (to[:, None] == to) & (paid[:, None] == paid) & (chance > 0)
    is_first = (chance > 0) & ~jnp.stack(
        [reduce(jnp.logical_or, alike[k, :k], jnp.zeros_like(over)) for k in range(count)]
    )
    # The first one, and then the sum of the others: so NumPy adds them up.
    more = [
        reduce(jnp.add, (jnp.where(alike[k, n], chance[n], 0) for n in range(k + 1, count)), 0.0)
        for k in range(count)
    ]
    total = jnp.where(is_first, chance + jnp.stack([jnp.zeros(over.size) + m for m in more]), 0)
    # Sorting so few is slow in compiled code: each is put into its place.
    is_less = (to[:, None] < to) | ((to[:, None] == to) & (paid[:, None] < paid))
    place = (is_first[:, None] & is_less).sum(axis=0)
    found, number = is_first.sum(axis=0), jnp.arange(WIDTH)[:, None]
    is_there = is_first & (place == jnp.minimum(number, found - 1)[:, None])
    to, paid = (jnp.where(is_there, each, 0).sum(axis=1, dtype=each.dtype) for each in (to, paid))
    chance = jnp.where(is_first & (place == number[:, None]), total, 0).sum(axis=1)
    cumulated = jnp.stack([reduce(jnp.add, chance[: k + 1]) for k in range(WIDTH)])
    cumulated = jnp.where(number >= found - 1, 1.0, jnp.minimum(cumulated, 1.0))
    before = jnp.concatenate([jnp.zeros((1, over.size)), cumulated[:-1]])
    at_target = to == intended
    refused = jnp.zeros_like(over) if is_refused is None else is_refused
    outcome = TERMINAL * over[to] + REACHED * (at_target & ~refused) + SKIDDED * ~at_target
    outcome += EXIT * (to == target)
    # In float32, 2**32 - 1 is none of the numbers.
    word = jnp.ceil(jnp.where(cumulated < 1, cumulated, 0) * 2.0**32).astype(jnp.uint32) - 1
    return {
        "next_state": to.T,
        "reward": paid.T,
        "outcome": outcome.astype(jnp.uint8).T,
        "is_drawn": found > 1,
        "probability": (cumulated - before).T,
        "threshold": jnp.where(cumulated < 1, word, NEVER)[:-1].T,
    }
