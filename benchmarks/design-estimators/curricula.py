"""Curricula by what levels are drawn by, with all seeds at once; the loop is of accel_jax.py."""

from __future__ import annotations

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
from accel_jax import Curriculum
from jax import Array
from ppo_jax import Figures, Scale, figures_of

CURRICULA = (
    ("dr", "regret"),
    ("plr", "regret"),
    ("accel", "regret"),
    ("accel", "maxmc"),
    ("plr", "maxmc"),
    ("accel", "learnability"),
    ("plr", "learnability"),
)
"""Methods and scores, in the order in which they are run; `dr` has no use for a score."""


@partial(jax.jit, static_argnames="curriculum")
def start(keys: Array, *, curriculum: Curriculum) -> Any:
    """Return a new learner and a buffer of new levels for each key."""

    def of_seed(key: Array) -> Any:
        learner_key, buffer_key = jax.random.split(key)
        return curriculum.learner.new(learner_key), curriculum.start(buffer_key)

    return jax.vmap(of_seed)(keys)


@partial(jax.jit, static_argnames="curriculum")
def stage(
    carry: Any, keys: Array, scales: list[Scale], *, curriculum: Curriculum
) -> tuple[Any, list[Figures], Array]:
    """Learn for some updates; then evaluate exactly.

    Args:
        carry: the learner and the buffer of each seed.
        keys: `[seeds, updates]`.
        scales: the levels to be tested on.
        curriculum: the curriculum.

    Returns:
        What the next stage goes on with; for each test the `Figures`, `[seeds]`; and how many
        walls the levels in the buffer have on average, `[seeds]`.
    """

    def of_seed(carry: Any, keys: Array) -> Any:
        (state, buffer), _ = jax.lax.scan(curriculum.update, carry, keys)
        learner = curriculum.learner
        figures = [
            figures_of(learner.returns(state.weights, scale.params), scale) for scale in scales
        ]
        walls = buffer.layouts.walls.sum(axis=(1, 2, 3)).astype(jnp.float32).mean()
        return (state, buffer), figures, walls

    return jax.vmap(of_seed)(carry, keys)
