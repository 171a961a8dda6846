"""Several robots as PettingZoo's environments, tried by its own tests."""

from __future__ import annotations

import warnings
from random import Random
from typing import Any

import gymnasium
import pytest
from oracles.random_teams import random_team
from pettingzoo.utils import parallel_to_aec

import babyrobot_levels as brl
from babyrobot_levels.mdp.actions import Action

PASSING = "passing-place"
TEAMS = [fields for seed in range(30) if (fields := random_team(Random(seed))) is not None]


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_pettingzoo_finds_no_fault() -> None:
    with warnings.catch_warnings():
        # Its tests import environments in a way that it calls deprecated itself (1.27).
        warnings.simplefilter("ignore", DeprecationWarning)
        from pettingzoo.test import api_test, parallel_api_test, parallel_seed_test
    levels: list[Any] = [PASSING, "two-pads", *TEAMS]
    for level in levels:
        parallel_api_test(brl.parallel_env(level), num_cycles=20)
    parallel_seed_test(lambda: brl.parallel_env(PASSING), num_cycles=20)
    parallel_seed_test(lambda: brl.parallel_env(TEAMS[3]), num_cycles=20)
    api_test(parallel_to_aec(brl.parallel_env(PASSING)), num_cycles=50)


def test_each_agent_sees_its_own_robot_first() -> None:
    env = brl.parallel_env(PASSING)
    observations, infos = env.reset(seed=1)
    assert {name: row.tolist() for name, row in observations.items()} == {
        "red": [0, 0, 4, 0, 0, 0],
        "blue": [4, 0, 0, 0, 0, 0],
    }
    assert infos["blue"]["action_mask"].tolist() == [1, 0, 0, 0, 1]
    assert env.state().tolist() == [0, 0, 4, 0, 0, 0]


def test_who_arrives_is_done_and_the_others_go_on() -> None:
    env = brl.parallel_env(PASSING)
    env.reset(seed=1)
    way = {"red": (0, 2, 2, 2, 2), "blue": (4, 4, 3, 0, 0)}
    for red, blue in zip(*way.values(), strict=True):
        observations, rewards, terminations, truncations, _ = env.step({"red": red, "blue": blue})
    assert terminations == {"red": True, "blue": False}
    assert (env.agents, rewards, truncations["blue"]) == (["blue"], {"red": 0, "blue": -1}, False)
    assert observations["blue"].tolist() == [2, 1, 4, 0, 0, 1]
    for action in (1, 4, 4):
        _, rewards, terminations, _, _ = env.step({"blue": action})
    assert (rewards, terminations, env.agents) == ({"blue": 0}, {"blue": True}, [])
    assert env.step({}) == ({}, {}, {}, {}, {})


def test_agents_can_get_what_the_team_gets_and_are_truncated() -> None:
    env = brl.parallel_env(PASSING, rewards="team", max_cycles=2)
    env.reset(seed=1)
    env.step({"red": 0, "blue": 0})
    _, rewards, terminations, truncations, _ = env.step({"red": 2, "blue": 0})
    assert rewards == {"red": -2, "blue": -2}
    assert (terminations, truncations) == (
        {"red": False, "blue": False},
        {"red": True, "blue": True},
    )
    assert env.agents == []
    with pytest.raises(ValueError, match="rewards must be"):
        brl.parallel_env(PASSING, rewards="all")
    with pytest.raises(ValueError, match="one robot"):
        brl.parallel_env("final-maze")


@pytest.mark.parametrize(
    ("actions", "message"),
    [
        ({}, "there is no action for red, blue"),
        ([2, 2], r"actions are a dict of \['red', 'blue'\], not \[2, 2\]"),
        ({"red": 0}, "there is no action for blue"),
        ({"red": 1.5, "blue": 0}, "0 to 4 for each of the 2 robots"),
        ({"red": None, "blue": 0}, "0 to 4 for each of the 2 robots"),
        ({"red": "2", "blue": 0}, "0 to 4 for each of the 2 robots"),
    ],
)
def test_wrong_actions_are_named(actions: Any, message: str) -> None:
    env = brl.parallel_env(PASSING)
    env.reset(seed=1)
    with pytest.raises(gymnasium.error.InvalidAction, match=message):
        env.step(actions)


def test_a_step_after_the_end_does_nothing() -> None:
    """RLlib's wrapper tells no end if a robot arrives in the step that cuts off the others."""
    robots = [{"name": "red", "start": [0, 0]}, {"name": "blue", "start": [0, 1]}]
    level = {"version": 1, "size": [3, 2], "exit": [2, 0], "robots": robots}
    env = brl.parallel_env(level, max_cycles=2)
    env.reset(seed=0)
    env.step({"red": Action.EAST, "blue": Action.STAY})
    _, _, terminated, truncated, _ = env.step({"red": Action.EAST, "blue": Action.STAY})
    assert terminated == {"red": True, "blue": False}
    assert truncated == {"red": False, "blue": True}
    assert env.agents == []
    assert env.step({}) == ({}, {}, {}, {}, {})


@pytest.mark.parametrize("limit", [0, -1, 2.5, "a"])
def test_a_limit_is_a_number_of_steps(limit: Any) -> None:
    with pytest.raises(ValueError, match="max_cycles must be a whole number, at least 1"):
        brl.parallel_env(PASSING, max_cycles=limit)


def test_there_is_no_state_before_the_first_reset() -> None:
    with pytest.raises(gymnasium.error.ResetNeeded, match="before asking for the state"):
        brl.parallel_env(PASSING).state()


def test_its_render_modes_are_those_of_levels() -> None:
    modes = brl.parallel_env(PASSING).metadata["render_modes"]
    assert modes == brl.LevelEnv.metadata["render_modes"]
    for mode in modes:
        assert brl.parallel_env(PASSING, render_mode=mode).render_mode == mode


def test_a_step_before_the_first_reset_is_refused() -> None:
    with pytest.raises(gymnasium.error.ResetNeeded, match="call `reset"):
        brl.parallel_env(PASSING).step({"red": 0, "blue": 0})
