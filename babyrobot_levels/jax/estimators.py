"""Published estimates of what is to be learnt in levels, from rollouts, to compare with `regret`.

All are of steps or episodes that are grouped by the numbers of their levels, such as `level_index`
of infos. A level that does not occur has nan.
"""

from __future__ import annotations

from typing import Any

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


def maximised_negative_advantage(
    errors: Array, dones: Array, levels: Array, solved: Array, *, discount: float, decay: float
) -> Array:
    """Return the mean of what is lost against the best that was expected, float `[levels]`.

    From each step on, the advantages of n-step returns are followed: how far each is below the
    highest of those before it, 0 among them, is a loss. The losses are mixed as in a lambda-return,
    and averaged over the steps. Levels that were never solved have 0.

    It is the maximised negative advantage (MNA) of H. Mead et al.: Improving Regret Approximation
    for Unsupervised Dynamic Environment Generation (2026), where it is a mean over time. It takes
    steps times steps.

    Args:
        errors: float `[steps, envs]`: the temporal difference error of each step.
        dones: bool `[steps, envs]`: whether the episode ended with it.
        levels: int `[steps, envs]`: the level of each step.
        solved: bool `[levels]`: whether an episode in the level has succeeded so far.
        discount: the discount factor.
        decay: the lambda of the mixture, from 0 to 1.
    """
    steps = jnp.arange(len(errors))

    def follow(carry: tuple[Array, Array, Array], now: tuple[Array, Array, Array]) -> Any:
        """Add a step to what is followed from each step, `[steps, envs]`."""
        below, lost, goes_on = carry
        step, error, done = now
        age = jnp.maximum(step - steps, 0)[:, None]
        counts = goes_on & (steps <= step)[:, None]
        change = jnp.minimum(below + discount**age * error, 0) - below
        change = jnp.where(counts, change, 0)
        return (below + change, lost - decay**age * change, goes_on & ~(counts & done)), None

    nothing = jnp.zeros_like(errors)
    (_, lost, _), _ = jax.lax.scan(
        follow, (nothing, nothing, jnp.ones(errors.shape, bool)), (steps, errors, dones)
    )
    return jnp.where(solved, _means(lost, levels, len(solved)), 0)


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
