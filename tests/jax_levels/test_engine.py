"""The engine `"jax"` passes the tests of the other engines, and does the same to the last bit."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import gymnasium
import jax
import numpy as np
import pytest
from envs.vector import (
    test_changing_levels,
    test_engines,
    test_exchanging_levels,
    test_reference,
    test_rollout,
    test_seeds,
    test_things,
)
from gymnasium.vector import AutoresetMode
from support.fleets import MODES, same, walked
from support.playing import level_named

import babyrobot_levels as brl
from babyrobot_levels.envs.vector.env import LevelVectorEnv

Test = Callable[..., None]


@pytest.mark.parametrize(
    "test",
    [
        test_engines.test_levels_without_chance_draw_nothing,
        test_engines.test_only_those_draw_whose_action_has_several_outcomes,
        test_engines.test_another_generator_is_used_at_once,
        test_engines.test_a_draw_that_is_a_threshold_falls_on_the_same_side_as_in_a_single_environment,
        test_exchanging_levels.test_present_episodes_go_on_as_they_would,
        test_exchanging_levels.test_limits_and_starts_are_those_of_each_level,
        test_exchanging_levels.test_copies_go_on_alike,
        test_rollout.test_chance_comes_out_as_the_solution_expects,
        test_rollout.test_each_of_several_levels_has_its_policy_and_its_limit,
        test_seeds.test_one_seed_for_all_is_shared_again,
        test_things.test_a_hit_ends_the_episode_in_a_state_in_which_another_goes_on,
        test_things.test_a_hit_is_told_of_the_episode_that_it_ends,
        test_things.test_rollouts_end_with_a_hit,
        test_things.test_only_environments_that_are_reset_tell_what_is_held,
    ],
)
def test_it_passes_the_tests_of_engines(test: Test) -> None:
    test(engine="jax")


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize(
    "test",
    [
        test_seeds.test_long_walks_of_several_levels_with_several_starts,
        test_seeds.test_copies_go_on_with_their_generators,
    ],
)
def test_it_passes_the_tests_of_engines_and_modes(test: Test, mode: AutoresetMode) -> None:
    test(mode=mode, engine="jax")


@pytest.mark.parametrize(
    ("name", "observation", "mode"),
    [
        ("final-maze", "position", MODES[0]),
        ("frozen-lake", ("walls", "index", "planes"), MODES[1]),
        ("all at once", "image", MODES[2]),
    ],
)
def test_it_shows_what_single_environments_show(
    name: str, observation: str | tuple[str, ...], mode: AutoresetMode
) -> None:
    test_reference.test_it_shows_what_single_environments_show(name, observation, mode, "jax")


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("family", ["wet", "mazes"])
def test_levels_that_change_are_walked_the_same_way(family: str, mode: AutoresetMode) -> None:
    ways = [
        walked(test_changing_levels.make(family, engine=engine, autoreset_mode=mode), 90, 4)
        for engine in ("numpy", "jax")
    ]
    assert same(*ways)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("is_x64", [False, True])
def test_it_walks_the_same_way_and_leaves_the_settings_of_jax_alone(
    mode: AutoresetMode, is_x64: bool
) -> None:
    """Rewards of a hundredth and chances of a third have no exact float32."""
    ice = brl.load(
        {
            "version": 1,
            "size": [4, 4],
            "start": [[0, 0], [3, 0]],
            "skid": {"probability": 0.3, "to": "others"},
            "rewards": {"step": -0.01},
            "max_steps": 30,
        }
    )

    def walk(engine: str) -> list[Any]:
        envs = LevelVectorEnv(
            levels=[ice, "three-gems", level_named("all at once")],
            num_envs=300,
            actions="turns",
            engine=engine,
            autoreset_mode=mode,
            draw_levels=True,
        )
        return walked(envs, 60, 5)

    numpy, before = walk("numpy"), jax.config.read("jax_enable_x64")
    jax.config.update("jax_enable_x64", is_x64)
    try:
        assert same(walk("jax"), numpy)
        assert jax.config.read("jax_enable_x64") == is_x64
    finally:
        jax.config.update("jax_enable_x64", before)


def test_rollouts_are_the_same() -> None:
    def roll(engine: str) -> dict[str, Any]:
        given: dict[str, Any] = {"num_envs": 7, "num_steps": 60, "seed": 2, "engine": engine}
        return vars(brl.rollout([level_named("all at once"), "frozen-lake"], "uniform", **given))

    assert same(roll("jax"), roll("numpy"))


def test_gymnasium_makes_it() -> None:
    envs = gymnasium.make_vec("babyrobot/Level-v0", 4, level="final-maze", engine="jax")
    observations, _ = envs.reset(seed=1)
    assert isinstance(observations, np.ndarray)
    observations, rewards, *_ = envs.step(jax.numpy.zeros(4, int))
    assert rewards.dtype == np.float64
