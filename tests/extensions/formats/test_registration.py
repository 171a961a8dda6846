"""Notebooks of PyPI babyrobot: `gymnasium.make("BabyRobot-v0", **setup)`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import gymnasium
import pytest
from gymnasium.envs.registration import registry
from gymnasium.utils.env_checker import check_env

import babyrobot_levels as brl

SETUP: dict[str, Any] = {
    "width": 8,
    "height": 5,
    "end": [5, 4],
    "add_maze": True,
    "maze_seed": 42,
    "walls": [((2, 0), "E")],
    "puddles": [((2, 2), 1)],
}


@pytest.fixture(autouse=True)
def registered() -> Iterator[None]:
    brl.register_babyrobot()
    yield
    registry.pop("BabyRobot-v0", None)


def test_a_setup_is_played_as_a_level() -> None:
    env = gymnasium.make("BabyRobot-v0", **SETUP)
    assert env.unwrapped.level.digest == brl.from_setup(SETUP).digest  # type: ignore[attr-defined]
    observation, info = env.reset(seed=1)
    assert observation.tolist() == [0, 0]
    assert info["action_mask"].tolist() == [1, 0, 1, 0, 0]
    env.close()


def test_rendering_comes_before_the_first_reset_as_in_the_notebooks() -> None:
    env = gymnasium.make("BabyRobot-v0", render_mode="ansi", **SETUP)
    assert "E" in str(env.render())


@pytest.mark.parametrize(("space", "samples"), [("dynamic", {0, 2}), ("discrete", {0, 1, 2, 3, 4})])
def test_the_action_space_is_the_one_asked_for(space: str, samples: set[int]) -> None:
    env = gymnasium.make("BabyRobot-v0", action_space=space, **SETUP)
    env.reset(seed=1)
    env.action_space.seed(1)
    assert {int(env.action_space.sample()) for _ in range(100)} == samples


@pytest.mark.parametrize("keyword", ["max_steps", "max_episode_steps"])
def test_limits_truncate(keyword: str) -> None:
    limit: Any = 3
    env = gymnasium.make("BabyRobot-v0", **SETUP, **{keyword: limit})
    env.reset(seed=1)
    ends = [env.step(0)[2:4] for _ in range(3)]
    assert ends == [(False, False), (False, False), (False, True)]


def test_the_checker_of_gymnasium_passes() -> None:
    check_env(gymnasium.make("BabyRobot-v0", **SETUP).unwrapped, skip_render_check=True)


def test_registering_replaces_another_environment_without_a_warning() -> None:
    gymnasium.register("BabyRobot-v1", entry_point="nowhere:Nothing")
    registry["BabyRobot-v0"] = registry.pop("BabyRobot-v1")
    brl.register_babyrobot()
    brl.register_babyrobot()
    assert gymnasium.make("BabyRobot-v0").unwrapped.level.size == (3, 3)  # type: ignore[attr-defined]
