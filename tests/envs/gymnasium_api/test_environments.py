"""What Gymnasium tests of its own environments, specs and `make`, for every id of this package."""

from __future__ import annotations

import pickle
from typing import Any

import gymnasium
import numpy as np
from gymnasium.envs.registration import EnvSpec
from gymnasium.utils.env_checker import check_env, data_equivalence
from gymnasium.wrappers import (
    NormalizeObservation,
    NormalizeReward,
    TimeAwareObservation,
)
from support.each import for_each
from support.ids import FEW, IDS

from babyrobot_levels.envs.single import LevelEnv

each_id = for_each("env_id", IDS)
few_ids = for_each("env_id", FEW)


def assert_same_steps(one: Any, other: Any, steps: int = 50) -> None:
    """Play two environments with the same seed and the same actions, and compare all results."""
    one.action_space.seed(0)
    assert data_equivalence(one.reset(seed=0), other.reset(seed=0))
    for _ in range(steps):
        action = one.action_space.sample()
        result = one.step(action)
        assert data_equivalence(result, other.step(action))
        assert result[0] in one.observation_space
        if result[2] or result[3]:
            assert data_equivalence(one.reset(), other.reset())


# -- environments ----------------------------------------------------------------------------


# Warnings are errors in all tests.
@each_id
def test_the_checker_finds_and_warns_of_nothing(env_id: str) -> None:
    env = gymnasium.make(env_id, disable_env_checker=True, **IDS[env_id])
    check_env(env.unwrapped, skip_render_check=True)
    env.close()


@each_id
def test_environments_with_the_same_seed_do_the_same(env_id: str) -> None:
    one, other = (gymnasium.make(env_id, **IDS[env_id]) for _ in range(2))
    assert_same_steps(one, other)


@few_ids
def test_each_render_mode_gives_what_its_name_says(env_id: str) -> None:
    modes = gymnasium.make(env_id, **FEW[env_id]).metadata["render_modes"]
    assert "rgb_array" in modes
    assert "human" in modes
    for mode in {*modes, "rgb_array_list"} - {"human"}:
        env = gymnasium.make(env_id, render_mode=mode, **FEW[env_id])
        assert env.render_mode == mode
        env.reset(seed=0)
        for _ in range(2):
            check_frame(env.render(), mode)
            env.step(env.action_space.sample())
        env.close()


def check_frame(frame: Any, mode: str) -> None:
    if mode.endswith("_list"):
        assert isinstance(frame, list)
        for each in frame:
            check_frame(each, mode.removesuffix("_list"))
    elif mode == "rgb_array":
        assert (type(frame), frame.dtype) == (np.ndarray, np.uint8)
        assert (frame.ndim, frame.shape[2]) == (3, 3)
    elif mode in ("ansi", "svg"):
        assert isinstance(frame, str)
        assert frame
    else:
        assert mode == "canvas"


@few_ids
def test_a_pickled_stack_of_wrappers_goes_on(env_id: str) -> None:
    env: Any = gymnasium.make(env_id, max_episode_steps=9, **FEW[env_id])
    env = NormalizeReward(NormalizeObservation(env), gamma=0.8)
    assert_same_steps(env, pickle.loads(pickle.dumps(env)))


# -- make ------------------------------------------------------------------------------------


@few_ids
def test_making_again_from_the_spec(env_id: str) -> None:
    env = gymnasium.make(env_id, render_mode="rgb_array", max_episode_steps=30, **FEW[env_id])
    env = NormalizeReward(TimeAwareObservation(env), gamma=0.8)
    assert env.spec is not None
    assert [each.name for each in env.spec.additional_wrappers] == [
        "TimeAwareObservation",
        "NormalizeReward",
    ]
    spec = EnvSpec.from_json(env.spec.to_json())
    assert spec == env.spec
    again: Any = gymnasium.make(spec)
    assert again.render_mode == "rgb_array"
    assert (type(again), again.gamma) == (NormalizeReward, 0.8)
    assert isinstance(again.unwrapped, LevelEnv)
    assert_same_steps(env, again)


@few_ids
def test_specs_of_all_kinds_equal_themselves_and_are_told(env_id: str) -> None:
    env = gymnasium.make(env_id, **FEW[env_id])
    for spec in (gymnasium.spec(env_id), env.unwrapped.spec, NormalizeReward(env).spec):
        assert spec is not None
        assert EnvSpec.from_json(spec.to_json()) == spec
        for options in ({}, {"include_entry_points": True}, {"print_all": True}):
            told = spec.pprint(disable_print=True, **options)
            assert told is not None
            assert told.startswith(f"id={env_id}")
