"""Levels are environments as gymnax 1.0 defines them."""

from __future__ import annotations

import jax
import numpy as np
import pytest
from gymnax.environments import environment

import babyrobot_levels as brl
import babyrobot_levels.jax as brl_jax

KEY = jax.random.key(0)


def test_a_step_returns_six_values_and_the_last_observation_before_a_reset() -> None:
    env, params = brl_jax.make("default")
    assert isinstance(env, environment.Environment)
    assert (env.name, env.num_actions) == ("default", 5)
    level = brl.load("default")
    observed, state = env.reset(KEY, params)
    assert np.array_equal(observed, level.starts[0])
    for action in level.solve().path_actions if hasattr(level.solve(), "path_actions") else ():
        assert action is not None
    total, ends = 0.0, False
    mdp, policy = level.compile(), brl.solve(level).policy
    for _ in range(20):
        action = (
            int(np.argmax(policy[int(state.state)])) if policy.ndim > 1 else policy[state.state]
        )
        before = int(state.state)
        observed, state, reward, ends, cut, info = env.step(KEY, state, int(action), params)
        total += float(reward)
        assert reward == pytest.approx(mdp.reward[before, int(action), 0])
        if ends:
            break
    assert bool(ends)
    assert not bool(cut)
    assert bool(info["target_reached"])
    assert np.array_equal(observed, level.starts[0])
    assert np.array_equal(info["final_observation"], level.exit)
    assert {"terminated", "truncated", "action_mask", "level_index", "skidded"} <= set(info)
    assert total == pytest.approx(brl.solve(level).start_value)
