"""What each robot of a team sees, by where all of them are."""

from __future__ import annotations

from random import Random
from typing import Any

import numpy as np
import pytest
from oracles.random_teams import random_team

import babyrobot_levels as brl
from babyrobot_levels.envs.observations.base import Extent
from babyrobot_levels.envs.observations.numbers import vector_names
from babyrobot_levels.envs.observations.planes import plane_names
from babyrobot_levels.envs.observations.views import view_planes

PASSING = "passing-place"
NAMES = ("position", "walls", "vector", "planes", "view")


def walked(level: brl.Level, seed: int) -> Any:
    """Yield observations of a random walk, with the cells of all robots and who has arrived."""
    env = brl.parallel_env(level, observation=NAMES, view_radius=2, see_through=True)
    rng = np.random.default_rng(seed)
    observations, _ = env.reset(seed=seed)
    mdp = level.compile()
    for _ in range(30):
        state = env._env.state
        now = level.configuration(mdp.configuration(state))
        yield observations, [mdp.cell(state), *now.robots], now.arrived
        if not env.agents:
            return
        observations, *_ = env.step({name: rng.integers(5) for name in env.agents})


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_each_robot_sees_the_others_where_they_are(seed: int) -> None:
    fields = random_team(Random(seed))
    if fields is None:
        return
    level = brl.load(fields)
    extent, stays = Extent.of([level]), level.team.arrived == "stay"
    width, height = level.size
    for observations, cells, arrived in walked(level, seed):
        for name, seen in observations.items():
            own = [robot.name for robot in level.robots].index(name)
            order = [own, *(other for other in range(len(cells)) if other != own)]
            x, y = cells[own]
            places = [axis for other in order for axis in cells[other]]
            homes = [int(arrived[other]) for other in order]
            count = len(places)
            assert seen["position"][:count].tolist() == places
            assert seen["position"][count:][: len(homes)].tolist() == homes
            sides = seen["walls"][count : count + 4].tolist()
            assert seen["walls"].tolist() == [
                *places, *sides, *seen["position"][count:].tolist()
            ]  # fmt: skip
            grid = level.grid_at(level.compile().configuration(0)) if not level.doors else None
            if grid is not None:
                assert sides == [grid.open_bits[y * width + x] >> side & 1 for side in range(4)]
            entries = dict(zip(vector_names(extent), seen["vector"].tolist(), strict=True))
            assert entries["x"] == pytest.approx(x / max(width - 1, 1))
            assert entries["arrived-2"] == homes[1]
            planes = dict(zip(plane_names(extent), seen["planes"], strict=True))
            view = dict(zip(view_planes(extent), np.moveaxis(seen["view"], -1, 0), strict=True))
            around = np.zeros((height, width))
            for place, other in enumerate(order):
                there = np.zeros((height, width))
                if place == 0 or stays or not arrived[other]:
                    there[cells[other][1], cells[other][0]] = 1
                around += there * (place > 0)
                assert (planes["robot" if place == 0 else f"robot-{place + 1}"] == there).all()
            padded = np.pad(around, 2)[y : y + 5, x : x + 5]
            assert (view["robot"] == np.minimum(padded, 1)).all()


def test_others_behind_walls_are_not_seen() -> None:
    level = brl.load({
        "version": 1, "size": [3, 1], "walls": [{"at": [0, 0], "side": "E"}], "exit": [1, 0],
        "robots": [{"name": "a", "start": [0, 0]}, {"name": "b", "start": [2, 0]}],
    })  # fmt: skip
    for see_through in (False, True):
        env = brl.parallel_env(level, observation="view", view_radius=2, see_through=see_through)
        observations, _ = env.reset(seed=0)
        for seen in observations.values():
            assert seen[..., -1].sum() == see_through


def test_the_reward_of_a_move_is_that_of_the_own_robot() -> None:
    env = brl.parallel_env(PASSING, observation="vector")
    names = vector_names(Extent.of([env.level]))
    observations, _ = env.reset(seed=0)
    step = 0.5 + 0.5 * -1 / 2
    for seen in observations.values():
        entries = dict(zip(names, seen.tolist(), strict=True))
        assert [entries[f"reward-{side}"] for side in ("east", "west")] == [step, step]


@pytest.mark.filterwarnings("ignore::UserWarning", "ignore::DeprecationWarning")
@pytest.mark.parametrize("observation", [*NAMES, "index", "image", ("planes", "vector")])
def test_pettingzoo_finds_no_fault_in_any_observation(observation: Any) -> None:
    # Its tests import environments in a way that it calls deprecated itself (1.27).
    from pettingzoo.test import parallel_api_test

    parallel_api_test(brl.parallel_env(PASSING, observation=observation), num_cycles=10)
