"""Several robots as worlds of text: each reads its own, and steps are graded for the team."""

from __future__ import annotations

import random

import pytest

import babyrobot_levels as brl
from babyrobot_levels.extensions.scoring.text_world import MOVES

PADS = "two-pads"


def words(team: brl.TextTeam, joint: int) -> dict[str, str]:
    """Return a joint action as the moves of robots."""
    actions = team.level.compile().robot_actions(joint).tolist()
    names = [brl.Action(action).name.lower().replace("stay", "wait") for action in actions]
    return dict(zip(team.names, names, strict=True))


@pytest.mark.slow
@pytest.mark.parametrize("name", [PADS, "passing-place"])
def test_grades_add_up_to_what_an_episode_misses_of_the_optimum(name: str) -> None:
    team, rng = brl.TextTeam(name, sight="words", within=20), random.Random(1)
    for seed in range(5):
        team.reset(seed=seed)
        while not team.done:
            team.step({robot: rng.choice([*MOVES]) for robot in team.names})
        assert team.return_ - team.optimum == pytest.approx(team.luck - team.regret)
        assert brl.replay(team.play)[0].is_valid


@pytest.mark.slow
def test_the_optimal_policy_has_no_regret_and_succeeds() -> None:
    team = brl.TextTeam(PADS, reward="success")
    policies = brl.solve(PADS, within=team.within).policies
    assert policies is not None
    team.reset(seed=0)
    while not team.done:
        texts = team.step(words(team, int(policies[len(team.moves)].ravel()[team.state])))
    assert (team.regret, team.return_, team.reward, team.is_success) == (0, -10, 1, True)
    assert texts["red"].endswith("it ended as they have arrived, after 7 steps, with -10 in all.")


def test_each_robot_reads_what_it_sees() -> None:
    team = brl.TextTeam(PADS, sight="view")
    texts = team.reset(seed=0)
    assert texts["red"].startswith("You are the robot red, with blue, on a grid")
    assert texts["blue"].startswith("You are the robot blue, with red, on a grid")
    texts = team.step({"red": "east", "blue": "East"})
    told = "moves east. The pad is covered. The door east of [1, 0] opens. Step 1 of 100"
    assert texts["red"].startswith(f"Red {told}")
    assert texts["blue"].startswith(f"Blue {told}")
    assert "| S   @ :     E |" in texts["red"]
    assert "| S   R :     ?" in texts["blue"]
    assert "blue is at [1, 1]" in texts["red"]
    assert "red is at [1, 0]" in texts["blue"]
    team.step({"red": "east"})
    # Behind the wall, it is not seen.
    texts = team.step({"red": "south"})
    assert "red is at" not in texts["blue"]
    assert "R" not in texts["blue"].split("columns 0 to 3")[1]


def test_each_robot_is_told_of_its_own_exit() -> None:
    texts = brl.TextTeam("passing-place").reset(seed=0)
    assert "The exit is 4 columns east." in texts["red"]
    assert "The exit is 4 columns west." in texts["blue"]


def test_what_is_no_move_is_told_and_counted() -> None:
    team = brl.TextTeam(PADS, within=1)
    assert team.look()["red"] == "There is no episode: reset the world to begin one."
    team.reset(seed=0)
    texts = team.step({"red": "fly"})
    assert texts["red"].startswith("That is no move: north, east, south, west or wait. Red waits.")
    assert texts["blue"].startswith("Red waits. Blue waits.")
    assert team.step({}) == team.look()
    assert team.invalid == 2
    with pytest.raises(ValueError, match=r"use `brl\.TextWorld`"):
        brl.TextTeam("final-maze")
    with pytest.raises(brl.LevelError, match=r"brl\.TextTeam"):
        brl.TextWorld(PADS)
