"""Whole rollouts: what they say happened could have happened, and is what environments play."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.fleets import ENGINES, levels, same
from support.playing import level_named

import babyrobot_levels as brl
from babyrobot_levels.envs import rollout as rollouts
from babyrobot_levels.envs.vector.env import LevelVectorEnv
from babyrobot_levels.library.level import Level

FIELDS = {
    "observations": np.int32,
    "actions": np.int8,
    "rewards": np.float64,
    "terminations": np.bool_,
    "truncations": np.bool_,
    "next_observations": np.int32,
}


@settings(max_examples=12, deadline=None)
@given(
    played=st.lists(levels(), min_size=1, max_size=3),
    seed=st.integers(0, 99),
    actions=st.sampled_from(["all", "moves"]),
    engine=st.sampled_from(ENGINES),
)
@pytest.mark.slow
def test_a_vector_environment_that_takes_its_actions_goes_the_same_way(
    played: list[Level], seed: int, actions: str, engine: str
) -> None:
    rolled = brl.rollout(
        played, "uniform", num_envs=5, num_steps=30, seed=seed, actions=actions, engine=engine
    )
    envs = LevelVectorEnv(
        levels=played,
        num_envs=5,
        observation="index",
        actions=actions,
        autoreset_mode="SameStep",
        engine=engine,
    )
    width = max(level.size[0] for level in played)
    own = np.array([played[number % len(played)].size[0] for number in range(5)])

    def shown(states: Any) -> Any:
        """Return states as an environment numbers them, by the largest width."""
        return (states // own * width + states % own).tolist()

    observations, info = envs.reset(seed=seed)
    for row in range(30):
        assert shown(rolled.observations[row]) == observations.tolist()
        assert rolled.action_masks[row].tolist() == info["action_mask"].tolist()
        observations, rewards, terminated, truncated, info = envs.step(rolled.actions[row])
        assert rolled.rewards[row].tolist() == rewards.tolist()
        assert rolled.terminations[row].tolist() == terminated.tolist()
        assert rolled.truncations[row].tolist() == truncated.tolist()
        ended = np.where(terminated | truncated, info.get("final_obs", observations), observations)
        assert shown(rolled.next_observations[row]) == ended.tolist()


@pytest.mark.parametrize("engine", ENGINES)
def test_how_many_steps_share_a_block_of_draws_makes_no_difference(
    engine: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    given: dict[str, Any] = {"num_envs": 7, "num_steps": 200, "seed": 4, "engine": engine}
    rolled = brl.rollout(level_named("all at once"), "uniform", **given)
    assert rolled.truncations.any()
    assert rolled.terminations.any()
    monkeypatch.setattr(rollouts, "CHUNK", 40)
    again = brl.rollout(level_named("all at once"), "uniform", **given)
    assert same(vars(again), vars(rolled))


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("num_envs", [1, 3, 20_000])
def test_shapes_and_kinds(engine: str, num_envs: int) -> None:
    rolled = brl.rollout("final-maze", num_envs=num_envs, num_steps=3, seed=1, engine=engine)
    for name, kind in FIELDS.items():
        array = getattr(rolled, name)
        assert (array.shape, array.dtype) == ((3, num_envs), np.dtype(kind))
    assert rolled.action_masks.shape == (3, num_envs, 5)
    assert rolled.action_masks.dtype == np.int8
    assert set(vars(rolled)) == {*FIELDS, "action_masks"}


@pytest.mark.parametrize("engine", ENGINES)
def test_chance_comes_out_as_the_solution_expects(engine: str) -> None:
    solution = brl.solve("final-maze", discount=1.0)
    rolled = brl.rollout("final-maze", solution, 2000, 400, seed=1, engine=engine)
    # Episodes that the end cuts off would make the mean too good.
    first = rolled.terminations.argmax(axis=0)
    returns = rolled.rewards.cumsum(axis=0)[first, np.arange(2000)]
    assert rolled.terminations.any(axis=0).all()
    assert returns.mean() == pytest.approx(solution.expected_return, rel=0.03)


@pytest.mark.parametrize("engine", ENGINES)
def test_policies_in_all_their_forms(engine: str) -> None:
    level = level_named("default")
    width, height = level.size
    given: dict[str, Any] = {"num_envs": 4, "num_steps": 25, "seed": 1, "engine": engine}
    east = np.full((height, width), brl.Action.EAST)
    table = np.zeros((width * height, 5))
    table[:, brl.Action.EAST] = 1
    for policy in (east, table, lambda seen: brl.Action.EAST):
        assert (brl.rollout(level, policy, **given).actions == brl.Action.EAST).all()
    weighed = np.tile([0.5, 0.0, 0.25, 0.25, 0.0], (width * height, 1))
    taken = brl.rollout(level, weighed, 500, 100, 1, engine=engine).actions
    shares = np.bincount(taken.ravel(), minlength=5) / taken.size
    assert shares == pytest.approx([0.5, 0.0, 0.25, 0.25, 0.0], abs=0.01)


@pytest.mark.parametrize("engine", ENGINES)
def test_each_of_several_levels_has_its_policy_and_its_limit(engine: str) -> None:
    wide = {"version": 1, "size": [4, 1], "max_steps": 5}
    high = {"version": 1, "size": [1, 3]}
    stay, south = np.zeros((1, 4), int), np.full((3, 1), brl.Action.SOUTH)
    given: dict[str, Any] = {"num_steps": 10, "seed": 1, "engine": engine}
    rolled = brl.rollout([wide, high], [stay, south], num_envs=4, **given)
    assert rolled.observations[:, 0].tolist() == rolled.observations[:, 2].tolist() == [0] * 10
    assert np.flatnonzero(rolled.truncations[:, 0]).tolist() == [4, 9]
    assert rolled.observations[:, 1].tolist() == [0, 1] * 5
    assert not rolled.truncations[:, 1].any()
    longer = brl.rollout([wide, high], [stay, south], 2, max_episode_steps=-1, **given)
    assert not longer.truncations.any()


def test_seeds() -> None:
    def rolled(seed: int | None) -> list[int]:
        actions = brl.rollout("default", num_envs=20, num_steps=20, seed=seed).actions
        return list(map(int, actions.flat))

    assert rolled(1) == rolled(1)
    assert rolled(1) != rolled(2)
    assert rolled(None) != rolled(None)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"num_envs": 0}, "num_envs must be a whole number, at least 1, not 0"),
        ({"num_steps": 2.5}, "num_steps must be a whole number, at least 1, not 2.5"),
        ({"max_episode_steps": 0}, "max_episode_steps must be at least 1, or -1"),
        ({"seed": [1, 2]}, "seed must be a whole number, at least 0, not \\[1, 2\\]"),
        ({"seed": -1}, "seed must be a whole number, at least 0"),
        ({"actions": "valid"}, "'all', 'moves' or 'turns'"),
        ({"engine": "gpu"}, "engine must be"),
        ({"policy": "clever"}, "there is no agent 'clever'"),
        ({"level": []}, "at least one level"),
        ({"level": ["default", "maze"], "policy": [[[0]]]}, "a list of 2 policies"),
    ],
)
def test_what_cannot_be(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        brl.rollout(**{"level": "default", **arguments})


def test_a_level_without_a_seed_for_its_maze_has_no_tables() -> None:
    with pytest.raises(brl.LevelError, match="seed"):
        brl.rollout("random-maze")


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
def test_a_policy_may_depend_on_the_step(engine: str) -> None:
    level = Level.from_fields({"version": 1, "size": [4, 1], "start": [0, 0], "exit": [3, 0]})
    ways = np.tile(np.array([2, 4, 2, 2, 0, 2])[:, None, None], (1, 1, 4))
    given: dict[str, Any] = {"num_steps": 15, "seed": 1, "engine": engine}
    rolled = brl.rollout(level, ways, 3, max_episode_steps=6, **given)
    assert rolled.actions[:, 0].tolist() == [2, 4, 2, 2, 0, 2] * 2 + [2, 4, 2]
    assert rolled.terminations[5].all()
    lake = brl.solve("frozen-lake", within=30)
    rolled = brl.rollout("frozen-lake", lake, 200, 300, seed=2, engine=engine)
    ends = int((rolled.terminations | rolled.truncations).sum())
    assert rolled.rewards.sum() / ends == pytest.approx(lake.expected_return, abs=0.03)
    with pytest.raises(ValueError, match="one for episodes of 6 steps; give max_episode_steps=6"):
        brl.rollout(level, ways, 3, **given)
