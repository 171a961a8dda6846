"""Levels are environments as gymnax 1.0 defines them."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from gymnax.environments import environment

import babyrobot_levels as brl
import babyrobot_levels.jax as brl_jax

KEY = jax.random.key(0)


def test_an_episode_by_the_optimal_policy() -> None:
    level = brl.load("default")
    solution = brl.solve(level)
    env, params = brl_jax.make(level)
    assert isinstance(env, environment.Environment)
    assert (env.name, env.num_actions, env.default_params) == ("default", 5, params)
    observed, state = env.reset(KEY)
    assert observed.tolist() == list(level.starts[0])
    total = 0.0
    for _ in range(4):
        x, y = observed.tolist()
        action = int(solution.policy[y, x])
        observed, state, reward, terminated, truncated, info = env.step(KEY, state, action)
        total += float(reward)
        assert (info["terminated"], info["truncated"]) == (terminated, truncated)
    assert total == pytest.approx(solution.expected_return)
    assert bool(terminated)
    assert not bool(truncated)
    assert bool(info["target_reached"])
    # The next episode has begun in the same step.
    assert info["final_observation"].tolist() == list(level.exit)
    assert observed.tolist() == list(level.starts[0])
    assert (int(state.time), int(state.state)) == (0, 0)
    assert info["action_mask"].tolist() == env.action_mask(state).tolist()


def test_episodes_end_at_their_time_limit_or_never() -> None:
    env, limited = brl_jax.make("walls", max_episode_steps=3)
    _, endless = brl_jax.make("walls", max_episode_steps=-1)

    def cut(params: Any) -> Any:
        def one(state: Any, key: Any) -> Any:
            _, state, *_, truncated, _ = env.step(key, state, 0, params)
            return state, truncated

        return jax.lax.scan(one, env.reset(KEY, params)[1], jax.random.split(KEY, 7))[1]

    assert jax.jit(cut)(limited).tolist() == [False, False, True, False, False, True, False]
    assert not jax.jit(cut)(endless).any()
    assert env.state_space(endless).contains(env.reset(KEY, endless)[1])


def test_actions_beyond_the_last_are_taken_as_the_last() -> None:
    env, params = brl_jax.make("default")
    _, state = env.reset(KEY, params)
    for given, taken in ((99, 4), (-3, 0)):
        assert env.step(KEY, state, given)[1] == env.step(KEY, state, taken)[1]


def test_a_level_with_a_single_free_cell_beside_its_exit() -> None:
    env, params = brl_jax.make({"version": 1, "size": [2, 1], "exit": [1, 0]}, actions="moves")
    _, state = env.reset(KEY, params)
    assert (params.step_words, params.reset_words, params.held.shape) == (0, 0, (2, 0))
    assert bool(env.step(KEY, state, 1, params)[3])


def test_a_step_calls_nothing_outside_of_the_compiled_program() -> None:
    levels = ["bat-cave", "ice-vault", "frozen-lake"]
    env, params = brl_jax.make(levels, observation=("planes", "view"), actions="turns")
    _, state = env.reset(KEY, params)
    assert "callback" not in str(jax.make_jaxpr(env.step)(KEY, state, 1, params))
    assert all(leaf.dtype == jnp.int32 for leaf in jax.tree.leaves(state))


@pytest.mark.skipif(
    all(device.platform == "cpu" for device in jax.devices()),
    reason="needs a GPU, and a JAX that uses it",
)
def test_an_accelerator_takes_the_same_steps() -> None:
    env, params = brl_jax.make(["bat-cave", "ice-vault", "frozen-lake"], observation="vector")

    def walk(params: Any, keys: Any) -> Any:
        def one(state: Any, key: Any) -> Any:
            action = env.sample_action(key, state, params)
            return (told := env.step(key, state, action, params))[1], told

        return jax.lax.scan(one, env.reset(keys[0], params)[1], keys)[1]

    keys = jax.random.split(KEY, (256, 200))
    found = []
    for device in (jax.devices("cpu")[0], jax.devices()[0]):
        given = jax.device_put((params, keys), device)
        found.append(jax.tree.leaves(jax.jit(jax.vmap(walk, (None, 0)))(*given)))
    for one, other in zip(*found, strict=True):
        assert np.array_equal(one, other)
