"""Models of libraries are scored by what they do in every state."""

from __future__ import annotations

from dataclasses import asdict
from pkgutil import resolve_name
from typing import Any

import numpy as np
import pytest

import babyrobot_levels as brl

pytestmark = pytest.mark.libraries

LEVEL = "frozen-lake"


def table_of(choose: Any, observation: str = "position") -> Any:
    """Return the actions of a function of observations, `[height, width]`."""
    level = brl.load(LEVEL)
    env = level.make(observation=observation)
    rows = [[0] * 4 for _ in range(4)]
    for y, x in np.ndindex(4, 4):
        seen = np.array([x, y]) if observation == "position" else y * 4 + x
        rows[y][x] = int(choose(seen))
    env.close()
    return np.array(rows)


@pytest.mark.parametrize("name", ["PPO", "A2C", "DQN"])
def test_models_of_stable_baselines(name: str) -> None:
    import stable_baselines3

    env = brl.load(LEVEL).make()
    model = getattr(stable_baselines3, name)("MlpPolicy", env, seed=3)
    score = brl.score(LEVEL, model)[0]
    table = table_of(lambda seen: model.predict(seen, deterministic=True)[0])
    expected = brl.evaluate(LEVEL, table, within="max_steps")
    assert score.episodes == 0
    assert score.expected_return == pytest.approx(expected.expected_return, abs=1e-12)


def test_a_model_that_samples_is_scored_by_its_probabilities() -> None:
    from stable_baselines3 import PPO

    model = PPO("MlpPolicy", brl.load(LEVEL).make(), seed=3)
    score = brl.score(LEVEL, model, deterministic=False)[0]
    # A network that has learned nothing is nearly indifferent between the actions.
    expected = brl.evaluate(LEVEL, "uniform", within="max_steps").expected_return
    assert score.expected_return == pytest.approx(expected, abs=0.005)


def test_masked_and_recurrent_models_of_sb3_contrib() -> None:
    from sb3_contrib import MaskablePPO, RecurrentPPO

    level = brl.load(LEVEL)
    masked = MaskablePPO("MlpPolicy", level.make(), seed=3)
    score = brl.score(LEVEL, masked, deterministic=False)[0]
    expected = brl.evaluate(LEVEL, "random", within="max_steps").expected_return
    assert score.episodes == 0
    assert score.expected_return == pytest.approx(expected, abs=0.005)
    recurrent = RecurrentPPO("MlpLstmPolicy", level.make(observation="vector"), seed=3)
    with pytest.warns(UserWarning, match="20 episodes in each level tell little"):
        played = brl.score(LEVEL, recurrent, observation="vector", episodes=20)[0]
    assert played.episodes == 20


@pytest.mark.parametrize("kind", ["stable_baselines3:PPO", "sb3_contrib:MaskablePPO"])
def test_models_that_move_several_robots(kind: str) -> None:
    pads = "two-pads"
    model = resolve_name(kind)("MlpPolicy", brl.load(pads).make(), seed=3)
    score = brl.score(pads, model, deterministic=False)[0]
    # A network that has learned nothing is nearly indifferent between what is allowed.
    usual = "random" if "Maskable" in kind else "uniform"
    expected = brl.evaluate(pads, usual, within="max_steps").expected_return
    assert score.expected_return == pytest.approx(expected, abs=0.5)
    assert brl.score(pads, model)[0].episodes == 0


def test_a_module_of_rllib() -> None:
    import gymnasium
    from ray.rllib.algorithms.ppo.torch.default_ppo_torch_rl_module import DefaultPPOTorchRLModule
    from ray.rllib.core.rl_module.default_model_config import DefaultModelConfig

    level = brl.load(LEVEL)
    env = level.make(observation="vector")
    assert isinstance(env.action_space, gymnasium.spaces.Discrete)
    module = DefaultPPOTorchRLModule(
        observation_space=env.observation_space,
        action_space=gymnasium.spaces.Discrete(5),
        model_config=asdict(DefaultModelConfig(fcnet_hiddens=[8])),
        inference_only=True,
    )
    score = brl.score(LEVEL, module, observation="vector")[0]
    assert score.episodes == 0
    assert 0.0 <= score.expected_return < score.optimum


def test_a_module_of_rllib_with_masks_and_flattened_observations() -> None:
    from gymnasium import spaces
    from gymnasium.spaces.utils import flatten_space
    from ray.rllib.core.rl_module.default_model_config import DefaultModelConfig
    from ray.rllib.examples.rl_modules.classes.action_masking_rlm import ActionMaskingTorchRLModule

    planes = brl.load(LEVEL).make(observation="planes").observation_space
    masked = spaces.Dict(action_mask=spaces.Box(0, 1, (5,)), observations=flatten_space(planes))
    module = ActionMaskingTorchRLModule(
        observation_space=masked,
        action_space=spaces.Discrete(5),
        model_config=asdict(DefaultModelConfig(fcnet_hiddens=[8])),
        inference_only=True,
    )
    score = brl.score(LEVEL, module, observation="planes", deterministic=False)[0]
    # A network that has learned nothing is nearly indifferent between the actions of the mask.
    expected = brl.evaluate(LEVEL, "random", within="max_steps").expected_return
    assert score.episodes == 0
    assert score.expected_return == pytest.approx(expected, abs=0.005)


def test_a_function_of_jax() -> None:
    jax = pytest.importorskip("jax")
    space: Any = brl.load(LEVEL).make(observation="vector").observation_space
    weights = np.random.default_rng(3).normal(size=(*space.shape, 5))

    def chances(observations: Any) -> Any:
        return jax.nn.softmax(observations @ weights.astype("f4"), axis=-1)

    policy = jax.jit(chances)
    greedy = jax.jit(lambda observations: chances(observations).argmax(axis=-1))

    def expected(observations: Any) -> Any:
        powers = np.exp(observations @ weights)
        return powers / powers.sum(axis=-1, keepdims=True)

    score, other = (
        brl.score(LEVEL, agent, observation="vector", batched=True)[0]
        for agent in (policy, expected)
    )
    assert score.episodes == 0
    assert score.expected_return == pytest.approx(other.expected_return, abs=1e-6)
    # The most likely actions, one observation at a time and many at once.
    one, many = (
        brl.score(LEVEL, greedy, observation="vector", batched=batched)[0]
        for batched in (False, True)
    )
    assert one == many
    assert one.expected_return != pytest.approx(score.expected_return)
