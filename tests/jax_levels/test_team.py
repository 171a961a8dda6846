"""Several robots in JAX: each step is that of the tables."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import babyrobot_levels as brl
import babyrobot_levels.jax as brl_jax

SLIPPERY: dict[str, Any] = {
    "version": 1,
    "size": [4, 3],
    "robots": [{"name": "a", "start": [0, 0]}, {"name": "b", "start": [0, 2]}],
    "items": [{"name": "coin", "one_of": [[1, 1], [2, 1]], "reward": 3}],
    "movers": [{"within": {"at": [1, 0], "size": [2, 1]}}],
    "hit": {"ends": False},
    "skid": 0.3,
}
THREE: dict[str, Any] = {
    "version": 1,
    "size": [3, 2],
    "exit": [2, 1],
    "robots": [{"name": name, "start": [at, 0]} for at, name in enumerate("abc")],
    "team": {"meet": "pass"},
    "max_steps": 5,
}


@pytest.mark.parametrize("given", ["two-pads", SLIPPERY, THREE])
def test_steps_are_those_of_the_tables(given: Any) -> None:
    level, steps, count = brl.load(given), 12, 16
    mdp, robots = level.compile(), len(level.robots)
    assert mdp.shares is not None
    env, params = brl_jax.make_team(level, max_episode_steps=-1)
    assert (env.num_robots, env.num_actions, params.num_states) == (
        robots,
        5**robots,
        mdp.num_states,
    )
    rng = np.random.default_rng(0)
    _, state = jax.vmap(env.reset, (0, None))(jax.random.split(jax.random.key(0), count), params)
    assert set(state.state.tolist()) <= set(mdp.starts.tolist())
    take = jax.jit(jax.vmap(env.transition, (0, 0, 0, None)))
    for _ in range(steps):
        words = rng.integers(2**32, size=(count, params.step_words), dtype=np.uint32)
        actions = rng.integers(5, size=(count, robots))
        before, joint = np.array(state.state), mdp.joint_action(actions)
        masks = np.array(jax.vmap(env.action_mask, (0, None))(state, params))
        allowed = np.array(params.allowed)[before, joint]
        assert (
            allowed.tolist()
            == np.take_along_axis(masks, actions[..., None], 2).all((1, 2)).tolist()
        )
        assert allowed.tolist() == (mdp.action_mask[before, joint] > 0).tolist()
        state, reward, terminated, info = take(words, state, actions, params)
        draws = words[:, 0] / 2.0**32 if params.step_words else np.zeros(count)
        cumulated = np.cumsum(mdp.probability[before, joint], axis=1)
        last = (mdp.probability[before, joint] > 0).sum(axis=1) - 1
        number = np.minimum((draws[:, None] >= cumulated).sum(axis=1), last)
        where = before, joint, number
        assert np.array(state.state).tolist() == mdp.next_state[where].tolist()
        assert np.array(terminated).tolist() == mdp.terminal[where].tolist()
        np.testing.assert_allclose(reward, mdp.reward[where], rtol=1e-6)
        np.testing.assert_allclose(info["rewards"], mdp.shares[where], rtol=1e-6)


def test_several_levels_are_played_and_solved_at_once() -> None:
    levels = [brl.load("two-pads"), brl.load("passing-place")]
    env, params = brl_jax.make_team(levels, draw_levels=False)
    best = [brl.solve(level).expected_return for level in levels]
    np.testing.assert_allclose(brl_jax.optimum(params).returns, best, atol=1e-4)
    policy = brl_jax.random_policy(params)
    exact = [brl.evaluate(level, "random", within=30).expected_return for level in levels]
    np.testing.assert_allclose(
        brl_jax.evaluate(params, policy, within=30).returns, exact, rtol=1e-4
    )
    with pytest.raises(ValueError, match="one robot"):
        params.take([0])
    _, state = env.reset_to_level(jax.random.key(0), 1, params)
    actions = env.sample_action(jax.random.key(1), state, params)
    assert env.action_space().contains(actions)
    masks = env.action_mask(state, params)
    assert bool(jnp.take_along_axis(masks, actions[:, None], 1).all())


def test_episodes_end_by_the_limit_and_start_again() -> None:
    env, params = brl_jax.make_team(THREE, observation="view")
    observation, state = env.reset(jax.random.key(0), params)
    for _ in range(5):
        observation, state, _, _, truncated, info = env.step(
            jax.random.key(0), state, jnp.zeros(3, int), params
        )
    assert bool(truncated)
    assert int(state.time) == 0
    assert env.observation_space().contains(observation)
    assert info["rewards"].tolist() == [-1, -1, -1]


def test_what_are_no_teams_is_said() -> None:
    for levels in ("final-maze", [brl.load("two-pads"), brl.load(THREE)]):
        with pytest.raises(ValueError, match="several robots, and the same number"):
            brl_jax.make_team(levels)
