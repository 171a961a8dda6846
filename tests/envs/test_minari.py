"""Minari records the environments, stores what they tell, and makes them again."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

import babyrobot_levels as brl

pytestmark = [
    pytest.mark.libraries,
    # The datasets of tests have no authors.
    pytest.mark.filterwarnings("ignore:.* is set to None:UserWarning"),
    # Minari leaves the removal of its temporary folder to the end of the process.
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore:Implicitly cleaning up:ResourceWarning"),
]

KINDS = ["position", "index", "walls", "vector", "planes", "view", ("vector", "planes")]
EPISODES = 3


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))


def record(env: gymnasium.Env[Any, Any], **arguments: Any) -> tuple[Any, list[Any]]:
    """A dataset of random episodes, loaded from its files, and the episodes' observations."""
    import minari

    recorder = minari.DataCollector(env, record_infos=True, **arguments)
    observations = []
    for seed in range(EPISODES):
        seen = [recorder.reset(seed=seed)[0]]
        recorder.action_space.seed(seed)
        done = False
        while not done:
            observation, _, terminated, truncated, _ = recorder.step(recorder.action_space.sample())
            seen.append(observation)
            done = terminated or truncated
        observations.append(seen)
    recorder.create_dataset("babyrobot/test-v0")
    recorder.close()
    return minari.load_dataset("babyrobot/test-v0"), observations


def check_replay(dataset: Any, env: gymnasium.Env[Any, Any]) -> None:
    """Episodes go the same way again in an environment, from their seeds."""
    told = dataset.storage.get_episode_metadata(dataset.episode_indices)
    for episode, metadata in zip(dataset, told, strict=True):
        infos = [env.reset(seed=metadata["seed"])[1]]
        steps = [env.step(action) for action in episode.actions]
        _, rewards, terminated, truncated, more = zip(*steps, strict=True)
        assert episode.rewards.tolist() == list(rewards)
        assert episode.terminations.tolist() == list(terminated)
        assert episode.truncations.tolist() == list(truncated)
        infos += more
        assert set(episode.infos) == set(infos[0])
        for name, values in episode.infos.items():
            assert np.array_equal(values, [info[name] for info in infos])


def check_equal(stored: Any, seen: list[Any]) -> None:
    if isinstance(stored, dict):
        for name, values in stored.items():
            check_equal(values, [one[name] for one in seen])
    else:
        assert np.array_equal(stored, np.stack(seen))


# Each format stores each kind of observation; levels differ in their infos.
@pytest.mark.parametrize("data_format", ["hdf5", "arrow"])
@pytest.mark.parametrize(
    ("level", "observation"),
    [*(("first-key", kind) for kind in KINDS), ("frozen-lake", ("vector", "planes"))],
    ids=str,
)
def test_what_is_recorded_comes_back(observation: Any, level: str, data_format: str) -> None:
    env: Any = gymnasium.make(
        "babyrobot/Level-v0", level=level, observation=observation, max_episode_steps=30
    )
    dataset, observations = record(env, data_format=data_format)
    again = dataset.recover_environment()
    for each in (dataset, again):
        assert each.observation_space == env.observation_space
        assert each.action_space == env.action_space
    assert again.unwrapped.level == env.unwrapped.level
    for episode, seen in zip(dataset, observations, strict=True):
        check_equal(episode.observations, seen)
    check_replay(dataset, again)


@pytest.mark.parametrize(
    ("env_id", "arguments"),
    [
        ("babyrobot/Suite-v0", {"suite": "small-mazes", "split": "test"}),
        pytest.param("babyrobot/Suite-v0", {"suite": "locked-mazes"}, marks=pytest.mark.sweep),
        ("babyrobot/random-maze-v0", {}),
        ("babyrobot/final-maze-v0", {"actions": "turns"}),
    ],
)
def test_each_episode_finds_its_level_again(env_id: str, arguments: dict[str, Any]) -> None:
    env = gymnasium.make(env_id, max_episode_steps=30, **arguments)
    dataset, _ = record(env)
    check_replay(dataset, dataset.recover_environment())


def test_a_level_of_ones_own_travels_with_the_dataset() -> None:
    level = brl.load({"version": 1, "size": [3, 2], "exit": [2, 1], "max_steps": 20})
    dataset, _ = record(level.make())
    env: Any = dataset.recover_environment()
    assert env.unwrapped.level.digest == level.digest
    check_replay(dataset, env)
