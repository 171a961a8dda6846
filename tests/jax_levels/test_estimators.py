"""Estimates of what is to be learnt, against their definitions on a few steps."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.typing import NDArray

import babyrobot_levels.jax as brl_jax

LEVELS = jnp.array([[0, 2, 0], [0, 2, 2]])


def test_positive_value_loss_is_the_mean_of_the_positive_parts() -> None:
    advantages = jnp.array([[1.0, -4.0, -2.0], [5.0, 3.0, 0.5]])
    found = jax.jit(brl_jax.positive_value_loss, static_argnums=2)(advantages, LEVELS, 3)
    np.testing.assert_allclose(found, [6 / 3, np.nan, 3.5 / 3], rtol=1e-6)


def test_max_monte_carlo_is_what_values_are_short_of_the_highest_return() -> None:
    values = jnp.array([[-3.0, 1.0, -6.0], [0.0, 2.0, 3.0]])
    highest = jnp.array([-1.0, 0.0, 4.0])
    found = brl_jax.max_monte_carlo(values, LEVELS, highest)
    np.testing.assert_allclose(found, [-1 + 3, np.nan, 4 - 2], rtol=1e-6)


def mixed_losses(errors: NDArray[np.float32], discount: float, decay: float) -> float:
    """Return what is lost from the first of some steps on, mixed as its definition says."""
    sums = np.cumsum(errors * discount ** np.arange(len(errors)))
    below = np.maximum.accumulate(np.maximum(sums, 0)) - sums
    weights = (1 - decay) * decay ** np.arange(len(errors))
    weights[-1] = decay ** (len(errors) - 1)
    return float(weights @ below)


@pytest.mark.parametrize("decay", [0.0, 0.9, 1.0])
def test_maximised_negative_advantage_is_the_mean_of_what_is_lost(decay: float) -> None:
    errors = np.random.default_rng(1).normal(size=(7, 2)).astype(np.float32)
    dones = np.zeros((7, 2), bool)
    dones[2, 0] = dones[5, 1] = True
    levels = np.array([[0] * 3 + [2] * 4, [1] * 6 + [2]]).T
    lost: tuple[list[float], ...] = ([], [], [])
    for env, end in ((0, 3), (0, 7), (1, 6), (1, 7)):
        begin = 0 if end in (3, 6) else end - (4 if env == 0 else 1)
        for step in range(begin, end):
            followed = mixed_losses(errors[step:end, env], 0.9, decay)
            lost[levels[step, env]].append(followed)
    found = jax.jit(brl_jax.maximised_negative_advantage)(
        errors, dones, levels, jnp.array([True, False, True]), discount=0.9, decay=decay
    )
    np.testing.assert_allclose(
        found, [float(np.mean(lost[0])), 0, float(np.mean(lost[2]))], rtol=1e-5
    )


def test_learnability_is_that_of_the_share_of_successes() -> None:
    successes = jnp.array([[True, True, False], [False, True, True]])
    found = brl_jax.learnability(successes, LEVELS, 3)
    np.testing.assert_allclose(found, [2 / 9, np.nan, 0], atol=1e-6)
