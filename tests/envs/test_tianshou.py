"""Tianshou's vector environments and collectors take the environments as they are."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from functools import partial
from typing import Any

import gymnasium
import numpy as np
import pytest

import babyrobot_levels as brl

pytestmark = pytest.mark.libraries

KINDS = ["position", "index", "walls", "vector", "planes", "view"]
DICT = ("vector", "planes")
# `ShmemVectorEnv` overwrites dicts of observations that it has returned.
COMBINATIONS = [
    *itertools.product(["DummyVectorEnv", "ShmemVectorEnv"], KINDS, ["first-key"]),
    *itertools.product(["DummyVectorEnv", "SubprocVectorEnv"], [DICT], ["first-key"]),
    # Slippery: the seeds decide.
    ("DummyVectorEnv", DICT, "frozen-lake"),
    ("ShmemVectorEnv", "vector", "frozen-lake"),
    ("SubprocVectorEnv", DICT, "frozen-lake"),
]
NUM_ENVS, SEED, STEPS = 3, 5, 40


def make(level: str, observation: Any) -> gymnasium.Env[Any, Any]:
    return brl.load(level).make(observation=observation, max_episode_steps=15)


def parts_of(observations: Any) -> dict[str, Any]:
    """The arrays of observations, by their names if there are several."""
    if isinstance(observations, np.ndarray):
        return {"": observations}
    return {name: observations[name] for name in observations.get_keys()}


def played(env: gymnasium.Env[Any, Any], seed: int, actions: Any) -> Iterator[tuple[Any, ...]]:
    """The steps of a single environment that takes the actions, with resets between episodes."""
    # `seed` of Tianshou resets once; so does the collector after it.
    env.reset(seed=seed)
    before, _ = env.reset()
    for action in actions:
        after, reward, terminated, truncated, info = env.step(action)
        yield before, after, reward, terminated, truncated, info
        before = env.reset()[0] if terminated or truncated else after


@pytest.mark.parametrize(("maker", "observation", "level"), COMBINATIONS, ids=str)
def test_collectors_find_what_single_environments_tell(
    maker: str, observation: Any, level: str
) -> None:
    from tianshou import env as makers
    from tianshou.algorithm.random import MARLRandomDiscreteMaskedOffPolicyAlgorithm as Random
    from tianshou.data import Collector, VectorReplayBuffer

    envs = getattr(makers, maker)([partial(make, level, observation)] * NUM_ENVS)
    envs.seed(SEED)
    buffer = VectorReplayBuffer(STEPS * NUM_ENVS, NUM_ENVS)
    algorithm = Random(action_space=envs.action_space[0])
    collector = Collector(algorithm, envs, buffer)
    collector.reset()
    collector.collect(n_step=STEPS * NUM_ENVS, random=True)
    envs.close()

    assert len(buffer) == STEPS * NUM_ENVS
    for number, each in enumerate(buffer.buffers):
        steps = list(played(make(level, observation), SEED + number, each.act))
        before, after, rewards, terminated, truncated, infos = zip(*steps, strict=True)
        assert each.rew.tolist() == list(rewards)
        assert each.terminated.tolist() == list(terminated)
        assert each.truncated.tolist() == list(truncated)
        for found, expected in ((each.obs, before), (each.obs_next, after)):
            for name, array in parts_of(found).items():
                values = [one[name] if name else one for one in expected]
                assert np.array_equal(array, np.stack(values))
        for name in infos[0]:
            told = [info[name] for info in infos]
            assert np.array_equal(each.info[name], np.stack(told))
