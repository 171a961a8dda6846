"""Plans for the robots of a level, by its own rules."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import babyrobot_levels as brl
from babyrobot_levels.text.budget import Limits, OverBudgetError, within

CROSSING: dict[str, Any] = {
    "version": 1,
    "size": [3, 2],
    "robots": [
        {"name": "red", "start": [0, 0], "exit": [2, 0]},
        {"name": "blue", "start": [2, 0], "exit": [0, 0]},
    ],
    "walls": [{"at": [0, 0], "side": "S"}],
    "max_steps": 20,
}


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        ("rr\nwl", "agents 1 and 2 change places at time 2, the first of them to [2, 0]"),
        ("dd\nww", "agent 1 is kept from [0, 1] at time 1, by a wall, a door or another robot"),
        ("r\nl", "agents 1 and 2 are both at [1, 0] at time 1"),
        ("w\nw", "agent 1 ends at [0, 0], which is not its goal"),
    ],
)
def test_faults_are_those_of_the_level(rows: str, told: str, tmp_path: Path) -> None:
    plan = tmp_path / "plan.txt"
    plan.write_text(rows, encoding="utf-8")
    found = brl.check_plan(plan, CROSSING)
    assert not found.is_valid
    assert str(found.fault) == told


def test_a_plan_that_makes_way_is_valid(tmp_path: Path) -> None:
    plan, file = tmp_path / "plan.txt", tmp_path / "team.yaml"
    plan.write_text("rr\ndwull", encoding="utf-8")
    brl.load(CROSSING).save(file)
    for given in [(plan, file), (file, plan)]:
        assert brl.check_plan(*given) == brl.PlanCheck(2, None, 7, 5, None, None)


@pytest.mark.slow
def test_the_optimum_of_the_gallery_is_a_valid_plan() -> None:
    for name in ("two-pads", "passing-place"):
        level, env = brl.load(name), brl.TeamEnv(name, observation="index")
        policy = brl.solve(level).policy.ravel()
        env.reset(seed=0)
        mdp, over, paths = level.compile(), False, []
        while True:
            number = mdp.configuration(env.state)
            paths.append([mdp.cell(env.state), *level.configuration(number).robots])
            if over:
                break
            over = env.step(env.numbered_action(int(policy[env.state])))[2]
        found = brl.check_plan([*zip(*paths, strict=True)], level)
        assert found.is_valid
        assert found.makespan == len(paths) - 1
        assert not brl.check_plan([*zip(*paths[:-1], strict=True)], level).is_valid


def test_a_level_may_be_given_by_its_name_or_code(tmp_path: Path) -> None:
    plan = tmp_path / "plan.txt"
    plan.write_text("w\nw", encoding="utf-8")
    code = brl.load("passing-place").share_code()
    for given in ("passing-place", Path("passing-place"), code):
        assert brl.check_plan(plan, given).fault is not None
    with pytest.raises(brl.LevelNotFoundError, match="no level called 'passing-plase'"):
        brl.check_plan(plan, "passing-plase")
    with pytest.raises(brl.LevelError, match="no such file"):
        brl.check_plan(plan, tmp_path / "none.scen")


def test_chance_and_single_robots_are_refused() -> None:
    paths = [[(0, 0), (1, 0)], [(2, 0), (2, 0)]]
    with pytest.raises(brl.LevelError, match="nothing happens by chance: that of step 1"):
        brl.check_plan(paths, {**CROSSING, "skid": 0.5})
    with pytest.raises(brl.LevelError, match="several robots"):
        brl.check_plan(paths, brl.load("final-maze"))
    with pytest.raises(ValueError, match="not for 2"):
        brl.check_plan(paths[:1], CROSSING)


def test_long_plans_are_followed_within_limits(tmp_path: Path) -> None:
    team = [{"name": name, "start": [x, 0], "exit": [2, 0]} for x, name in enumerate("ab")]
    level = {"version": 1, "size": [3, 2], "robots": team}
    waiting, moving = tmp_path / "waiting.txt", tmp_path / "moving.txt"
    waiting.write_text("300w\n300w\n")
    moving.write_text(f"{'du' * 150}\n{'du' * 150}\n")
    with within(Limits(10_000_000, 10_000, help="use less")):
        told = brl.check_plan(waiting, level)
        assert told.fault is not None
        assert told.fault.time == 300
        # Where robots have been before, nothing is worked out again.
        assert not brl.check_plan(moving, level).is_valid
        long = tmp_path / "long.txt"
        long.write_text("1100w\n1100w\n")
        with pytest.raises(OverBudgetError, match="to follow a plan of 1,100 steps is too much"):
            brl.check_plan(long, level)
