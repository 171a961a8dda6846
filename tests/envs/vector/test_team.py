"""Vector environments of several robots, held against single ones."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import babyrobot_levels as brl

SLIPPERY = {
    "version": 1,
    "size": [3, 2],
    "robots": [{"name": "a", "start": [0, 0]}, {"name": "b", "start": [0, 1]}],
    "items": [{"name": "coin", "one_of": [[1, 1], [2, 0]], "reward": 3}],
    "movers": [{"within": {"at": [1, 0], "size": [2, 1]}}],
    "hit": {"ends": False},
    "skid": 0.3,
    "max_steps": 7,
}


def same_infos(one: dict[str, Any], other: dict[str, Any]) -> None:
    """Check that the infos of a vector environment are those of single ones side by side."""
    assert one.keys() == other.keys()
    for key, values in one.items():
        others = other[key]
        if key == "final_info":
            same_infos(values, others)
        elif key == "final_obs":
            assert [str(each) for each in values] == [str(each) for each in others]
        elif key == "action_mask":
            for number in one["_action_mask"].nonzero()[0]:
                assert np.array_equal(values[number], others[number])
        else:
            assert np.array_equal(values, others), key


@pytest.mark.parametrize(
    ("level", "mode", "engine"),
    [
        ("passing-place", AutoresetMode.NEXT_STEP, "numpy"),
        (SLIPPERY, AutoresetMode.SAME_STEP, "numpy"),
        pytest.param(SLIPPERY, AutoresetMode.NEXT_STEP, "compiled", marks=pytest.mark.slow),
        pytest.param(SLIPPERY, AutoresetMode.NEXT_STEP, "numpy", marks=pytest.mark.sweep),
        pytest.param(SLIPPERY, AutoresetMode.SAME_STEP, "compiled", marks=pytest.mark.sweep),
    ],
)
def test_each_is_a_single_environment(level: Any, mode: AutoresetMode, engine: str) -> None:
    envs = brl.TeamVectorEnv(level, num_envs=3, autoreset_mode=mode, engine=engine)
    make = lambda: gymnasium.make("babyrobot/Level-v0", level=level)  # noqa: E731
    singles = SyncVectorEnv([make] * 3, autoreset_mode=mode)
    assert envs.action_space == singles.action_space
    assert envs.single_action_space == singles.single_action_space
    assert envs.observation_space == singles.observation_space
    envs.action_space.seed(1)
    found: Any = envs.reset(seed=[1, 2, 3])
    expected: Any = singles.reset(seed=[1, 2, 3])
    for _ in range(30):
        assert np.array_equal(found[0], expected[0])
        same_infos(found[-1], expected[-1])
        masks = found[-1]["action_mask"]
        actions = envs.action_space.sample()
        assert np.take_along_axis(masks, actions[..., None], 2).all()
        found, expected = envs.step(actions), singles.step(actions)
        for one, other in zip(found[1:4], expected[1:4], strict=True):
            assert np.array_equal(one, other)


def test_gymnasium_makes_it() -> None:
    envs = gymnasium.make_vec("babyrobot/Level-v0", num_envs=2, level="two-pads")
    assert isinstance(envs, brl.TeamVectorEnv)
    envs.reset(seed=1)
    assert envs.step([[2, 2], [0, 2]])[-1]["rewards"].tolist() == [[-1, -1], [-1, -1]]
    assert envs.action_masks().shape == (2, 10)


@pytest.mark.parametrize("actions", [[1, 2], [[1, 5], [0, 0]], [[0.5, 0], [0, 0]], "north"])
def test_what_are_no_actions_is_told(actions: Any) -> None:
    envs = brl.TeamVectorEnv("two-pads", num_envs=2)
    envs.reset(seed=1)
    with pytest.raises(gymnasium.error.InvalidAction, match=r"0 to 4, in an array \[2, 2\]"):
        envs.step(actions)


def test_what_it_is_not_for_is_refused() -> None:
    with pytest.raises(ValueError, match=r"one robot: use `brl\.LevelVectorEnv`"):
        brl.TeamVectorEnv("final-maze")
    envs = brl.TeamVectorEnv("two-pads")
    with pytest.raises(ValueError, match="no option `start`"):
        envs.reset(options={"start": [0, 0]})
    with pytest.raises(ValueError, match="set_levels is for levels with one robot"):
        envs.set_levels("two-pads")
