"""The wrapper that records episodes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from support.plays import record

import babyrobot_levels as brl
from babyrobot_levels.scoring.verify import verify_play


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "ada.brlplay"


@pytest.mark.parametrize("actions", ["all", "moves", "turns", "valid", "valid_moves"])
@pytest.mark.parametrize("level", ["frozen-lake", "first-key", "treasure-chests", "random-maze"])
def test_what_is_recorded_is_valid(path: Path, level: str, actions: str) -> None:
    record(path, level, actions, episodes=3)
    plays = brl.read_plays(path)
    assert len(plays) == 3
    for play in plays:
        assert verify_play(play).fault is None
        assert play.action_set == {"valid": "all", "valid_moves": "moves"}.get(actions, actions)


def test_the_seed_gives_the_same_episode(path: Path) -> None:
    record(path, "frozen-lake", seed=4)
    (play,) = brl.read_plays(path)
    assert play.seed == "4"
    env = play.level.make()
    env.reset(seed=4)
    rewards = [env.step(action)[1] for action in play.actions]
    assert rewards == play.rewards


def test_a_suite_records_the_level_of_each_episode(path: Path) -> None:
    env = brl.RecordPlay(gymnasium.make("babyrobot/Suite-v0", suite="classics"), path)
    for seed in range(4):
        env.reset(seed=seed)
        env.step(0)
    env.close()
    plays = brl.read_plays(path)
    assert len({play.digest for play in plays}) > 1
    # The seed gave the level, too: in the level alone, it gives another episode.
    assert [play.seed for play in plays] == [None] * 4
    assert all(verify_play(play).is_valid for play in plays)


def test_episodes_that_do_not_end_are_unfinished(path: Path) -> None:
    env = brl.RecordPlay(brl.load("final-maze").make(), path)
    env.reset(seed=1)
    env.reset(seed=2)
    env.step(0)
    env.reset()
    env.step(0)
    env.step(0)
    env.close()
    env.close()
    plays = brl.read_plays(path)
    assert [(play.steps, play.end, play.seed) for play in plays] == [
        (1, "unfinished", "2"),
        (2, "unfinished", None),
    ]


def test_the_time_limit_is_that_of_the_environment(path: Path) -> None:
    env = brl.RecordPlay(brl.load("final-maze").make(max_episode_steps=2), path)
    env.reset()
    env.step(0)
    env.step(0)
    # A step after the end is no part of the episode.
    env.step(0)
    env.close()
    (play,) = brl.read_plays(path)
    assert (play.steps, play.max_steps, play.end) == (2, 2, "truncated")
    assert verify_play(play).is_valid


@pytest.mark.parametrize("limits", [(2, 5), (5, 2)])
def test_of_several_time_limits_the_first_to_end_counts(
    path: Path, limits: tuple[int, int]
) -> None:
    inner = brl.load("final-maze").make(max_episode_steps=limits[0])
    env = brl.RecordPlay(gymnasium.wrappers.TimeLimit(inner, limits[1]), path)
    env.reset()
    env.step(0)
    env.step(0)
    env.close()
    (play,) = brl.read_plays(path)
    assert (play.steps, play.max_steps, play.end) == (2, 2, "truncated")
    assert verify_play(play).is_valid


def test_a_chosen_start(path: Path) -> None:
    env = brl.RecordPlay(brl.load("final-maze").make(), path)
    env.reset(options={"start": [3, 3]})
    env.step(0)
    env.close()
    (play,) = brl.read_plays(path)
    assert play.start == "chosen"
    assert verify_play(play).is_valid


def test_any_observation_and_its_wrappers(path: Path) -> None:
    env: Any = brl.load("final-maze").make(observation=("view", "position"))
    env = brl.RecordPlay(gymnasium.wrappers.FlattenObservation(env), path)
    seen, _ = env.reset(seed=1)
    assert seen in env.observation_space
    env.step(np.int64(1))
    env.close()
    assert verify_play(brl.read_plays(path)[0]).is_valid


def test_the_wrapper_belongs_to_the_spec(path: Path) -> None:
    env = brl.RecordPlay(brl.load("maze").make(), path)
    assert env.spec is not None
    again = gymnasium.make(env.spec)
    again.reset(seed=1)
    again.step(0)
    again.close()
    (play,) = brl.read_plays(path)
    assert (play.name, play.seed, play.steps) == ("maze", "1", 1)


def test_what_cannot_be_recorded_is_refused(path: Path) -> None:
    with pytest.raises(TypeError, match="RecordPlay records environments of levels, not CartPole"):
        brl.RecordPlay(gymnasium.make("CartPole-v1"), path)
    scaled: Any = gymnasium.wrappers.TransformReward(brl.load("maze").make(), lambda reward: reward)
    with pytest.raises(TypeError, match="TransformReward changes actions or rewards"):
        brl.RecordPlay(scaled, path)
    assert not path.exists()
