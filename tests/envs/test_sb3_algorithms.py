"""Which algorithms of Stable-Baselines3 and sb3-contrib take which observations."""

from __future__ import annotations

import warnings
from itertools import product
from typing import Any

import numpy as np
import pytest

import babyrobot_levels as brl

pytestmark = pytest.mark.libraries

ON_POLICY: dict[str, Any] = {"n_steps": 8, "batch_size": 16}
ALGORITHMS: dict[str, dict[str, Any]] = {
    "A2C": {"n_steps": 8},
    "DQN": {"learning_starts": 8, "buffer_size": 100},
    "MaskablePPO": ON_POLICY | {"n_epochs": 1},
    "PPO": ON_POLICY | {"n_epochs": 1},
    "QRDQN": {"learning_starts": 8, "buffer_size": 100},
    "RecurrentPPO": ON_POLICY | {"n_epochs": 1},
    "TRPO": ON_POLICY,
}
"""The algorithms for discrete actions, with arguments that make them fast."""

OBSERVATIONS: dict[str, tuple[str, dict[str, Any]]] = {
    "position": ("Mlp", {"observation": "position"}),
    "index": ("Mlp", {"observation": "index"}),
    "walls": ("Mlp", {"observation": "walls"}),
    "vector": ("Mlp", {"observation": "vector"}),
    "view": ("Mlp", {"observation": "view", "view_radius": 1}),
    "planes": ("Mlp", {"observation": "planes"}),
    "image": ("Cnn", {"observation": "image", "image_size": (36, 40)}),
    "several": ("MultiInput", {"observation": ("vector", "index", "planes")}),
}
"""The kind of policy, and the arguments of the environment."""

REFUSED = [("RecurrentPPO", "position"), ("RecurrentPPO", "walls")]


def many(level: str = "final-maze", num_envs: int = 2, **kwargs: Any) -> Any:
    from babyrobot_levels.envs.sb3 import LevelVecEnv

    return LevelVecEnv(level, num_envs=num_envs, max_episode_steps=5, **kwargs)


def learner(algorithm: str, policy: str, envs: Any, **kwargs: Any) -> Any:
    import sb3_contrib
    import stable_baselines3

    if algorithm == "RecurrentPPO":
        policy += "Lstm"
    library = stable_baselines3 if hasattr(stable_baselines3, algorithm) else sb3_contrib
    make = getattr(library, algorithm)
    return make(f"{policy}Policy", envs, seed=1, **ALGORITHMS[algorithm], **kwargs)


@pytest.mark.parametrize(
    ("algorithm", "observation"),
    [each for each in product(ALGORITHMS, OBSERVATIONS) if each not in REFUSED],
)
def test_an_algorithm_takes_an_observation(algorithm: str, observation: str) -> None:
    policy, kwargs = OBSERVATIONS[observation]
    envs = many(**kwargs)
    made = learner(algorithm, policy, envs).learn(32)
    actions, _ = made.predict(envs.reset())
    assert np.isin(actions, range(5)).all()


def test_the_checker_is_content_with_several_observations() -> None:
    from stable_baselines3.common.env_checker import check_env

    _, kwargs = OBSERVATIONS["several"]
    with warnings.catch_warnings():
        # It takes every box of three dimensions for a picture, of bytes and with channels last.
        warnings.filterwarnings(
            "ignore", "It seems that your|The minimal resolution|Treating image"
        )
        check_env(brl.load("first-key").make(**kwargs), warn=True)


@pytest.mark.parametrize("observation", ["vector", "view", "planes", "image", "several"])
@pytest.mark.parametrize("algorithm", ["DQN", "PPO"])
def test_wrappers_take_boxes(algorithm: str, observation: str) -> None:
    from stable_baselines3.common.vec_env import VecFrameStack, VecMonitor, VecNormalize

    policy, kwargs = OBSERVATIONS[observation]
    if observation == "several":
        kwargs = {"observation": ("vector", "planes")}
    wrapped = VecFrameStack(VecMonitor(many(**kwargs)), n_stack=2)
    if observation != "image":
        wrapped = VecNormalize(wrapped)
    learner(algorithm, policy, wrapped).learn(32)


def test_planes_as_bytes_of_a_large_level_are_pictures() -> None:
    from stable_baselines3.common.torch_layers import NatureCNN

    level: Any = {"version": 1, "size": [36, 37]}
    envs = many(level, observation="planes", planes_dtype="uint8")
    made = learner("PPO", "Cnn", envs)
    assert isinstance(made.policy.features_extractor, NatureCNN)
    assert made.observation_space.shape == envs.observation_space.shape
    made.learn(16)


# -- what they refuse, in their own words ----------------------------------------------------


@pytest.mark.parametrize(("algorithm", "observation"), REFUSED)
def test_the_memory_takes_no_numbers_of_several_columns(algorithm: str, observation: str) -> None:
    # It counts them with an integer of NumPy, which torch does not take.
    with pytest.raises(TypeError, match="input_size should be of type int"):
        learner(algorithm, "Mlp", many(observation=observation))


@pytest.mark.parametrize("observation", ["position", "index", "walls"])
def test_numbers_that_are_no_boxes_are_not_stacked_or_normalized(observation: str) -> None:
    from stable_baselines3.common.vec_env import VecFrameStack, VecNormalize

    with pytest.raises(AssertionError, match="Box"):
        VecFrameStack(many(observation=observation), n_stack=2)
    with pytest.raises(ValueError, match="only supports"):
        VecNormalize(many(observation=observation))
    VecNormalize(many(observation=observation), norm_obs=False)


def test_an_index_of_several_environments_is_not_replayed_with_normalized_rewards() -> None:
    from stable_baselines3.common.vec_env import VecNormalize

    scaled = VecNormalize(many(observation="index"), norm_obs=False)
    with pytest.raises(IndexError, match="too many indices"):
        learner("DQN", "Mlp", scaled).learn(32)


def test_planes_of_small_levels_are_too_small_for_their_convolutions() -> None:
    with pytest.raises(AssertionError, match="NatureCNN"):
        learner("PPO", "Cnn", many(observation="planes"))
    # It takes the smallest dimension for the channels.
    envs = many(observation="planes", planes_dtype="uint8")
    with pytest.warns(UserWarning, match="channels-last"), pytest.raises(RuntimeError):
        learner("PPO", "Cnn", envs)
