"""Levels as text: everything is told that one needs to play, in each of the three sights."""

from __future__ import annotations

import pytest
from support.worlds import level

import babyrobot_levels as brl
from babyrobot_levels.render.sights import SIGHTS, Narrator

EVERYTHING = """
+---+---+---+---+---+
| S | k : o |###| p |
+   +   +---+---+   +
|       /     O   H |
+   +   +   +   +   +
| c   c   m   l / E |
+---+---+---+---+---+
"""


@pytest.fixture
def house() -> brl.Level:
    found: brl.Level = level(
        map=EVERYTHING,
        legend={
            "k": {"item": "key"},
            "c": {"item": "coin", "reward": 5},
            "l": {"switch": "lever"},
            "m": {"color": "saddlebrown", "reward": -3, "label": "mud"},
            "H": {"ends": True},
            "p": {"reward": -7},
        },
        doors=[
            {"at": [1, 1], "side": "E", "needs": "key"},
            {"at": [3, 2], "side": "E", "needs": "lever"},
        ],
        movers=[
            {"path": [[2, 1], [3, 1]]},
            {"name": "old-bat", "within": {"at": [0, 2], "size": [2, 1]}},
        ],
        warps=[{"at": [0, 1], "to": [4, 0]}],
        hit={"reward": -9},
        wind={"east": [0, 0, 1]},
        discount=0.5,
        max_steps=50,
    )
    return found


def scene(given: brl.Level, sight: str, cell: tuple[int, int]) -> list[str]:
    """Return the lines of the scene in the first configuration, from a cell."""
    x, y = cell
    seen = frozenset((i, j) for i in range(x - 1, x + 2) for j in range(y - 1, y + 2))
    return Narrator(given, sight, lambda _: seen).scene(y * given.width + x).splitlines()


def test_rules_say_what_pictures_show(house: brl.Level) -> None:
    rules = Narrator(house, "map", lambda _: frozenset()).rules().splitlines()
    for line in (
        "A robot on a grid of 5 columns and 3 rows. Cells are [x, y]: x is the column, counted "
        "from 0 in the west, and y the row, counted from 0 in the north.",
        "Goal: Move the robot to the exit. What counts is the sum of all rewards, each 0.5 times "
        "what it would be one step earlier.",
        "- key: opens the door east of [1, 1]",
        "- lever: while on: opens the door east of [3, 2]",
        "- mud: costs 3 (at [2, 2])",
        "- hole: ends the episode, costs 1 (at [4, 1])",
        "- warp: leads to [4, 0] (at [0, 1])",
        "- guard: walks its path, meeting it costs 9, ends the episode",
        "- the guard walks [2, 1], [3, 1], and again from the first cell",
        "- a step has one reward, the first that applies: that of meeting a mover, else that of "
        "the exit, else that of an item, else that of the cell in which it ends",
        "- H  a hole",
        "- m  a mud",
        "- / -/-  a closed door",
    ):
        assert line in rules, line


def test_words_tell_what_is_beside_the_robot(house: brl.Level) -> None:
    lines = scene(house, "words", (1, 1))
    assert lines[:6] == [
        "The robot is at [1, 1].",
        "here: nothing",
        "north: the key",
        "east: a closed door",
        "south: a free cell",
        "west: a warp",
    ]
    assert "the guard is at [2, 1], next at [3, 1]" in lines
    assert lines[-3:] == [
        "The exit is 3 columns east and 1 row south.",
        "held: nothing",
        "on: nothing",
    ]


def test_a_map_tells_things_apart_that_have_one_sign() -> None:
    keys = level(
        size=[5, 1],
        items=[{"name": "red-key", "at": [1, 0]}, {"name": "gold-key", "at": [2, 0]}],
        switches=[{"name": "lever", "at": [3, 0]}],
        max_steps=9,
    )
    lines = scene(keys, "map", (0, 0))
    told = "there: the red key at [1, 0]; the gold key at [2, 0]; the lever (off) at [3, 0]"
    assert told in lines


def test_a_map_tells_what_things_and_movers_hide() -> None:
    wet = level(
        size=[4, 1],
        puddles=[{"at": [1, 0]}, {"at": [2, 0], "size": "large"}],
        items=[{"name": "key", "at": [1, 0]}],
        movers=[{"name": "guard", "path": [[2, 0], [3, 0]]}],
        max_steps=9,
    )
    told = "there: the key at [1, 0]; a small puddle at [1, 0]; a large puddle at [2, 0]"
    assert told in scene(wet, "map", (0, 0))


def test_a_view_hides_what_is_not_seen(house: brl.Level) -> None:
    lines = scene(house, "view", (1, 1))
    assert "?" in "".join(lines)
    assert not any("[4, 1]" in line for line in lines)


@pytest.mark.parametrize("sight", SIGHTS)
def test_what_the_robot_stands_on_is_told(sight: str) -> None:
    wet = level(size=[3, 1], puddles=[{"at": [1, 0]}], max_steps=9)
    assert "here: a small puddle" in scene(wet, sight, (1, 0))


def test_glass_of_several_strengths_is_told_wall_by_wall() -> None:
    glass = level(
        size=[3, 1],
        walls=[{"at": [0, 0], "side": "E", "pass": 0.5}, {"at": [1, 0], "side": "E", "pass": 0.25}],
    )
    rules = Narrator(glass, "words", lambda _: frozenset()).rules()
    assert "- glass wall east of [0, 0]: lets through 5 times in 10" in rules
    assert "- glass wall east of [1, 0]: lets through 1 time in 4" in rules
    assert "east: a glass wall, and behind it a free cell" in scene(glass, "words", (0, 0))


def test_cells_without_a_name_are_told_by_what_they_do() -> None:
    plain = level(size=[3, 1], areas=[{"at": [1, 0], "reward": -4}], max_steps=9)
    assert "east: a cell (costs 4)" in scene(plain, "words", (0, 0))


def test_where_many_cells_are_is_told_row_by_row() -> None:
    wide = level(size=[5, 2], areas=[{"at": [0, 0], "size": [5, 2], "reward": -4, "label": "mud"}])
    rules = Narrator(wide, "map", lambda _: frozenset()).rules()
    assert "- mud: costs 4 (row 0: columns 0 to 4; row 1: columns 0 to 3)" in rules
