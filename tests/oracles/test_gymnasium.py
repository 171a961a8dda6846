"""Gymnasium's own tables as an oracle: its lakes and its cliff are levels of this language."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium
import pytest
from gymnasium.envs.toy_text.frozen_lake import generate_random_map
from support.each import for_each
from support.worlds import World, level_of

Outcome = tuple[float, int, float, bool]

LAKE_ACTIONS = {0: "west", 1: "south", 2: "east", 3: "north"}
CLIFF_ACTIONS = {0: "north", 1: "east", 2: "south", 3: "west"}
OURS = {"north": 0, "east": 1, "south": 2, "west": 3}


def merged(outcomes: Sequence[Outcome]) -> dict[tuple[int, float, bool], float]:
    """Return the probability of each distinct outcome; those that cannot happen are dropped."""
    result: dict[tuple[int, float, bool], float] = {}
    for probability, state, reward, terminal in outcomes:
        if probability > 0:
            key = (int(state), float(reward), bool(terminal))
            result[key] = result.get(key, 0.0) + float(probability)
    return result


def assert_equal_tables(world: World, env: Any, actions: Mapping[int, str], but: set[int]) -> None:
    """Compare every entry of the two tables, except those of the states in `but`."""
    ours = level_of(world).compile().to_toy_text(first_action=1)
    theirs = env.unwrapped.P
    assert ours.keys() == set(theirs)
    for state in ours.keys() - but:
        for action, name in actions.items():
            expected = merged(theirs[state][action])
            found = merged(ours[state][OURS[name]])
            assert found == pytest.approx(expected, abs=1e-12), (state, name)


def lake(rows: Sequence[str], skid: float, goal: float, hole: float, ice: float) -> World:
    """Return a map of Frozen Lake as a level: holes are areas that end the episode."""
    cells = {(x, y): char for y, row in enumerate(rows) for x, char in enumerate(row)}
    return {
        "version": 1,
        "size": [len(rows[0]), len(rows)],
        "start": next(list(cell) for cell, char in cells.items() if char == "S"),
        "exit": [list(cell) for cell, char in cells.items() if char == "G"],
        "areas": [
            {"at": list(cell), "ends": True, "reward": hole}
            for cell, char in cells.items()
            if char == "H"
        ],
        "skid": {"probability": skid, "to": "sides"},
        "rewards": {"step": ice, "exit": goal},
    }


@pytest.mark.parametrize("is_slippery", [True, False])
@for_each("size", range(2, 9))
@pytest.mark.parametrize(
    ("seed", "rate", "schedule"),
    [(1, 1 / 3, (1, 0, 0)), (2, 0.8, (10, -5, -0.1)), (3, 0.0, (2, -1, 0.5)), (4, 1.0, (1, 0, 0))],
)
def test_random_lakes(
    size: int, seed: int, rate: float, schedule: tuple[float, float, float], is_slippery: bool
) -> None:
    rows = generate_random_map(size=size, p=0.7, seed=seed)
    env = gymnasium.make(
        "FrozenLake-v1",
        desc=rows,
        is_slippery=is_slippery,
        success_rate=rate,
        reward_schedule=schedule,
    )
    world = lake(rows, 1 - rate if is_slippery else 0.0, *schedule)
    assert_equal_tables(world, env, LAKE_ACTIONS, but=set())


def test_the_lake_everybody_knows() -> None:
    env = gymnasium.make("FrozenLake-v1")
    rows = ["SFFF", "FHFH", "FFFH", "HFFG"]
    assert_equal_tables(lake(rows, 2 / 3, 1, 0, 0), env, LAKE_ACTIONS, but=set())


@pytest.mark.parametrize("is_slippery", [True, False])
def test_cliff_walking(is_slippery: bool) -> None:
    world: World = {
        "version": 1,
        "size": [12, 4],
        "start": [0, 3],
        "exit": [11, 3],
        "warps": [{"at": [x, 3], "to": "start", "reward": -100} for x in range(1, 11)],
        "rewards": {"exit": -1},
    }
    if is_slippery:
        world["skid"] = {"probability": 2 / 3, "to": "sides"}
    env = gymnasium.make("CliffWalking-v1", is_slippery=is_slippery)
    # Gymnasium's table goes on behind the goal, where no episode does. The cells of the cliff
    # are compared: nobody can stand there, but both tables say what would happen.
    assert_equal_tables(world, env, CLIFF_ACTIONS, but={47})
