"""Levels in the wrappers of gymnax and JaxUED, which have other interfaces."""

from __future__ import annotations

import sys
from functools import partial
from typing import Any

import gymnax.wrappers
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from gymnax.experimental.rollout import RolloutWrapper

import babyrobot_levels as brl
import babyrobot_levels.jax as brl_jax

EAST = 2
CORRIDOR = {
    "version": 1,
    "size": [3, 1],
    "start": [0, 0],
    "exit": [2, 0],
    "rewards": {"exit": 5},
    "max_steps": 3,
}
"""Two steps east to the exit; three steps are the limit."""


def key(number: int = 0) -> jax.Array:
    return jax.random.key(number)


def same(one: Any, other: Any) -> bool:
    return bool(jax.tree.all(jax.tree.map(np.array_equal, one, other)))


# -- gymnax ----------------------------------------------------------------------------------


def test_the_five_values_of_older_gymnax() -> None:
    env, params = brl_jax.make(CORRIDOR)
    old = gymnax.wrappers.LegacyStepAPIWrapper(env)
    _, state = old.reset(key(), params)
    dones = []
    for action in (EAST, EAST, 0, 0, 0):
        told = old.step(key(), state, action, params)
        wanted = env.step(key(), state, action, params)
        assert same(told[:3], wanted[:3])
        assert same(told[4], wanted[5])
        state = told[1]
        dones.append((bool(told[3]), bool(told[4]["terminated"])))
    # At the exit, and then at the limit.
    assert dones == [(False, False), (True, True), (False, False), (False, False), (True, False)]


@pytest.mark.parametrize("observation", ["index", ("view", "position")])
def test_gymnasium_environments(observation: Any) -> None:
    env, params = brl_jax.make("final-maze", observation=observation)
    theirs = brl.load("final-maze").make(observation=observation)
    one = gymnax.wrappers.GymnaxToGymWrapper(env, params)
    several = gymnax.wrappers.GymnaxToVectorGymWrapper(env, 3, params)
    assert one.action_space == theirs.action_space
    shown, _ = one.reset(seed=1)
    assert same(shown, theirs.reset()[0])
    assert as_arrays(shown) in one.observation_space
    assert as_arrays(several.reset(seed=1)[0]) in several.observation_space
    shown, reward, terminated, truncated, info = one.step(0)
    assert as_arrays(shown) in one.observation_space
    assert (reward, terminated, truncated) == (-1, False, False)
    assert same(info["action_mask"], theirs.step(0)[4]["action_mask"])
    shown, rewards, *_ = several.step(np.zeros(3, int))
    assert as_arrays(shown) in several.observation_space
    assert rewards.tolist() == [-1, -1, -1]


def as_arrays(told: Any) -> Any:
    return jax.tree.map(np.asarray, told)


def test_wrappers_that_flatten_and_log() -> None:
    env, params = brl_jax.make(CORRIDOR, observation="view", view_radius=1)
    wrapped = gymnax.wrappers.LogWrapper(gymnax.wrappers.FlattenObservationWrapper(env))
    shape = env.observation_space(params).shape
    assert wrapped.observation_space(params).shape == (np.prod(shape),)

    def step(state: Any, key: Any) -> Any:
        shown, state, *_, info = wrapped.step(key, state, EAST, params)
        return state, (shown, info)

    first, state = wrapped.reset(key(), params)
    _, (shown, info) = jax.lax.scan(step, state, jax.random.split(key(), 4))
    assert first.shape == (np.prod(shape),)
    assert info["final_observation"].shape == shown.shape == (4, np.prod(shape))
    assert info["returned_episode"].tolist() == [False, True, False, True]
    assert info["returned_episode_returns"].tolist() == [0, 4, 4, 4]
    assert info["returned_episode_lengths"].tolist() == [0, 2, 2, 2]


def test_dm_env() -> None:
    env, params = brl_jax.make(CORRIDOR, observation="view")
    wrapped = gymnax.wrappers.GymnaxToDmEnvWrapper(env)
    first = wrapped.reset(key(), params)
    _, steps = jax.lax.scan(
        lambda before, each: (wrapped.step(each, before, EAST, params),) * 2,
        first,
        jax.random.split(key(), 2),
    )
    assert steps.reward.tolist() == [-1, 5]
    assert steps.discount.tolist() == [1, 0]
    assert same(steps.observation[-1], first.observation)
    assert not same(steps.final_observation[-1], first.observation)


def test_rollouts_of_gymnax() -> None:
    env, _ = brl_jax.make(CORRIDOR, observation="index")
    east = RolloutWrapper(lambda policy, shown, key: policy[shown], env=env)
    policies = jnp.array([[EAST] * 3, [0] * 3])
    *_, returns = east.population_rollout(jax.random.split(key(), 2), policies)
    assert returns[..., 0].tolist() == [[4, 4], [-3, -3]]


# -- JaxUED ----------------------------------------------------------------------------------


@pytest.fixture
def jaxued(monkeypatch: pytest.MonkeyPatch) -> Any:
    """JaxUED 0.0.1, which uses a name that JAX 0.6 has removed."""
    monkeypatch.setattr(jax, "tree_map", jax.tree.map, raising=False)
    for module in ("level_sampler", "utils", "wrappers"):
        pytest.importorskip(f"jaxued.{module}")
    return sys.modules["jaxued"]


@pytest.fixture(scope="module")
def suite() -> tuple[brl_jax.UnderspecifiedEnv, brl_jax.EnvParams]:
    levels = brl.load_suite("small-mazes")[:12]
    env, params = brl_jax.make([level.replace(max_steps=8) for level in levels])
    return brl_jax.UnderspecifiedEnv(env), params


def test_a_level_is_replayed_when_it_is_over(jaxued: Any, suite: Any) -> None:
    env, params = suite
    wrapped = jaxued.wrappers.AutoReplayWrapper(env)
    levels = jnp.array([3, 7])
    first, state = jax.vmap(partial(wrapped.reset_to_level, key()))(levels)
    for _ in range(8):
        shown, state, _, done, info = jax.vmap(wrapped.step, in_axes=(None, 0, None))(
            key(), state, 0
        )
    assert done.all()
    assert info["truncated"].all()
    assert same(shown, first)
    assert state.env_state.time.tolist() == [0, 0]
    assert state.env_state.level.tolist() == info["level_index"].tolist() == levels.tolist()
    assert wrapped.action_space(params).n == 5


def test_another_level_is_drawn_when_one_is_over(jaxued: Any, suite: Any) -> None:
    env, params = suite

    def draw(rng: jax.Array) -> jax.Array:
        return jax.random.randint(rng, (), 0, params.num_levels)

    wrapped = jaxued.wrappers.AutoResetWrapper(env, draw)

    def step(state: Any, rng: jax.Array) -> Any:
        _, state, *_ = wrapped.step(rng, state, 0, params)
        return state, (state.env_state.level, state.env_state.time)

    # JaxUED joins these keys with one of the older kind.
    rng = jax.random.PRNGKey(2)
    _, state = wrapped.reset_to_level(rng, 5, params)
    _, (levels, times) = jax.lax.scan(step, state, jax.random.split(rng, 8 * 20))
    assert times.tolist() == [1, 2, 3, 4, 5, 6, 7, 0] * 20
    assert (levels[:7] == 5).all()
    assert len(np.unique(levels)) > 6
