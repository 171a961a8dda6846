"""Environments as users extend them: the public class, its subclasses, and errors that help."""

from __future__ import annotations

import pickle
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from support.playing import CORNERS, level_named

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


# -- valid moves -----------------------------------------------------------------------------


def test_valid_moves_are_the_moves_that_the_mask_allows() -> None:
    env = brl.LevelEnv("final-maze", actions="valid_moves")
    env.action_space.seed(1)
    _, info = env.reset(seed=1)
    assert env.action_space == gymnasium.spaces.Discrete(4)
    for _ in range(200):
        action = int(env.action_space.sample())
        assert info["action_mask"].shape == (4,)
        assert info["action_mask"][action] == 1
        *_, info = env.step(action)


def test_valid_moves_of_many_environments() -> None:
    envs = brl.LevelVectorEnv("final-maze", num_envs=100, actions="valid_moves")
    envs.action_space.seed(1)
    _, info = envs.reset(seed=1)
    seen = set()
    for _ in range(50):
        actions = envs.action_space.sample()
        masks = info["action_mask"]
        # At an exit, no move is allowed.
        assert (masks[np.arange(100), actions] == masks.any(axis=1)).all()
        seen |= set(actions.tolist())
        *_, info = envs.step(actions)
    assert seen == {0, 1, 2, 3}


@pytest.mark.parametrize("actions", ["moves", "valid_moves"])
def test_where_no_move_is_allowed_the_space_gives_its_first(actions: str) -> None:
    env = brl.LevelEnv(CORNERS["a start that is shut in"], actions=actions)
    _, info = env.reset()
    assert info["action_mask"].tolist() == [0, 0, 0, 0]
    drawn = {int(env.action_space.sample()) for _ in range(50)}
    assert drawn == ({0} if actions == "valid_moves" else {0, 1, 2, 3})


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
