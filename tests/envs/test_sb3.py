"""Stable-Baselines3 learns on levels. It brings torch, so these tests run in a step of their own.

`pip install -e .[sb3]` and `pytest -m libraries`; everywhere else they are left out.
"""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from support.playing import each_level_and, level_named

from babyrobot_levels.envs.observations import OBSERVATIONS
from babyrobot_levels.envs.spaces import ACTION_SETS

pytestmark = pytest.mark.libraries


@pytest.fixture(autouse=True)
def quiet(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Logs go where all else goes."""
    monkeypatch.setenv("SB3_LOGDIR", str(tmp_path))


# Stable-Baselines3 wants pictures of at least 36 pixels a side.
IMAGE_SIZE = (36, 40)


def make(name: str, **kwargs: Any) -> gymnasium.Env[Any, Any]:
    return gymnasium.make("babyrobot/Level-v0", level=level_named(name), **kwargs)


@each_level_and(("observation", [*OBSERVATIONS]), ("actions", [*ACTION_SETS]))
def test_its_checker_is_content(name: str, observation: str, actions: str) -> None:
    from stable_baselines3.common.env_checker import check_env

    size = {"image_size": IMAGE_SIZE} if observation == "image" else {}
    env = make(name, observation=observation, actions=actions, render_mode="rgb_array", **size)
    with warnings.catch_warnings():
        if observation in ("view", "planes"):
            # It takes every box of three dimensions for a picture of at least 36 pixels a side.
            for told in ("It seems that your observation", "The minimal", "Treating image"):
                warnings.filterwarnings("ignore", told)
        check_env(env, warn=True, skip_render_check=False)


@pytest.mark.parametrize("actions", ["valid", "moves"])
def test_a_masked_policy_takes_only_possible_actions(actions: str) -> None:
    from sb3_contrib import MaskablePPO
    from sb3_contrib.common.maskable.utils import get_action_masks, is_masking_supported

    env = make("final-maze", actions=actions, max_episode_steps=60)
    learner = MaskablePPO("MlpPolicy", env, n_steps=64, batch_size=32, n_epochs=1, seed=1)
    vector = learner.get_env()
    assert vector is not None
    assert is_masking_supported(vector)
    learner.learn(256)
    observation, info = env.reset(seed=2)
    for _ in range(100):
        masks = get_action_masks(env)
        assert masks.tolist() == info["action_mask"].tolist()
        action, _ = learner.predict(observation, action_masks=masks)
        assert masks[int(action)] == 1
        observation, _, terminated, truncated, info = env.step(action)
        if terminated or truncated:
            observation, info = env.reset()


def test_a_masked_policy_learns_the_way_through_a_corridor() -> None:
    from sb3_contrib import MaskablePPO

    level = {"version": 1, "size": [5, 1], "max_steps": 40}
    env = gymnasium.make("babyrobot/Level-v0", level=level, actions="moves", observation="index")
    learner = MaskablePPO("MlpPolicy", env, n_steps=128, n_epochs=5, learning_rate=0.02, seed=3)
    learner.learn(512)
    observation, info = env.reset()
    total = 0.0
    for _ in range(40):
        action, _ = learner.predict(
            observation, action_masks=info["action_mask"], deterministic=True
        )
        observation, reward, terminated, truncated, info = env.step(action)
        total += float(reward)
        if terminated or truncated:
            break
    assert total == -3


def test_the_picture_that_levels_choose_themselves_is_large_enough() -> None:
    from stable_baselines3 import PPO

    env = make("default", observation="image")
    PPO("CnnPolicy", env, n_steps=16, batch_size=16, n_epochs=1, seed=6).learn(16)


def test_it_steps_vectors_of_levels() -> None:
    from stable_baselines3 import DQN
    from stable_baselines3.common.env_util import make_vec_env

    envs = make_vec_env("babyrobot/random-maze-v0", n_envs=2, seed=7)
    envs.reset()
    assert np.stack(envs.env_method("action_masks")).shape == (2, 5)
    DQN("MlpPolicy", envs, learning_starts=10, seed=7).learn(50)
