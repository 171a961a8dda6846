"""Several robots with too many joint states for tables: they step without any."""

from __future__ import annotations

import math
import pickle
import time
from random import Random
from typing import Any

import numpy as np
import pytest
from oracles.random_teams import random_team

import babyrobot_levels as brl
from babyrobot_levels.mdp.compiler.joint import exceed
from babyrobot_levels.mdp.compiler.things import stepper

FIELDS = {
    "version": 1,
    "size": [30, 30],
    "exit": [15, 15],
    "robots": [{"name": "red", "start": [0, 0]}, {"name": "blue", "start": [29, 0]}],
    "max_steps": 60,
}
ROOM = brl.load(FIELDS)
THREE = brl.load(
    {
        **FIELDS,
        "size": [15, 15],
        "exit": [7, 7],
        "robots": [{"name": name, "start": [0, at]} for at, name in enumerate("abc")],
    }
)
SLIPPERY = {
    "version": 1,
    "size": [4, 3],
    "robots": [{"name": "a", "start": [0, 0]}, {"name": "b", "start": [0, 2]}],
    "items": [{"name": "coin", "one_of": [[1, 1], [2, 1]], "reward": 3}],
    "movers": [{"within": {"at": [1, 0], "size": [2, 1]}}],
    "hit": {"ends": False},
    "skid": 0.3,
}


def untabled(given: Any) -> brl.Level:
    """Return a level that is stepped without tables, although there is room for them."""
    level = brl.load(given).model_copy()
    vars(level)["_numbering"] = stepper(level, level.grid())
    return level


def told(info: dict[str, Any]) -> list[Any]:
    return [(name, np.array(value).tolist()) for name, value in sorted(info.items())]


def assert_same_episodes(given: Any, episodes: int = 2, steps: int = 15) -> None:
    one, other = brl.TeamEnv(given), brl.TeamEnv(untabled(given))
    rng = np.random.default_rng(0)
    assert one.observation_space == other.observation_space
    for seed in range(episodes):
        (row, info), (row_2, info_2) = one.reset(seed=seed), other.reset(seed=seed)
        assert row.tolist() == row_2.tolist()
        assert told(info) == told(info_2)
        for _ in range(steps):
            action = [int(rng.choice(np.flatnonzero(mask))) for mask in one.robot_masks()]
            if rng.random() < 0.2:
                action = rng.integers(5, size=len(action)).tolist()
            *here, info = one.step(action)
            *there, info_2 = other.step(action)
            assert [np.array(each).tolist() for each in here[:3]] == [
                np.array(each).tolist() for each in there[:3]
            ]
            if here[2]:
                assert info["rewards"].tolist() == info_2["rewards"].tolist()
                break
            assert told(info) == told(info_2)


@pytest.mark.parametrize("given", ["passing-place", "two-pads", SLIPPERY])
def test_episodes_are_those_of_tables(given: Any) -> None:
    assert_same_episodes(given)


@pytest.mark.parametrize(
    "first", [0, *(pytest.param(first, marks=pytest.mark.sweep) for first in range(4, 400, 4))]
)
def test_episodes_of_random_teams_are_those_of_tables(first: int) -> None:
    for seed in range(first, first + 4):
        fields = random_team(Random(seed))
        # Tables number wanderers beside paths in another order, and so draw other outcomes.
        if fields is None or len(fields.get("movers", [])) > 1:
            continue
        level = brl.load(fields)
        if level.has_random_maze or level.numbering() is not level.compile():
            continue
        assert_same_episodes(level, 1, 12)


@pytest.mark.parametrize(
    "given",
    [
        "passing-place",
        *(pytest.param(each, marks=pytest.mark.slow) for each in ("two-pads", SLIPPERY)),
    ],
)
def test_what_is_surely_too_large_is_so(given: Any) -> None:
    level = brl.load(given)
    size, robots = level.compile().probability.size, stepper(level, level.grid())
    assert not exceed(robots, size)
    assert exceed(robots, size // 20)


@pytest.mark.slow
@pytest.mark.parametrize("level", [ROOM, THREE], ids=["two", "three"])
def test_too_many_joint_states_are_refused_soon_and_played(level: brl.Level) -> None:
    begin = time.process_time()
    with pytest.raises(brl.UnplayableError, match=r"more than 25,000,000 .*`brl\.team_returns`"):
        level.compile()
    assert time.process_time() - begin < 5
    env = level.make().unwrapped
    assert isinstance(env, brl.TeamEnv)
    row, _ = env.reset(seed=1)
    starts = [x for _, cell in level.team_starts for x in cell]
    assert row.tolist() == [*starts, *[0] * len(level.robots)]
    _, reward, _, _, info = env.step([3] * len(level.robots))
    assert (reward, info["rewards"].tolist()) == (-len(level.robots), [-1] * len(level.robots))
    again = pickle.loads(pickle.dumps(env))
    action = [2] * len(level.robots)
    assert again.step(action)[0].tolist() == env.step(action)[0].tolist()
    for ask in (lambda: env.P, lambda: env.initial_state_distrib, lambda: env.level_digest):
        with pytest.raises(brl.UnplayableError):
            ask()


@pytest.mark.slow
def test_all_observations_but_vectors_need_no_tables() -> None:
    env = brl.TeamEnv(ROOM, observation=("position", "walls", "index", "planes", "view", "image"))
    row, _ = env.reset(seed=0)
    assert env.observation_space.contains(row)
    with pytest.raises(brl.UnplayableError):
        brl.TeamEnv(ROOM, observation="vector")
    with pytest.raises(brl.UnplayableError):
        brl.TeamVectorEnv(ROOM)


def test_pictures_show_where_all_are() -> None:
    env = brl.TeamEnv(THREE, render_mode="ansi")
    env.reset(seed=0)
    env.step([2, 2, 2])
    lines = env.render().splitlines()
    assert [line[6] for line in lines[1:6:2]] == ["☻", "B", "C"]
    assert "<svg" in ROOM.to_svg()


def to_the_exit(row: Any) -> int:
    x, y = row[0], row[1]
    return 2 if x < 15 else 4 if x > 15 else 3 if y < 15 else 0


def test_episodes_tell_what_robots_get() -> None:
    found = brl.team_returns(ROOM, [to_the_exit, to_the_exit], episodes=2)
    assert (found.expected_return, found.error, found.success, found.steps) == (-57, 0, 1, 30)
    assert found.robots == {"red": -29, "blue": -28}
    both = brl.team_returns(
        ROOM, lambda row: [to_the_exit(row), to_the_exit(row[2:])], episodes=1, discount=0.5
    )
    assert both.expected_return == pytest.approx(-4, abs=1e-6)
    assert math.isnan(both.error)


@pytest.mark.slow
def test_mean_returns_are_near_the_exact_ones() -> None:
    exact = brl.score_team("passing-place", "random", discount=0.9)
    for agents in ("random", ["random", "random"]):
        how: Any = {"episodes": 40, "seed": 3, "within": 60, "discount": 0.9}
        found = brl.team_returns("passing-place", agents, **how)
        assert abs(found.expected_return - exact.expected_return) < 4 * found.error + 0.05
        assert found == brl.team_returns("passing-place", agents, **how)


def test_wrong_agents_are_named() -> None:
    with pytest.raises(ValueError, match="3 agents for 2 robots: red, blue"):
        brl.team_returns(ROOM, ["random"] * 3)
    for agents in ("best", ["random", "best"]):
        with pytest.raises(ValueError, match="not 'best'"):
            brl.team_returns(ROOM, agents)


def test_words_are_told_without_grades() -> None:
    team = brl.TextTeam(ROOM, sight="view", reward="success")
    assert "blue is at" not in team.reset(seed=1)["red"]
    texts = team.step({"red": "east", "blue": "west"})
    assert texts["red"].startswith("Red moves east. Step 1 of 60: reward -2, together -2.")
    assert (team.return_, team.reward) == (-2, 0)
    grades = team.optimum, team.regret, team.luck, team.moves[0].advantage, team.largest_regret
    assert all(map(math.isnan, grades))
    with pytest.raises(ValueError, match="'world' or 'success'"):
        brl.TextTeam(ROOM, reward="advantage")


@pytest.mark.slow
def test_films_of_random_moves_are_those_with_tables() -> None:
    level = brl.load({**SLIPPERY, "max_steps": 8})
    film = level.to_gif(policy="random", seed=1, scale=0.1)
    assert untabled(level).to_gif(policy="random", seed=1, scale=0.1) == film
    with pytest.raises(brl.UnplayableError, match="25,000,000 outcomes"):
        ROOM.to_gif()


def test_a_grid_of_too_many_cells_is_refused() -> None:
    level = brl.load({**FIELDS, "size": [128, 128]})
    with pytest.raises(brl.UnplayableError, match="16,383 cells at most, and the level has 16,384"):
        brl.TeamEnv(level)


def test_an_agent_each() -> None:
    pytest.importorskip("pettingzoo")
    env = brl.parallel_env(ROOM, observation="view")
    env.reset(seed=1)
    _, rewards, *_ = env.step({"red": 2, "blue": 4})
    assert rewards == {"red": -1, "blue": -1}
