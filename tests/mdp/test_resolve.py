"""Mazes written out as walls: the same game, the same picture."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn
from support.worlds import LEGEND, World, drawings, level_of, worlds

import babyrobot_levels as brl
from babyrobot_levels.language.drawing import compose
from babyrobot_levels.library.level import Level, loads
from babyrobot_levels.text.errors import LevelError

TEXT = """\
# A maze of ours.
version: 1
size: [4, 3]  # not large
maze: {seed: 7}
openings:
  - {at: [0, 0], side: E}
# The rest.
puddles:
  - {at: [1, 1]}  # wet
"""

RESOLVED = """\
# A maze of ours.
version: 1
size: [4, 3]  # not large
walls:
  - {at: [1, 0], side: S}
  - {at: [3, 0], side: S}
  - {at: [0, 1], side: S}
  - {at: [2, 1], side: S}
  - {at: [1, 1], side: E}
# The rest.
puddles:
  - {at: [1, 1]}  # wet
"""


@st.composite
def mazes(draw: DrawFn) -> World:
    """Random levels with a maze, with walls of their own looks."""
    world = draw(worlds(6))
    world["maze"] = {"seed": draw(st.integers(0, 99)), "loops": draw(st.sampled_from([0, 0.5]))}
    for wall in world.get("walls", []):
        if draw(st.booleans()):
            wall |= draw(
                st.sampled_from([{"color": "red"}, {"width": 7}, {"fit": True}, {"width": 0}])
            )
    return world


def assert_same(resolved: Level, level: Level) -> None:
    assert resolved.maze is None
    assert resolved.openings == ()
    assert resolved.digest == level.digest
    assert resolved.grid().wall_bits == level.grid().wall_bits
    assert resolved.to_svg() == level.to_svg()
    assert resolved.draw() == level.draw()
    assert resolved.name == level.name


def sides(walls: list[dict[str, Any]]) -> int:
    return sum(wall.get("length", 1) for wall in walls)


@pytest.mark.slow
@given(mazes())
def test_the_game_and_the_picture_stay_the_same(world: World) -> None:
    level = level_of(world)
    resolved = level.resolve()
    assert_same(resolved, level)
    assert loads(resolved.to_yaml()).digest == level.digest
    assert resolved.resolve() is resolved


@pytest.mark.slow
@given(drawings(5), st.integers(0, 9))
def test_a_drawing_shows_the_maze(drawing: Any, seed: int) -> None:
    level = level_of(
        {"version": 1, "map": compose(drawing), "legend": LEGEND, "maze": {"seed": seed}}
    )
    resolved = level.resolve()
    assert_same(resolved, level)
    assert resolved.to_dict()["map"] == level.draw()
    assert "walls" not in resolved.to_dict()


def test_beside_a_drawing_stands_only_what_it_cannot_show() -> None:
    text = "+---+---+\n| S : E |\n+   +   +\n|       |\n+---+---+\n"
    walls = [
        {"at": [0, 0], "side": "E", "pass": 0.25},
        {"at": [0, 0], "side": "N", "color": "red", "length": 2},
    ]
    level = level_of({"version": 1, "map": text, "walls": walls, "maze": {"seed": 1}})
    resolved = level.resolve()
    assert_same(resolved, level)
    assert resolved.to_dict()["walls"] == [
        {"at": [0, 0], "side": "N", "length": 2, "color": "red"},
        {"at": [0, 0], "side": "E", "pass": 0.25},
    ]


def test_only_levels_with_a_maze_change() -> None:
    for name in ("final-maze", "braided-maze"):
        assert_same(brl.load(name).resolve(), brl.load(name))
    plain = brl.load("first-key")
    assert plain.resolve() is plain


@given(st.integers(0, 999))
def test_walls_are_as_long_as_they_can_be_and_none_is_told_twice(seed: int) -> None:
    level = level_of({"version": 1, "size": [7, 6], "maze": {"seed": seed}})
    walls = level.resolve().to_dict()["walls"]
    # A tree of 42 cells opens 41 of the 71 sides between them.
    assert sides(walls) == 71 - 41
    ends = {
        (
            wall["side"],
            wall["at"][0] + (length if wall["side"] == "S" else 0),
            wall["at"][1] + (length if wall["side"] == "E" else 0),
        )
        for wall in walls
        for length in [wall.get("length", 1)]
    }
    assert not ends & {(wall["side"], *wall["at"]) for wall in walls}


def test_openings_are_merged_away_and_comments_stay() -> None:
    text = loads(TEXT).resolve().to_yaml(comments=True)
    assert text == RESOLVED


def test_a_random_maze_needs_a_seed() -> None:
    level = brl.load("random-maze")
    with pytest.raises(LevelError, match="with_maze_seed"):
        level.resolve()
    assert_same(level.with_maze_seed(5).resolve(), level.with_maze_seed(5))
