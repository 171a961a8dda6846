"""A step in JAX is that of the NumPy engine, for the same draws, in every level of the gallery."""

from __future__ import annotations

from typing import Any

import jax
import numpy as np
import pytest
from support.jax_walks import KINGS, POOL, WordDraws, bits_64

import babyrobot_levels as brl
import babyrobot_levels.jax as brl_jax
from babyrobot_levels.jax.params import draw_words

STEPS, COPIES = 300, 6


def walk(env: Any, params: Any, keys: Any, actions: Any, levels: Any) -> tuple[Any, ...]:
    """Return the first states, and what each step tells, in arrays `[steps, envs, …]`."""

    def one(state: Any, given: Any) -> Any:
        key, action = given
        told = jax.vmap(env.step, in_axes=(0, 0, 0, None))(key, state, action, params)
        _, state, reward, terminated, truncated, info = told
        return state, (state, reward, terminated, truncated, info)

    if levels is None:
        _, first = jax.vmap(env.reset, in_axes=(0, None))(keys[0], params)
    else:
        _, first = jax.vmap(env.reset_to_level, in_axes=(0, 0, None))(keys[0], levels, params)
    return first, jax.lax.scan(one, first, (keys[1:], actions))[1]


@pytest.mark.parametrize(
    ("levels", "actions", "draw_levels"),
    [
        (POOL, "all", False),
        (POOL, "moves", True),
        (POOL, "turns", True),
        (KINGS, "all", False),
        (KINGS, "valid_moves", True),
        (list(brl.load_suite("locked-mazes")[:3]), "valid", True),
    ],
    ids=["all", "moves", "turns", "nine", "eight", "suite"],
)
def test_steps_are_those_of_the_numpy_engine(levels: Any, actions: str, draw_levels: bool) -> None:
    check_steps(levels, actions, draw_levels=draw_levels)


def test_rewards_are_exact_with_64_bits() -> None:
    level = brl.load("bat-cave")
    with bits_64():
        env, params = brl_jax.make(level, observation=("position", "vector"))
        assert params.reward.dtype == np.float64
        rows = level.compile().probability.reshape(params.num_rows, -1)
        rows = rows[(rows > 0).sum(axis=1) > 1, : params.most_outcomes]
        assert np.abs(params.probability - rows).max() < 1e-15
        observed, state = env.reset(jax.random.key(0), params)
        types = {each.dtype.name for each in jax.tree.leaves(state)}
        assert types == {"int32"}
        assert (observed["position"].dtype, observed["vector"].dtype) == (np.int32, np.float32)
        alone = jax.tree.leaves(params.take(0))
        assert [one.dtype for one in alone] == [each.dtype for each in jax.tree.leaves(params)]
        check_steps(level, "valid_moves", draw_levels=True)


def check_steps(levels: Any, actions: str, *, draw_levels: bool) -> None:
    """Compare walks; rewards are equal to the last bit of the type that JAX has them in."""
    several = not isinstance(levels, brl.Level)
    count = len(levels) if several else 1
    num_envs = count * COPIES
    # Some levels have longer limits than there are steps.
    limit = 40 if count < len(POOL) else None
    chosen: Any = {"observation": "index", "actions": actions, "max_episode_steps": limit}
    env, params = brl_jax.make(levels, draw_levels=draw_levels, **chosen)
    rng = np.random.default_rng(1)
    taken = rng.integers(0, env.num_actions, (STEPS, num_envs), np.int32)
    keys = jax.random.split(jax.random.key(2), (STEPS + 1, num_envs))
    level = None if draw_levels else np.arange(num_envs) % count
    first, told = jax.jit(walk, static_argnums=0)(env, params, keys, taken, level)
    states, rewards, terminated, truncated, infos = jax.tree.map(np.asarray, told)

    words = jax.vmap(jax.vmap(lambda key: draw_words(key, params.step_words + params.reset_words)))
    drawn = np.asarray(words(keys[1:]))
    begun = jax.vmap(lambda key: draw_words(key, params.reset_words))(keys[0])
    given = {"levels": levels, "draw_levels": draw_levels} if several else {"level": levels}
    numpy = brl.LevelVectorEnv(
        **given, **chosen, num_envs=num_envs, engine="numpy", autoreset_mode="SameStep"
    )
    numpy.reset(seed=0)
    numpy._draws = draws = WordDraws()
    draws.give(begun, 0)
    numpy._engine.reset(numpy._envs, np.arange(num_envs), draws)
    same(first.state, numpy._envs.state)
    same(first.level, numpy._envs.level)
    finals = 0
    for step in range(STEPS):
        draws.give(drawn[step], params.step_words)
        _, reward, ends, cut, info = numpy.step(taken[step])
        over = ends | cut
        same(states.state[step], numpy._envs.state)
        same(states.level[step], numpy._envs.level)
        same(rewards[step], reward.astype(rewards.dtype))
        same(terminated[step], ends)
        same(truncated[step], cut)
        same(infos["action_mask"][step], info["action_mask"])
        final = info.get("final_info", {})
        for name in ("target_reached", "skidded", "held", "hit", "level_index"):
            if name in infos and name in info:
                before = info[name].copy()
                if over.any():
                    before[over] = final[name][over]
                same(infos[name][step], before)
        if over.any():
            ended = [int(each) for each in info["final_obs"][over]]
            same(infos["final_observation"][step][over], ended)
            finals += len(ended)
    assert finals > num_envs, "too few episodes ended"


def same(found: Any, wanted: Any) -> None:
    """Assert that arrays are equal; assert_array_equal takes ten times as long."""
    assert np.array_equal(found, wanted)
