"""RLlib's runners take all environments. It brings torch: see `test_sb3.py`.

RLlib has no checker of environments of one agent: the runner that samples is asked for episodes.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import babyrobot_levels as brl
from babyrobot_levels.envs.observations import OBSERVATIONS

pytestmark = [pytest.mark.libraries, pytest.mark.filterwarnings("ignore")]

PREFIX = "babyrobot_levels:babyrobot/"
SEVERAL = ("position", "walls")


def sampled(env_id: str, mode: str = "vector_entry_point", steps: int = 60, **kwargs: Any) -> Any:
    """Return episodes of random actions from two environments."""
    from ray.rllib.algorithms.ppo import PPOConfig
    from ray.rllib.connectors.env_to_module import FlattenObservations
    from ray.rllib.env.single_agent_env_runner import SingleAgentEnvRunner

    config = (
        PPOConfig()
        .environment(PREFIX + env_id, env_config=kwargs)
        .env_runners(
            num_envs_per_env_runner=2,
            gym_env_vectorize_mode=mode,
            env_to_module_connector=lambda env, spaces, device: FlattenObservations(),
        )
        .debugging(seed=1)
    )
    runner = SingleAgentEnvRunner(config=config)
    try:
        # The network takes what it is given, though the actions are random.
        runner.sample(num_timesteps=2)
        return runner.sample(num_timesteps=steps, random_actions=True, force_reset=True)
    finally:
        runner.stop()


# The connectors see the observations alone: which level and mode they are from is no cause.
@pytest.mark.parametrize(
    ("mode", "env_id", "observation"),
    [
        *(("vector_entry_point", "first-key-v0", each) for each in [*OBSERVATIONS, SEVERAL]),
        ("vector_entry_point", "final-maze-v0", SEVERAL),
        ("sync", "first-key-v0", SEVERAL),
        ("sync", "final-maze-v0", "position"),
    ],
    ids=str,
)
def test_it_samples_episodes(mode: str, env_id: str, observation: Any) -> None:
    episodes = sampled(env_id, mode, observation=observation, max_episode_steps=20)
    assert sum(len(episode) for episode in episodes) >= 60
    masks = [info["action_mask"] for episode in episodes for info in episode.get_infos()]
    assert {mask.shape for mask in masks} == {(5,)}


def test_it_samples_suites() -> None:
    episodes = sampled("Suite-v0", suite="small-mazes", observation="vector")
    assert sum(len(episode) for episode in episodes) >= 60


def test_its_episodes_are_those_of_the_level() -> None:
    """No step is lost or added where an episode ends and the next one begins."""
    level = brl.load("frozen-lake")
    mdp = level.compile()
    episodes = sampled("frozen-lake-v0", steps=200, observation="index", max_episode_steps=30)
    over = [episode for episode in episodes if episode.is_done]
    assert len(over) > 4
    for episode in over:
        # The connector replaced the numbers of states by one-hot vectors.
        states = np.argmax(episode.get_observations(), axis=1)
        possible = mdp.next_state[states[:-1], np.asarray(episode.get_actions())]
        assert (possible == states[1:, None]).any(axis=1).all()
        assert episode.is_terminated == bool(mdp.is_terminal[states[-1]])
