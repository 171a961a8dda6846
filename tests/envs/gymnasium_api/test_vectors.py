"""What Gymnasium tests of its own vector environments and `make_vec`, for every id."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.vector import AsyncVectorEnv, AutoresetMode, SyncVectorEnv
from gymnasium.wrappers import TimeAwareObservation
from support.each import for_each
from support.ids import FEW, IDS, KINDS

from babyrobot_levels.envs.vector.env import LevelVectorEnv

SIZE = 3
MODES: dict[str, Any] = {"vector_entry_point": LevelVectorEnv, "sync": SyncVectorEnv}

each_id = for_each("env_id", IDS)
few_ids = for_each("env_id", FEW)


def many(env_id: str, mode: str = "vector_entry_point", **kwargs: Any) -> Any:
    given = {**IDS, **FEW}[env_id]
    arguments = {"num_envs": SIZE, **given, **kwargs}
    return gymnasium.make_vec(env_id, vectorization_mode=mode, **arguments)


# -- make_vec --------------------------------------------------------------------------------


@each_id
def test_the_entry_point_is_the_default(env_id: str) -> None:
    assert isinstance(gymnasium.make_vec(env_id, **IDS[env_id]), LevelVectorEnv)
    for mode, kind in MODES.items():
        assert isinstance(many(env_id, mode), kind)


@few_ids
def test_making_again_from_the_spec(env_id: str) -> None:
    for arguments in (
        {},
        {"render_mode": "rgb_array"},
        {"mode": "sync"},
        {"mode": "sync", "vector_kwargs": {"copy": False}},
        {"mode": "sync", "max_episode_steps": 9, "wrappers": (TimeAwareObservation,)},
    ):
        envs = many(env_id, **arguments)
        again: Any = gymnasium.make_vec(envs.spec)
        assert type(again) is type(envs)
        assert again.spec == envs.spec
        assert again.num_envs == SIZE
        for space in ("observation_space", "action_space"):
            assert getattr(again, space) == getattr(envs, space)
            assert getattr(again, f"single_{space}") == getattr(envs, f"single_{space}")


@pytest.mark.parametrize("mode", AutoresetMode)
@few_ids
def test_the_autoreset_mode_is_told(env_id: str, mode: AutoresetMode) -> None:
    for asked in (mode, mode.value):
        envs = many(env_id, autoreset_mode=asked)
        assert envs.metadata["autoreset_mode"] is mode
        assert envs.autoreset_mode is mode


# -- reset and step --------------------------------------------------------------------------


@each_id
def test_results_have_the_types_of_the_interface(env_id: str) -> None:
    envs = many(env_id)
    observations, info = envs.reset(seed=42)
    assert envs.np_random_seed == 42
    check_info(info)
    envs.action_space.seed(1)
    for _ in range(8):
        assert observations in envs.observation_space
        assert observations.dtype == envs.observation_space.dtype
        assert observations.shape == (SIZE, *envs.single_observation_space.shape)
        actions = envs.action_space.sample()
        assert actions in envs.action_space
        assert all(action in envs.single_action_space for action in actions)
        observations, rewards, terminated, truncated, info = envs.step(actions)
        assert (rewards.dtype, rewards.shape) == (np.float64, (SIZE,))
        for ended in (terminated, truncated):
            assert (ended.dtype, ended.shape) == (np.bool_, (SIZE,))
        check_info(info)


def check_info(info: dict[str, Any]) -> None:
    """Check that each value has a row for each environment, and a mask of those that have it."""
    for key in [key for key in info if not key.startswith("_")]:
        assert len(info[key]) == SIZE
        assert (info[f"_{key}"].dtype, info[f"_{key}"].shape) == (np.bool_, (SIZE,))


@each_id
def test_the_same_seed_gives_the_same_actions_and_episodes(env_id: str) -> None:
    one, other = many(env_id), many(env_id)
    for envs in (one, other):
        envs.action_space.seed(123)
    assert data_equivalence(one.reset(seed=7), other.reset(seed=7))
    for _ in range(20):
        actions = one.action_space.sample()
        assert actions.tolist() == other.action_space.sample().tolist()
        assert data_equivalence(one.step(actions), other.step(actions))


@for_each("kind", KINDS)
def test_the_end_of_an_episode_is_an_observation(kind: str) -> None:
    for env_id in FEW:
        envs = many(
            env_id,
            **KINDS[kind],
            max_episode_steps=4,
            autoreset_mode=AutoresetMode.SAME_STEP,
        )
        envs.reset(seed=1)
        for step in range(1, 9):
            *_, truncated, info = envs.step(np.zeros(SIZE, int))
            assert truncated.all() or step % 4
            if truncated.all():
                assert all(each in envs.single_observation_space for each in info["final_obs"])


def test_processes_do_as_one_process_does() -> None:
    # The prefix imports the package in a process of its own.
    env_id, steps = "babyrobot_levels:babyrobot/frozen-lake-v0", 20
    make = [lambda: gymnasium.make(env_id, observation=("position", "walls"))] * SIZE
    one, other = SyncVectorEnv(make), AsyncVectorEnv(make, shared_memory=True, context="spawn")
    assert other.observation_space == one.observation_space
    assert data_equivalence(other.reset(seed=0), one.reset(seed=0))
    one.action_space.seed(0)
    for _ in range(steps):
        actions = one.action_space.sample()
        assert data_equivalence(other.step(actions), one.step(actions))
    other.close()
