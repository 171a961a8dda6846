"""Episodes as datasets of Minari: read back, and repeated by the environment they recover."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.plays import forged, record

import babyrobot_levels as brl

pytestmark = [
    pytest.mark.libraries,
    # The datasets of tests have no authors.
    pytest.mark.filterwarnings("ignore:.* is set to None:UserWarning"),
    # Minari leaves the removal of its temporary folder to the end of the process.
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore:Implicitly cleaning up:ResourceWarning"),
]

NAME = "babyrobot/test-v0"


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path / "datasets"))


def loaded() -> Any:
    import minari

    return minari.load_dataset(NAME)


def check_repeated(dataset: Any) -> None:
    """The recovered environment gives the same episodes."""
    env = dataset.recover_environment()
    told = dataset.storage.get_episode_metadata(dataset.episode_indices)
    for episode, metadata in zip(dataset, told, strict=True):
        observation, _ = env.reset(seed=metadata["seed"], options=metadata.get("options"))
        assert np.array_equal(episode.observations[0], observation)
        for step, action in enumerate(episode.actions):
            observation, reward, terminated, truncated, _ = env.step(action)
            assert np.array_equal(episode.observations[step + 1], observation)
            assert episode.rewards[step] == reward
            assert (episode.terminations[step], episode.truncations[step]) == (
                terminated,
                truncated,
            )


@pytest.mark.parametrize(
    ("level", "actions", "observation"),
    [
        ("frozen-lake", "all", "position"),
        ("frozen-lake", "moves", "view"),
        ("first-key", "turns", "index"),
        ("treasure-chests", "all", "vector"),
    ],
)
def test_plays_come_back(tmp_path: Path, level: str, actions: str, observation: str) -> None:
    path = tmp_path / "ada.brlplay"
    record(path, level, actions, episodes=3)
    plays = brl.read_plays(path)
    brl.to_minari(plays, NAME, observation=observation, author="Ada")
    dataset = loaded()
    assert dataset.total_episodes == 3
    assert [episode.actions.tolist() for episode in dataset] == [play.actions for play in plays]
    assert [episode.rewards.tolist() for episode in dataset] == [play.rewards for play in plays]
    check_repeated(dataset)
    (exact,) = brl.score(level, "random", actions=actions)
    metadata = dataset.storage.metadata
    assert metadata["ref_min_score"] == pytest.approx(exact.random)
    assert metadata["ref_max_score"] == pytest.approx(exact.optimum)


def test_a_chosen_start_and_a_limit_of_its_own_come_back(tmp_path: Path) -> None:
    path = tmp_path / "ada.brlplay"
    env = brl.RecordPlay(brl.load("final-maze").make(max_episode_steps=3), path)
    env.reset(seed=5, options={"start": [3, 3]})
    for action in (1, 2, 3):
        env.step(action)
    env.reset()
    env.step(0)
    env.close()
    brl.to_minari(brl.read_plays(path), NAME)
    dataset = loaded()
    # The last episode did not end.
    assert dataset.total_episodes == 1
    check_repeated(dataset)


def test_rollouts_come_back() -> None:
    level = brl.load("frozen-lake")
    data = brl.rollout(level, "random", 4, 50, seed=1, actions="moves")
    brl.to_minari(data, NAME, level=level, actions="moves", observation="index")
    dataset = loaded()
    ended = data.terminations | data.truncations
    assert dataset.total_episodes == ended.sum()
    first = dataset[0]
    count = int(ended[:, 0].argmax()) + 1
    assert first.actions.tolist() == data.actions[:count, 0].tolist()
    assert first.observations[:-1].tolist() == data.observations[:count, 0].tolist()
    assert first.observations[-1] == data.next_observations[count - 1, 0]
    assert first.terminations[-1] != first.truncations[-1]


SUITE = {
    "version": 1,
    "kind": "suite",
    "seed": 3,
    "count": 12,
    "splits": {"train": 0.5, "test": 0.5},
    "size": {"min": [3, 2], "max": [5, 4]},
    "max_steps": 40,
}


@pytest.mark.parametrize("data_format", ["hdf5", "arrow"])
def test_a_split_of_a_suite_comes_back_with_the_level_of_each_episode(data_format: str) -> None:
    train = brl.load_suite(SUITE).split("train")
    data = brl.rollout(train, "random", num_envs=len(train), num_steps=200, seed=1)
    brl.to_minari(data, NAME, level=train, observation="view", per_level=4, data_format=data_format)
    dataset = loaded()
    told = [*dataset.storage.get_episode_metadata(dataset.episode_indices)]
    assert [each["digest"] for each in told] == [level.digest for level in train for _ in range(4)]
    assert brl.loads(told[-1]["level"]).digest == told[-1]["digest"]
    # No level of the test split is in it.
    test = {level.digest for level in brl.load_suite(SUITE).split("test")}
    assert test.isdisjoint(each["digest"] for each in told)
    scores = brl.score(train, "random")
    metadata = dataset.storage.metadata
    assert metadata["ref_min_score"] == pytest.approx(np.mean([each.random for each in scores]))
    assert metadata["ref_max_score"] == pytest.approx(np.mean([each.optimum for each in scores]))
    # Nothing is random in these levels but the policy: the environment repeats the episodes.
    env = dataset.recover_environment()
    for episode, metadata in zip(dataset, told, strict=True):
        observation, _ = env.reset(options=metadata["options"])
        assert env.unwrapped.level.digest == metadata["digest"]
        for step, action in enumerate(episode.actions):
            assert np.array_equal(episode.observations[step], observation)
            observation, reward, terminated, truncated, _ = env.step(action)
            assert reward == episode.rewards[step]
        assert (terminated, truncated) == (episode.terminations[-1], episode.truncations[-1])


def test_what_makes_no_dataset_of_a_suite_is_refused() -> None:
    suite = brl.load_suite(SUITE)
    data = brl.rollout(suite, "random", num_envs=3, num_steps=60, seed=1)
    with pytest.raises(ValueError, match="not of a slice"):
        brl.to_minari(data, NAME, level=suite[:3])
    with pytest.raises(ValueError, match=r"only \d episodes ended, not 50: follow the policy for"):
        brl.to_minari(data, NAME, level=suite, per_level=50)


def test_what_makes_no_dataset_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "ada.brlplay"
    record(path, "frozen-lake")
    record(path, "first-key")
    lake, key = brl.read_plays(path)
    with pytest.raises(ValueError, match="a dataset is of one level"):
        brl.to_minari([lake, key], NAME)
    with pytest.raises(brl.PlayError, match="play 1 is not valid"):
        brl.to_minari([forged(lake, **{"return": 7.0})], NAME)
    with pytest.raises(ValueError, match="there are no plays"):
        brl.to_minari([], NAME)
    with pytest.raises(ValueError, match="give level"):
        brl.to_minari(brl.rollout("maze", num_steps=5), NAME)
