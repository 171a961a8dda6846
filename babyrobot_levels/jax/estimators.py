"""Published estimates of what is to be learnt in levels, from rollouts, to compare with `regret`.

All are of steps or episodes that are grouped by the numbers of their levels, such as `level_index`
of infos. A level that does not occur has nan.
"""

from __future__ import annotations

import jax
import jax.numpy as jnp
from jax import Array


def positive_value_loss(advantages: Array, levels: Array, num_levels: int) -> Array:
    """Return the mean of the advantages, those below 0 counted as 0, float `[levels]`.

    With generalised advantage estimates, it is the positive value loss of M. Jiang et al.:
    Replay-Guided Adversarial Environment Design (2021).

    Args:
        advantages: float `[…]`: the estimate of each step.
        levels: int `[…]`: the level of each step.
        num_levels: how many levels there are.
    """
    return _means(jnp.maximum(advantages, 0), levels, num_levels)


def max_monte_carlo(values: Array, levels: Array, highest: Array) -> Array:
    """Return by how much values are below the highest return of their level, float `[levels]`.

    It is MaxMC of the same paper.

    Args:
        values: float `[…]`: the estimated value of the state of each step.
        levels: int `[…]`: the level of each step.
        highest: float `[levels]`: the highest return of an episode in each level so far.
    """
    return highest - _means(values, levels, highest.shape[0])


def learnability(successes: Array, levels: Array, num_levels: int) -> Array:
    """Return p(1 - p) for the share p of episodes that succeeded, float `[levels]`.

    After A. Rutherford et al.: No Regrets: Investigating and Improving Regret Approximations for
    Curriculum Discovery (2024).

    Args:
        successes: bool `[…]`: whether each episode succeeded.
        levels: int `[…]`: the level of each episode.
        num_levels: how many levels there are.
    """
    share = _means(successes.astype(jnp.result_type(float)), levels, num_levels)
    return share * (1 - share)


def _means(values: Array, levels: Array, num_levels: int) -> Array:
    """Return the mean of the values of each level."""
    flat = levels.reshape(-1)
    total = jax.ops.segment_sum(values.reshape(-1), flat, num_levels)
    return total / jax.ops.segment_sum(jnp.ones(flat.shape, total.dtype), flat, num_levels)
