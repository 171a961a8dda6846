"""Certificates of MiniGrid's grids, by environments that move as MiniGrid does."""

from __future__ import annotations

from typing import Any

import pytest
from support.conversions import level_of_world
from support.minigrids import MiniGridEnv, recorded

from babyrobot_levels.analysis.compare import compare
from babyrobot_levels.analysis.environments import ComparisonError
from babyrobot_levels.extensions.formats.minigrid import world_of_environment
from babyrobot_levels.library.level import Level

GAP = "MiniGrid-LavaGapS5-v0"
DRAWING = """
+---+---+---+
| S   ~     |
+   +   +   +
|     ~     |
+   +   +   +
|         E |
+---+---+---+
"""


def level_of(name: str) -> Level:
    return level_of_world(world_of_environment(recorded(name), name, 3))


# Two cells of the gap's grid lie behind the goal.
@pytest.mark.parametrize(("name", "states"), [(GAP, 4 * 4), ("MiniGrid-FourRooms-v0", 1036)])
def test_a_grid_and_its_level_are_the_same_game(name: str, states: int) -> None:
    certificate = compare(level_of(name), recorded(name))
    assert (certificate.equal, certificate.difference) == (True, None)
    assert certificate.actions == (0, 1, 2)
    assert (certificate.states, certificate.outcomes) == (states, 3 * states)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"heading": "S"}, "episodes start looking S in this level, looking E in MiniGrid"),
        (
            {"map": DRAWING.replace("+   +", "+---+", 1)},
            "at [0, 0] looking S, forward:\n"
            "  this level: [0, 0] looking S\n"
            "  MiniGrid:   [0, 1] looking S",
        ),
        (
            {"legend": {"~": {"color": "red"}}},
            "at [0, 0] looking E, forward:\n"
            "  this level: [1, 0] looking E\n"
            "  MiniGrid:   ends in failure",
        ),
        (
            {"areas": [{"at": [1, 2], "ends": True}]},
            "at [0, 2] looking E, forward:\n"
            "  this level: ends in failure\n"
            "  MiniGrid:   [1, 2] looking E",
        ),
        (
            {"skid": 0.5},
            "at [0, 0] looking E, forward:\n"
            "  this level: ends in failure; [0, 1] looking E\n"
            "  MiniGrid:   ends in failure",
        ),
    ],
)
def test_the_first_difference_is_told(changes: dict[str, Any], told: str) -> None:
    certificate = compare(level_of(GAP).replace(**changes), recorded(GAP))
    assert (certificate.equal, certificate.everywhere) == (False, False)
    assert certificate.difference == told


def test_a_goal_that_is_none_is_a_difference() -> None:
    level = level_of(GAP)
    exit_ = level.exits[0]
    fields = level.to_dict() | {
        "map": DRAWING.replace("E", " "),
        "areas": [{"at": list(exit_), "ends": True}],
    }
    difference = compare(fields, recorded(GAP)).difference
    assert difference is not None
    assert "this level: ends in failure\n  MiniGrid:   ends in success" in difference


def test_several_starts_are_a_difference() -> None:
    level = level_of(GAP)
    fields = level.to_dict() | {"map": DRAWING.replace("~", "S", 1)}
    difference = compare(fields, recorded(GAP)).difference
    assert difference == "episodes start in 2 states in this level, in one in MiniGrid"


def test_other_actions_of_minigrid_must_change_nothing() -> None:
    class Jumping(MiniGridEnv):
        def step(self, action: int) -> Any:
            return super().step(2 if action == 5 else action)

    env = recorded(GAP)
    env.__class__ = Jumping
    difference = compare(level_of(GAP), env).difference
    assert difference == "at [0, 0] looking E, action 5 of MiniGrid: ends in failure"


def test_rewards_of_the_level_are_not_compared() -> None:
    level = level_of(GAP).replace(rewards={"step": -1, "exit": 7})
    assert compare(level, recorded(GAP)).equal


def test_grids_with_objects_are_refused() -> None:
    with pytest.raises(ComparisonError, match=r"the grid has objects \(key, door\)"):
        compare(level_of("MiniGrid-DoorKey-8x8-v0"), recorded("MiniGrid-DoorKey-8x8-v0"))
