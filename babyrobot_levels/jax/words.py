"""Randomness as words of 32 bits: comparing and scaling them is exact, whatever floats are in use.

A word w stands for the draw `w / 2**32`, from 0 up to but not including 1.
"""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from numpy.typing import NDArray

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
