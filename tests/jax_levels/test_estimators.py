"""Estimates of what is to be learnt, against their definitions on a few steps."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np

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


def test_learnability_is_that_of_the_share_of_successes() -> None:
    successes = jnp.array([[True, True, False], [False, True, True]])
    found = brl_jax.learnability(successes, LEVELS, 3)
    np.testing.assert_allclose(found, [2 / 9, np.nan, 0], atol=1e-6)
