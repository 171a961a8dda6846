"""Environments as users extend them: the public class, its subclasses, and errors that help."""

from __future__ import annotations

import pickle
from typing import Any

import gymnasium
import pytest
from gymnasium.utils.env_checker import check_env
from support.playing import level_named

import babyrobot_levels as brl


class Bonus(brl.LevelEnv):
    """Adds a bonus for each step in which the robot skids."""

    def __init__(self, level: Any, bonus: float = 1.0, **kwargs: Any) -> None:
        super().__init__(level, **kwargs)
        self.bonus = bonus

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        observation, reward, terminated, truncated, info = super().step(action)
        return observation, reward + self.bonus * info["skidded"], terminated, truncated, info


@pytest.mark.parametrize("public", [brl.LevelEnv, brl.LevelVectorEnv, brl.Rollout])
def test_public_classes_are_of_the_package(public: type) -> None:
    assert public.__module__ == "babyrobot_levels"
    assert pickle.loads(pickle.dumps(public)) is public


def test_a_subclass_is_an_environment_of_its_own() -> None:
    env, plain = Bonus("frozen-lake", bonus=0.5), brl.LevelEnv("frozen-lake")
    check_env(env, skip_render_check=True)
    env.reset(seed=4)
    plain.reset(seed=4)
    skids = 0
    for action in [2, 3, 2, 3, 2]:
        ours, theirs = env.step(action), plain.step(action)
        assert ours[1] == theirs[1] + 0.5 * theirs[4]["skidded"]
        skids += theirs[4]["skidded"]
    assert 0 < skids < 5


def test_a_subclass_goes_on_after_pickling() -> None:
    env = Bonus(level_named("all at once"), bonus=3)
    env.reset(seed=4)
    again = pickle.loads(pickle.dumps(env))
    for action in [2, 3, 2, 3, 2]:
        ours, theirs = env.step(action), again.step(action)
        assert ours[0].tolist() == theirs[0].tolist()
        assert ours[1:4] == theirs[1:4]


# -- errors ----------------------------------------------------------------------------------


ACCEPTED = (
    "accepted arguments: observation, image_size, grayscale, view_radius, see_through, "
    "channels_last, planes_dtype, actions, render_mode"
)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"max_steps": 5}, f"'max_steps'; use `max_episode_steps`; {ACCEPTED}"),
        ({"observations": "walls"}, f"'observations'; did you mean `observation`\\?; {ACCEPTED}"),
        ({"battery": 1}, f"unexpected keyword argument 'battery'; {ACCEPTED}, max_episode_steps"),
    ],
)
def test_an_unknown_argument_names_those_that_there_are(
    given: dict[str, Any], message: str
) -> None:
    with pytest.raises(TypeError, match=message):
        brl.load("maze").make(**given)


def test_an_unknown_argument_of_a_suite_names_those_that_there_are() -> None:
    with pytest.raises(TypeError, match=f"unexpected keyword argument 'splits'.*{ACCEPTED}, split"):
        gymnasium.make("babyrobot/Suite-v0", suite="small-mazes", splits="train")
