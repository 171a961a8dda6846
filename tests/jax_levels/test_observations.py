"""Observations in JAX are those of the vector environments, in every state."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from support.jax_walks import POOL

import babyrobot_levels as brl
import babyrobot_levels.jax as brl_jax

SMALL = [level for level in POOL if level.compile().num_states <= 200]
TWO_SIZES = [brl.load("default"), brl.load("first-key")]


@pytest.mark.parametrize("actions", ["all", "turns"])
@pytest.mark.parametrize(
    ("levels", "options"),
    [
        (POOL, {"observation": ("position", "index", "walls", "vector")}),
        (SMALL, {"observation": ("planes", "view")}),
        (
            TWO_SIZES,
            {
                "observation": ("planes", "view", "image"),
                "channels_last": True,
                "planes_dtype": "uint8",
                "view_radius": 2,
                "see_through": True,
                "image_size": (24, 30),
            },
        ),
        (TWO_SIZES, {"observation": "image", "image_size": (24, 30), "grayscale": True}),
    ],
    ids=["numbers", "arrays", "options", "grey"],
)
def test_observations_are_those_of_the_vector_environment(
    levels: Any, options: Any, actions: str
) -> None:
    env, params = brl_jax.make(levels, actions=actions, **options)
    vector = brl.LevelVectorEnv(levels=levels, actions=actions, **options)
    wanted = vector._observer.gather(np.arange(params.num_states))
    found = env.observations(params)
    assert jax.tree.structure(found) == jax.tree.structure(wanted)
    for one, other in zip(jax.tree.leaves(found), jax.tree.leaves(wanted), strict=True):
        assert np.array_equal(one, other)
    # One state at a time, and those of a single level.
    states = jnp.asarray([0, params.num_states - 1])
    each = jax.vmap(params.observations.at)(states)
    alone = params.take(len(levels) - 1)
    last = alone.observations.at(alone.offset[1] - 1)
    for one, two, of_all in zip(*map(jax.tree.leaves, (each, last, found)), strict=True):
        assert np.array_equal(one, of_all[states])
        assert np.array_equal(two, of_all[-1])
