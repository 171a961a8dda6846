"""Stable-Baselines3's `VecEnv` of many robots: what it says is what single environments say."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
import pytest
from support.playing import noted, plain

import babyrobot_levels as brl
from babyrobot_levels.envs.observations import OBSERVATIONS

if TYPE_CHECKING:
    from stable_baselines3.common.vec_env import DummyVecEnv

    from babyrobot_levels.envs.sb3 import LevelVecEnv

pytestmark = pytest.mark.libraries


TRAPS: dict[str, Any] = {
    "version": 1,
    "size": [3, 2],
    "exit": [2, 1],
    "areas": [{"at": [1, 1], "ends": True, "reward": -9}],
    "walls": [{"at": [0, 0], "side": "E"}],
    "rewards": {"bump": -2},
}
"""Many episodes end here at once, some at the very step that would cut them off."""


GUARDED: dict[str, Any] = {
    "version": 1,
    "size": [3, 2],
    "exit_needs": "key",
    "items": [{"name": "coin", "at": [0, 1], "reward": 2}, {"name": "key", "at": [1, 0]}],
    "movers": [{"path": [[1, 1], [2, 1]], "back": True}],
    "hit": {"ends": False},
}
"""Items are taken and the guard is met within a few steps, but no episode ends before the limit."""

LEVELS: dict[str, Any] = {"traps": TRAPS, "guarded": GUARDED, "teleport-pads": "teleport-pads"}
CASES = [
    *(("guarded", observation, "valid") for observation in OBSERVATIONS),
    *(("traps", observation, "turns") for observation in OBSERVATIONS),
    *product(LEVELS, [("vector", "planes", "index")], ["valid", "turns"]),
]


def many(level: Any = "final-maze", num_envs: int = 5, **kwargs: Any) -> LevelVecEnv:
    from babyrobot_levels.envs.sb3 import LevelVecEnv

    return LevelVecEnv(level, num_envs=num_envs, **kwargs)


def one_by_one(level: Any, num_envs: int = 5, **kwargs: Any) -> DummyVecEnv:
    from stable_baselines3.common.vec_env import DummyVecEnv

    def make() -> gymnasium.Env[Any, Any]:
        return gymnasium.make("babyrobot/Level-v0", level=level, **kwargs)

    return DummyVecEnv([make] * num_envs)


def told(infos: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return infos as data that can be compared with `==`."""
    return [noted(info) for info in infos]


class Knows:
    """A model that follows the best policy of a level with `"position"` observations."""

    def __init__(self, level: Any) -> None:
        self.policy = brl.solve(level).policy

    def predict(self, observations: Any, **_: Any) -> tuple[Any, None]:
        return self.policy[observations[:, 1], observations[:, 0]], None


# -- the contract ----------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "observation", "actions"), CASES, ids=str)
def test_it_walks_as_single_environments_do(name: str, observation: Any, actions: str) -> None:
    level = LEVELS[name]
    kwargs: dict[str, Any] = {"observation": observation, "actions": actions}
    kwargs["max_episode_steps"] = 6
    ours, theirs = many(level, **kwargs), one_by_one(level, **kwargs)
    assert ours.observation_space == theirs.observation_space
    assert ours.action_space == theirs.action_space
    begun = ours.reset(), theirs.reset()
    assert plain(begun[0]) == plain(begun[1])
    assert told(ours.reset_infos) == told(theirs.reset_infos)
    rng, ends = np.random.default_rng(1), set()
    for _ in range(60):
        taken = rng.integers(ours.action_space.n, size=5)
        observations, rewards, dones, infos = ours.step(taken)
        expected = theirs.step(taken)
        assert plain(observations) == plain(expected[0])
        assert plain(rewards) == plain(expected[1])
        assert plain(dones) == plain(expected[2])
        assert told(infos) == told(expected[3])
        for info, other in zip(ours.reset_infos, theirs.reset_infos, strict=True):
            assert noted(info) == noted(other)
        ends |= {info["TimeLimit.truncated"] for info in infos if "terminal_observation" in info}
    # Traps and guards end episodes before the limit does.
    assert ends == ({True} if name == "teleport-pads" else {True, False})


def test_a_seed_is_used_once() -> None:
    envs = many("four-corners", num_envs=20)
    envs.seed(3)
    first = envs.reset().tolist()
    assert envs.reset().tolist() != first
    envs.seed(3)
    assert envs.reset().tolist() == first


def test_options_are_used_once_and_are_the_same_for_all() -> None:
    envs = many("maze")
    envs.set_options({"start": [3, 2]})
    assert envs.reset().tolist() == [[3, 2]] * 5
    assert envs.reset().tolist() == [[0, 0]] * 5
    envs.set_options([{"start": [3, 2]}, *[{}] * 4])
    with pytest.raises(ValueError, match="same options"):
        envs.reset()
    envs.set_options({"start": [9, 9]})
    with pytest.raises(ValueError, match="start"):
        envs.reset()
    assert envs.reset().tolist() == [[0, 0]] * 5


def test_infos_of_the_end_are_about_the_old_level_and_reset_infos_about_the_new_one() -> None:
    levels = ["maze", "default"]
    envs = many(None, num_envs=30, levels=levels, draw_levels=True, max_episode_steps=1)
    envs.seed(1)
    envs.reset()
    for _ in range(3):
        before = [levels.index(level.name) for level in envs.get_attr("level")]
        assert [info["level_index"] for info in envs.reset_infos] == before
        infos = envs.step(np.zeros(30, int))[3]
        assert [info["level_index"] for info in infos] == before


@pytest.mark.parametrize("argument", [{"copy": False}, {"autoreset_mode": "NextStep"}])
def test_what_stable_baselines_could_not_bear_is_refused(argument: dict[str, Any]) -> None:
    with pytest.raises(TypeError, match="multiple values"):
        many(**argument)


# -- one robot of many -----------------------------------------------------------------------


def test_masks() -> None:
    from sb3_contrib.common.maskable.utils import get_action_masks, is_masking_supported
    from stable_baselines3.common.vec_env import VecMonitor

    envs = VecMonitor(many(max_episode_steps=9))
    assert is_masking_supported(envs)
    observations = envs.reset()
    possible = brl.load("final-maze").compile().action_mask
    rng = np.random.default_rng(5)
    for _ in range(40):
        masks = get_action_masks(envs)
        assert masks.tolist() == possible[observations @ [1, 8]].tolist()
        observations = envs.step([rng.choice(mask.nonzero()[0]) for mask in masks])[0]
    some = envs.env_method("action_masks", indices=[3, 1])
    assert [mask.tolist() for mask in some] == get_action_masks(envs)[[3, 1]].tolist()


def test_attributes() -> None:
    from stable_baselines3.common.monitor import Monitor

    envs = many()
    assert envs.get_attr("observation_space", indices=2) == [envs.observation_space]
    assert envs.get_attr("render_mode") == [None] * 5
    assert envs.has_attr("level")
    assert not envs.has_attr("nonsense")
    with pytest.raises(AttributeError):
        envs.get_attr("nonsense")
    envs.set_attr("render_mode", "rgb_array")
    assert envs.get_attr("render_mode", [0, 4]) == ["rgb_array"] * 2
    with pytest.raises(ValueError, match="share"):
        envs.set_attr("render_mode", None, indices=[0])
    with pytest.raises(AttributeError, match="'level' cannot be set"):
        envs.set_attr("level", "maze")
    assert envs.env_is_wrapped(Monitor, indices=[0, 1]) == [False, False]
    envs.close()


def test_the_picture_shows_the_robots_side_by_side() -> None:
    envs = many("default", num_envs=4, render_mode="rgb_array")
    assert envs.render_mode == "rgb_array"
    envs.reset()
    picture = envs.render()
    assert picture is not None
    frames = envs.envs.render()
    assert [*map(plain, envs.get_images())] == [*map(plain, frames)]
    assert picture.shape == (2 * frames[0].shape[0], 2 * frames[0].shape[1], 3)


# -- what Stable-Baselines3 puts around it ---------------------------------------------------


def test_monitors_and_evaluation_find_the_best_return_of_the_best_policy() -> None:
    from stable_baselines3.common.evaluation import evaluate_policy
    from stable_baselines3.common.vec_env import VecMonitor, VecNormalize

    envs = VecNormalize(VecMonitor(many("maze", num_envs=3)), norm_obs=False)
    model: Any = Knows("maze")
    returns, lengths = evaluate_policy(model, envs, n_eval_episodes=7, return_episode_rewards=True)
    assert (returns, lengths) == ([-32] * 7, [33] * 7)


def test_a_model_is_saved_and_loaded_with_either_kind_of_environment(tmp_path: Path) -> None:
    from stable_baselines3 import PPO
    from stable_baselines3.common.utils import check_for_correct_spaces

    envs = many()
    learner = PPO("MlpPolicy", envs, n_steps=16, batch_size=40, n_epochs=1, seed=6)
    learner.learn(160)
    learner.save(tmp_path / "model")
    cells = np.array([[x, y] for x in range(8) for y in range(5)])
    expected, _ = learner.predict(cells, deterministic=True)
    for others in (many(), one_by_one("final-maze")):
        check_for_correct_spaces(others, learner.observation_space, learner.action_space)
        loaded = PPO.load(tmp_path / "model", env=others)
        assert loaded.predict(cells, deterministic=True)[0].tolist() == expected.tolist()
        loaded.learn(80)
    with pytest.raises(ValueError, match="Action spaces do not match"):
        PPO.load(tmp_path / "model", env=many(actions="moves"))
