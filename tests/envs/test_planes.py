"""Planes and vectors: what each shows in levels drawn by hand, and laws that hold in all levels."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from support.each import for_each
from support.fleets import levels
from support.playing import FEATURES, level_named

import babyrobot_levels as brl
from babyrobot_levels.envs.observations import make_batch_observer
from babyrobot_levels.envs.observations.base import Extent, Observation
from babyrobot_levels.envs.single import LevelEnv
from babyrobot_levels.envs.suite import SuiteEnv
from babyrobot_levels.envs.vector.env import LevelVectorEnv
from babyrobot_levels.language.cells import as_skid
from babyrobot_levels.library.level import Level

SIDES = {"north": (0, -1), "east": (1, 0), "south": (0, 1), "west": (-1, 0)}

GROUND: dict[str, Any] = {
    "version": 1,
    "size": [4, 3],
    "start": [[0, 0], [0, 2]],
    "exit": [3, 0],
    "blocked": [{"at": [2, 1]}],
    "walls": [{"at": [0, 0], "side": "E"}, {"at": [1, 1], "side": "W", "pass": 0.25}],
    "puddles": [{"at": [1, 0], "size": "small"}, {"at": [1, 2], "size": "large"}],
    "areas": [{"at": [3, 2], "ends": True, "reward": -9}, {"at": [0, 1], "skid": 0.5}],
    "warps": [{"at": [2, 2], "to": [2, 0], "reward": 3}],
    "rewards": {"exit": 1},
}

THINGS: dict[str, Any] = {
    "version": 1,
    "size": [3, 2],
    "exit": [2, 1],
    "exit_needs": ["gem", "lever"],
    "items": [{"name": "gem", "at": [1, 0], "reward": 4}],
    "switches": [{"name": "lever", "at": [1, 1]}],
    "doors": [{"at": [1, 0], "side": "E", "needs": "gem"}],
    "movers": [{"path": [[0, 1]]}],
    "rewards": {"exit": 9},
}


def drawn(plane: NDArray[Any]) -> list[str]:
    """Return a plane of zeros and ones as a drawing."""
    assert set(np.unique(plane)) <= {0, 1}
    return ["".join("#" if value else "." for value in row) for row in plane]


def parts(plane: NDArray[Any], most: float = 0) -> dict[tuple[int, int], float]:
    """Return the values of a plane by cell, those without one left out."""
    return {(int(x), int(y)): float(plane[y, x]) for y, x in np.argwhere(plane != most)}


def reset(level: Any, observation: str = "planes", **kwargs: Any) -> tuple[LevelEnv, Any]:
    env = LevelEnv(level, observation=observation, **kwargs)
    return env, env.reset(seed=0)[0]


def named(env: LevelEnv, planes: NDArray[Any]) -> dict[str, NDArray[Any]]:
    assert len(planes) == len(env.plane_names)
    return dict(zip(env.plane_names, planes, strict=True))


def squashed(reward: float) -> float:
    return 0.5 + 0.5 * reward / (1 + abs(reward))


def test_a_reward_that_is_drawn_has_its_mean() -> None:
    area = {"at": [1, 0], "reward": {"values": [-1, 5], "weights": [3, 1]}}
    env, planes = reset({"version": 1, "size": [3, 1], "areas": [area]})
    assert named(env, planes)["reward"][0, 1] == pytest.approx(squashed(0.5))


def test_planes_show_the_ground() -> None:
    env = LevelEnv(GROUND, observation="planes")
    shown = named(env, env.reset(seed=0, options={"start": [0, 2]})[0])
    drawings = {
        "robot": ["....", "....", "#..."],
        "start": ["#...", "....", "#..."],
        "exit": ["...#", "....", "...."],
        "blocked": ["....", "..#.", "...."],
        "wall-north": ["####", "..#.", "..#."],
        "wall-east": ["#..#", ".###", "...#"],
        "wall-south": ["..#.", "..#.", "####"],
        "wall-west": ["##..", "#.##", "#..."],
        "puddle-small": [".#..", "....", "...."],
        "puddle-large": ["....", "....", ".#.."],
        "ends": ["....", "....", "...#"],
        "warp": ["....", "....", "..#."],
    }
    for name, drawing in drawings.items():
        assert drawn(shown[name]) == drawing, name
    assert parts(shown["glass-west"]) == {(1, 1): 0.75}
    assert parts(shown["glass-east"]) == {(0, 1): 0.75}
    assert parts(shown["glass-north"]) == parts(shown["glass-south"]) == {}
    assert {*drawings, *(f"glass-{side}" for side in SIDES), "skid", "reward"} == {*shown}
    puddles = env.level.puddle_types
    small, large = (as_skid(each.skid).probability for each in (puddles.small, puddles.large))
    assert parts(shown["skid"]) == pytest.approx({(0, 1): 0.5, (1, 0): small, (1, 2): large})
    assert parts(shown["reward"], squashed(-1)) == pytest.approx(
        {
            (1, 0): squashed(puddles.small.reward),
            (1, 2): squashed(puddles.large.reward),
            (2, 1): 0.5,
            (3, 2): squashed(-9),
            (2, 2): squashed(3),
            (3, 0): squashed(1),
        }
    )


def test_planes_show_things_as_they_change() -> None:
    env, planes = reset(THINGS)
    shown = named(env, planes)
    assert drawn(shown["gem"]) == [".#.", "..."]
    assert drawn(shown["switch-off"]) == ["...", ".#."]
    assert drawn(shown["door-east"]) == [".#.", "..."]
    assert drawn(shown["door-west"]) == ["..#", "..."]
    assert drawn(shown["wall-east"]) == [".##", "..#"]
    assert drawn(shown["mover"]) == ["...", "#.."]
    assert drawn(shown["exit-locked"]) == ["...", "..#"]
    assert not shown["exit"].any()
    assert not shown["held-gem"].any()
    assert parts(shown["reward"], squashed(-1)) == pytest.approx({(1, 0): squashed(4)})
    env.step(brl.Action.EAST)  # takes the gem
    shown = named(env, env.step(brl.Action.SOUTH)[0])
    assert not shown["gem"].any()
    assert shown["held-gem"].all()
    assert not shown["door-east"].any()
    assert drawn(shown["wall-east"]) == ["..#", "..#"]
    assert drawn(shown["switch-on"]) == ["...", ".#."]
    assert not shown["switch-off"].any()
    assert drawn(shown["exit"]) == ["...", "..#"]
    assert not shown["exit-locked"].any()
    assert parts(shown["reward"], squashed(-1)) == pytest.approx({(2, 1): squashed(9)})


def test_planes_show_the_wind_and_where_the_robot_looks() -> None:
    level = {"version": 1, "size": [3, 1], "wind": {"north": [0, 1, 3], "west": [2]}}
    env, planes = reset(level, actions="turns")
    shown = named(env, planes)
    assert shown["wind-north"].tolist() == [[0, 0.5, 0.75]]
    assert shown["wind-west"] == pytest.approx(2 / 3)
    assert not shown["wind-south"].any()
    assert not shown["wind-east"].any()
    assert drawn(shown["robot-east"]) == drawn(shown["robot"]) == ["#.."]
    shown = named(env, env.step(brl.Turn.LEFT)[0])
    assert drawn(shown["robot-north"]) == drawn(shown["robot"]) == ["#.."]
    assert not shown["robot-east"].any()


def test_cells_beyond_a_smaller_level_are_blocked() -> None:
    small, large = (
        brl.load({"version": 1, "size": [2, 1]}),
        brl.load({"version": 1, "size": [3, 2]}),
    )
    envs = LevelVectorEnv(levels=[small, large], observation="planes")
    shown = dict(zip(envs.plane_names, envs.reset(seed=0)[0][0], strict=True))
    assert drawn(shown["blocked"]) == ["..#", "###"]
    assert drawn(shown["wall-west"]) == ["#.#", "###"]
    assert drawn(shown["exit"]) == [".#.", "..."]


@pytest.mark.parametrize("name", ["things of all kinds", "all at once"])
@pytest.mark.parametrize("actions", ["all", "turns"])
def test_forms_show_the_same(name: str, actions: str) -> None:
    level = level_named(name)
    env, planes = reset(level, actions=actions)
    _, last = reset(level, actions=actions, channels_last=True)
    _, whole = reset(level, actions=actions, planes_dtype="uint8")
    assert (planes.dtype, whole.dtype) == (np.float32, np.uint8)
    assert planes.shape == env.observation_space.shape
    assert last.flags.c_contiguous
    assert np.array_equal(np.moveaxis(last, -1, 0), planes)
    assert np.abs(whole - 255 * planes.astype(np.float64)).max() < 0.5001


# -- laws ------------------------------------------------------------------------------------


@for_each("name", [*FEATURES])
def test_walls_and_glass_are_what_is_missing_to_the_chance_to_pass(name: str) -> None:
    env, planes = reset(level_named(name))
    shown = named(env, planes)
    level = env.level
    first = level.compile().configuration(env._state)
    chance = level.grid_at(first).pass_probability
    for number, side in enumerate(SIDES):
        stopped = shown[f"wall-{side}"].astype(np.float64) + shown[f"glass-{side}"]
        assert stopped == pytest.approx(1 - chance[..., number])


# -- vectors ---------------------------------------------------------------------------------


def test_vectors_show_what_surrounds_the_robot() -> None:
    env = LevelEnv(GROUND, observation="vector")
    vector, _ = env.reset(seed=0, options={"start": [0, 2]})
    shown = dict(zip(env.vector_names, vector.tolist(), strict=True))
    puddle = env.level.puddle_types.large.reward
    assert shown == pytest.approx(
        {
            "x": 0,
            "y": 1,
            "open-north": 1,
            "open-east": 1,
            "open-south": 0,
            "open-west": 0,
            "reward-north": squashed(-1),
            "reward-east": squashed(puddle),
            "reward-south": squashed(-1),
            "reward-west": squashed(-1),
        }
    )


def test_vectors_end_with_things_and_the_heading() -> None:
    env, vector = reset(THINGS, "vector", actions="turns")
    assert env.vector_names[-7:] == (
        "thing-1", "thing-2", "thing-3",
        "heading-north", "heading-east", "heading-south", "heading-west",
    )  # fmt: skip
    assert vector[-7:].tolist() == [0, 0, 0, 0, 1, 0, 0]
    vector, *_ = env.step(brl.Turn.FORWARD)  # takes the gem
    assert vector[-7:].tolist() == [1, 0, 0, 0, 1, 0, 0]
    vector, *_ = env.step(brl.Turn.RIGHT)
    assert vector[-7:].tolist() == [1, 0, 0, 0, 0, 1, 0]


def test_vectors_tell_the_rewards_of_diagonal_moves() -> None:
    area = {"at": [1, 1], "reward": 3}
    env = LevelEnv(
        {"version": 1, "moves": 8, "size": [3, 2], "areas": [area], "exit": [2, 0]},
        observation="vector",
    )
    vector = dict(zip(env.vector_names, env.reset(seed=0)[0].tolist(), strict=True))
    assert vector["reward-south-east"] == pytest.approx(squashed(3))
    assert vector["reward-north-west"] == pytest.approx(squashed(-1))


def test_vectors_of_a_suite_with_diagonal_moves_are_those_of_its_levels() -> None:
    suite = SuiteEnv(
        {"version": 1, "kind": "suite", "levels": ["windy-gridworld-stochastic"]},
        observation="vector",
    )
    alone = LevelEnv("windy-gridworld-stochastic", observation="vector")
    assert suite.reset(seed=0)[0].tolist() == alone.reset(seed=0)[0].tolist()


@pytest.mark.slow
@given(level=levels(), seed=st.integers(0, 9))
def test_vectors_are_what_planes_and_tables_say_about_the_robot(level: Level, seed: int) -> None:
    env = LevelEnv(level, observation=("planes", "vector"), actions="moves")
    rng = np.random.default_rng(seed)
    env.reset(seed=seed)
    for _ in range(10):
        observed, _, terminated, *_ = env.step(rng.integers(4))
        assert observed in env.observation_space
        vector = dict(zip(env.vector_names, observed["vector"].tolist(), strict=True))
        shown = named(env, observed["planes"])
        ((y, x),) = np.argwhere(shown["robot"])
        for action, side in enumerate(SIDES):
            stopped = shown[f"wall-{side}"][y, x] + shown[f"glass-{side}"][y, x]
            assert vector[f"open-{side}"] == pytest.approx(1 - stopped, abs=1e-6)
            expected = sum(chance * pay for chance, _, pay, _ in env.P[env._state][action])
            assert vector[f"reward-{side}"] == pytest.approx(squashed(expected), abs=1e-6)
        if terminated:
            env.reset()


# -- memory ----------------------------------------------------------------------------------


def test_a_table_that_is_full_paints_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    level = level_named("things of all kinds")
    extent = Extent.of([level])
    count = level.compile().num_states
    offset = np.array([0, count])
    free, full = (make_batch_observer(Observation("planes"), extent, 1) for _ in range(2))
    for table in (free, full):
        table.grow(offset)
        table.write(0, level)
    rng = np.random.default_rng(1)
    for _ in range(40):
        states = rng.integers(0, count, 6)
        wanted = free.gather(states)
        with monkeypatch.context() as patch:
            patch.setattr("babyrobot_levels.envs.observations.planes.MAX_GROUND_BYTES", 100_000)
            found = full.gather(states)
        assert np.array_equal(wanted, found)
    painted = [table._grounds.nbytes for table in (free, full)]  # type: ignore[attr-defined]
    assert painted[1] < painted[0]
