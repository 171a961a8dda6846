"""Levels with things, and turns: single and vector environments and rollouts go the same way."""

from __future__ import annotations

from functools import cache
from random import Random
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from oracles.random_things import random_level
from support.combinations import combined
from support.each import for_each
from support.fleets import ENGINES, MODES, SEEDS, SIZE, assert_same_walks, single
from support.playing import level_named

import babyrobot_levels as brl
from babyrobot_levels.envs.vector.env import LevelVectorEnv, SuiteVectorEnv
from babyrobot_levels.library.level import Level

ACTIONS = ("all", "moves", "turns")
SUITE = {
    "version": 1,
    "kind": "suite",
    "name": "locked",
    "count": 400,
    "seed": 3,
    "size": {"min": [4, 4], "max": [5, 5]},
    "exit": "farthest",
    "keys": {"min": 0, "max": 2},
    "coins": {"min": 0, "max": 2},
    "guards": {"min": 0, "max": 1},
    "max_steps": 12,
}
PASSING: dict[str, Any] = {
    "version": 1,
    "size": [4, 2],
    "exit": "none",
    "movers": [{"path": [[3, 0], [2, 0], [1, 0], [0, 0]], "back": True}],
    "hit": {"reward": -7},
}
"""A robot that walks east from [0, 0] changes places with the mover in its second step."""


def random_named(seed: int) -> Level:
    return Level.from_fields(random_level(Random(seed))).replace(max_steps=1 + seed % 20)


def assert_same_everywhere(level: Level, actions: str, mode: AutoresetMode, steps: int) -> None:
    """Walk with both engines, with single environments, and in a rollout."""
    given: dict[str, Any] = {"actions": actions, "observation": "walls"}
    for engine in ENGINES:
        envs = LevelVectorEnv(level, num_envs=SIZE, engine=engine, autoreset_mode=mode, **given)
        assert_same_walks(envs, single([level], **given), SEEDS, steps)
        assert_same_rollout(level, actions, engine, steps)


@pytest.mark.slow
@pytest.mark.parametrize("actions", ["all", "turns"])
@for_each(
    "name", ["first-key", "things of all kinds", "an item under a start, and hits that do not end"]
)
def test_levels_with_things_look_the_same_everywhere(name: str, actions: str) -> None:
    level = level_named(name).replace(max_steps=30)
    for number, engine in enumerate(ENGINES):
        mode = MODES[(len(name) + number) % len(MODES)]
        given: dict[str, Any] = {
            "observation": ("planes", "vector", "index"),
            "actions": actions,
            "channels_last": number == 0,
            "planes_dtype": ("float32", "uint8")[number],
        }
        envs = LevelVectorEnv(level, num_envs=SIZE, engine=engine, autoreset_mode=mode, **given)
        assert_same_walks(envs, single([level], **given), SEEDS, 25)


def assert_same_rollout(level: Level, actions: str, engine: str, steps: int) -> None:
    rolled = brl.rollout(
        level, "uniform", num_envs=SIZE, num_steps=steps, seed=4, actions=actions, engine=engine
    )
    envs = LevelVectorEnv(
        level,
        num_envs=SIZE,
        observation="index",
        actions=actions,
        autoreset_mode="SameStep",
        engine=engine,
    )
    observations, info = envs.reset(seed=4)
    for row in range(steps):
        assert rolled.observations[row].tolist() == observations.tolist()
        assert rolled.action_masks[row].tolist() == info["action_mask"].tolist()
        observations, rewards, terminated, truncated, info = envs.step(rolled.actions[row])
        assert rolled.rewards[row].tolist() == rewards.tolist()
        assert rolled.terminations[row].tolist() == terminated.tolist()
        assert rolled.truncations[row].tolist() == truncated.tolist()
        ended = np.where(terminated | truncated, info.get("final_obs", observations), observations)
        assert rolled.next_observations[row].tolist() == ended.tolist()


@pytest.mark.slow
@pytest.mark.parametrize("mode", MODES)
@for_each("seed", range(6))
def test_random_levels_are_walked_the_same_way_everywhere(seed: int, mode: AutoresetMode) -> None:
    assert_same_everywhere(random_named(seed), ACTIONS[seed % 3], mode, 15)


@pytest.mark.sweep
@pytest.mark.parametrize("mode", MODES)
@for_each("seed", range(6, 120))
def test_many_random_levels_are_walked_the_same_way_everywhere(
    seed: int, mode: AutoresetMode
) -> None:
    assert_same_everywhere(random_named(seed), ACTIONS[seed % 3], mode, 40)


# -- hits ------------------------------------------------------------------------------------


@pytest.mark.parametrize("engine", ENGINES)
def test_a_hit_ends_the_episode_in_a_state_in_which_another_goes_on(engine: str) -> None:
    envs = LevelVectorEnv(PASSING, num_envs=2, observation="index", engine=engine)
    state = 2 * 8 + 2  # The mover is in phase 2 and the robot at [2, 0].
    assert not brl.load(PASSING).compile().is_terminal[state]
    envs.reset(seed=1)
    # One meets the mover; the other lets it pass and goes round it.
    first, second = [2, 2], [3, 2, 2, 0, 0, 0, 0, 1]
    told = [envs.step([*each]) for each in zip([*first, *[0] * 6], second, strict=True)]
    _, rewards, terminated, _, info = told[1]
    assert told[1][0].tolist()[0] == state
    assert (rewards[0], terminated[0], info["hit"][0]) == (-7, True, True)
    assert info["_hit"].all()
    observations, rewards, terminated, _, info = told[7]
    assert observations[1] == state
    assert (rewards[1], terminated[1], info["hit"][1]) == (-1, False, False)
    # The step after the end began a new episode.
    observations, _, terminated, _, info = told[2]
    assert (observations[0], terminated[0], info["hit"][0]) == (0, False, False)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_hit_is_told_of_the_episode_that_it_ends(engine: str) -> None:
    envs = LevelVectorEnv(PASSING, num_envs=2, engine=engine, autoreset_mode="SameStep")
    envs.reset(seed=1)
    envs.step([2, 0])
    *_, info = envs.step([2, 0])
    assert info["hit"].tolist() == [False, False]
    assert info["final_info"]["hit"].tolist() == [True, False]
    assert info["final_info"]["_hit"].tolist() == [True, False]


@pytest.mark.parametrize("engine", ENGINES)
def test_rollouts_end_with_a_hit(engine: str) -> None:
    level = brl.load(PASSING)
    policy = np.full(level.compile().shape, brl.Action.EAST)
    rolled = brl.rollout(level, policy, num_steps=4, engine=engine)
    assert rolled.terminations[:, 0].tolist() == [False, True, False, True]
    assert rolled.rewards[:, 0].tolist() == [-1, -7, -1, -7]
    assert rolled.next_observations[1, 0] == 2 * 8 + 2


# -- infos -----------------------------------------------------------------------------------


@pytest.mark.parametrize("engine", ENGINES)
def test_items_are_told_in_the_order_of_the_level_for_as_many_as_the_richest_level_has(
    engine: str,
) -> None:
    names = [f"coin-{number}" for number in range(9)]
    many = {
        "version": 1,
        "size": [10, 1],
        "items": [{"name": name, "at": [1 + number, 0]} for number, name in enumerate(names)],
        "exit": "none",
    }
    one = {"version": 1, "size": [3, 1], "items": [{"name": "key", "at": [1, 0]}]}
    none = {"version": 1, "size": [3, 1]}
    envs = LevelVectorEnv(levels=[many, one, none], engine=engine)
    _, info = envs.reset(seed=1)
    assert info["held"].shape == (3, 9)
    assert info["held"].dtype == np.bool_
    assert not info["held"].any()
    assert info["_held"].tolist() == [True, True, False]
    assert "hit" not in info
    *_, info = envs.step([2, 2, 2])
    assert info["held"].sum(axis=1).tolist() == [1, 1, 0]
    for _ in range(8):
        *_, info = envs.step([2, 0, 0])
    assert info["held"][0].all()
    assert info["held"][1].tolist() == [True, *[False] * 8]


@pytest.mark.parametrize("engine", ENGINES)
def test_only_environments_that_are_reset_tell_what_is_held(engine: str) -> None:
    level = {
        "version": 1,
        "size": [3, 1],
        "exit": "none",
        "items": [{"name": "key", "at": [0, 0]}],
        "movers": [{"path": [[2, 0]]}],
    }
    envs = LevelVectorEnv(level, num_envs=2, autoreset_mode="Disabled", engine=engine)
    envs.reset(seed=1)
    *_, terminated, _, info = envs.step([2, 2])
    assert info["held"].tolist() == [[True], [True]]
    *_, terminated, _, info = envs.step([2, 0])
    assert terminated.tolist() == info["hit"].tolist() == [True, False]
    _, info = envs.reset(options={"reset_mask": terminated})
    assert info["held"].tolist() == [[True], [False]]
    assert info["_held"].tolist() == info["_hit"].tolist() == [True, False]
    assert info["hit"].tolist() == [False, False]


# -- starts ----------------------------------------------------------------------------------


@pytest.mark.slow
@combined(1, engine=ENGINES, actions=["all", "turns"])
def test_a_start_that_is_asked_for_leaves_what_is_drawn_to_chance(
    engine: str, actions: str
) -> None:
    level = level_named("things of all kinds")
    given: dict[str, Any] = {"actions": actions}
    envs = LevelVectorEnv(level, num_envs=SIZE, engine=engine, **given)
    theirs = [level.make(**given) for _ in range(SIZE)]
    seen = set()
    for seeds in (SEEDS, *[None] * 12):
        observations, _ = envs.reset(seed=seeds, options={"start": [0, 2]})
        for number, env in enumerate(theirs):
            seed = None if seeds is None else seeds[number]
            observation, _ = env.reset(seed=seed, options={"start": [0, 2]})
            assert observations[number].tolist() == observation.tolist()
        seen |= {tuple(row) for row in observations.tolist()}
    assert {row[:2] for row in seen} == {(0, 2)}
    assert len(seen) == 4  # Two exits, two places of the gem.


# -- levels that are made at resets ----------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("observation", "actions"),
    [
        ("walls", "all"),
        pytest.param("index", "turns", marks=pytest.mark.sweep),
        pytest.param("view", "turns", marks=pytest.mark.sweep),
    ],
)
@pytest.mark.parametrize("engine", ENGINES)
def test_levels_of_a_suite_with_different_things_are_walked_as_alone(
    engine: str, actions: str, observation: str
) -> None:
    given: dict[str, Any] = {"actions": actions, "observation": observation}
    envs: Any = SuiteVectorEnv(SUITE, num_envs=SIZE, engine=engine, **given)
    assert_same_walks(
        envs, lambda _: gymnasium.make("babyrobot/Suite-v0", suite=SUITE, **given), SEEDS, 50
    )
    configurations = {level.compile().num_configurations for level in envs._slots.levels if level}
    assert len(configurations) > 5
    for level in envs._slots.levels:
        radices = level.things().radices if level else ()
        assert all(map(int.__le__, radices, envs.suite.bounds.radices))
        assert len(radices) <= len(envs.suite.bounds.radices)


@cache
def two_small_and_a_large() -> tuple[int, int, int]:
    """Return the numbers of levels in the suite: two without configurations, one with many."""
    size = [level.compile().num_configurations for level in brl.load_suite(SUITE)[:60]]
    first, second, *_ = (number for number, count in enumerate(size) if count == 1)
    return first, second, int(np.argmax(size))


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
def test_an_episode_goes_on_while_the_tables_grow_for_a_larger_level(engine: str) -> None:
    suite = brl.load_suite(SUITE)
    first, second, other = two_small_and_a_large()
    given: dict[str, Any] = {"max_episode_steps": -1}
    envs: Any = SuiteVectorEnv(
        suite[first:60], num_envs=2, autoreset_mode="Disabled", engine=engine, **given
    )
    alone: Any = gymnasium.make("babyrobot/Suite-v0", suite=suite, **given).unwrapped
    envs.reset(seed=1, options={"index": [0, second - first]})
    alone.reset(seed=1, options={"index": second})
    room = envs._slots._room.states
    for step, action in enumerate([2, 3, 1, 4] * 5):
        if step == 2:
            mask = np.array([True, False])
            envs.reset(options={"reset_mask": mask, "index": other - first})
            assert envs._slots._room.states > room
        told, _, terminated, *_ = envs.step([0, action])
        wanted = alone.step(action)
        assert told[1].tolist() == wanted[0].tolist()
        begin = envs._tables.offset[envs._envs.level[1]]
        assert envs._envs.state[1] - begin == alone.state
        assert not terminated.any()


@pytest.mark.slow
@combined(1, engine=ENGINES, actions=["all", "turns"])
def test_random_mazes_with_things_are_walked_as_alone(engine: str, actions: str) -> None:
    level = level_named("random mazes with things").replace(max_steps=8)
    envs = LevelVectorEnv(level, num_envs=SIZE, engine=engine, actions=actions)
    assert_same_walks(envs, single([level], actions=actions), SEEDS, 50)


# -- policies --------------------------------------------------------------------------------


@combined(1, engine=ENGINES, actions=["all", "turns"])
def test_rollouts_of_an_optimal_policy_earn_its_value(engine: str, actions: str) -> None:
    level = brl.load("first-key")
    best = brl.solve(level, actions=actions)
    rolled = brl.rollout(level, best, num_envs=3, num_steps=100, actions=actions, engine=engine)
    ends = rolled.terminations[:, 0].nonzero()[0]
    assert rolled.rewards[: ends[0] + 1, 0].sum() == pytest.approx(best.expected_return)
