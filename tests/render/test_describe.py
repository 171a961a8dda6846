"""Descriptions of pictures, and where they stand in files."""

from __future__ import annotations

import io

import pytest
from PIL import Image
from support.worlds import level

from babyrobot_levels.library.catalogue import load
from babyrobot_levels.render.raster import to_png
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.words.describe import MOST_CHARACTERS, describe


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        (
            "final-maze",
            "A grid of 8 columns and 5 rows. The robot is at [0, 0], with walls to the north, "
            "south and west. The exit is 5 columns east and 4 rows south. "
            "On the grid: 3 small puddles and 2 large puddles.",
        ),
        (
            "treasure-chests",
            "A grid of 7 columns and 5 rows. The robot is at [0, 4], with walls to the south and "
            "west. There is no exit. The episode ends in the gold at [6, 0], the silver at [2, 2] "
            "and the pit at [5, 2].",
        ),
        (
            "shell-game",
            "A grid of 7 columns and 4 rows. The robot is at [3, 3], with a wall to the south. "
            "The exit is in one of 3 cells, the nearest 3 rows north. "
            "On the grid: 2 closed doors and 1 switch.",
        ),
    ],
)
def test_levels_of_the_gallery(name: str, expected: str) -> None:
    assert describe(load(name)) == expected


def test_a_state_tells_what_is_held_open_and_where_the_robot_is() -> None:
    world = load("first-key")
    width, height = world.size
    held = next(
        number
        for number in range(world.compile().num_configurations)
        if world.configuration(number).held
    )
    # Beside the door, which the key has opened.
    assert describe(world, held * width * height + width + 2) == (
        "A grid of 5 columns and 3 rows. The robot is at [2, 1], with a wall to the west. "
        "It holds the key. The exit is 2 columns east. On the grid: 1 open door."
    )
    assert "That is the exit." in describe(world, held * width * height + width + 4)


def test_glass_and_blocked_cells_close_sides() -> None:
    walls = [{"at": [1, 1], "side": "E", "pass": 0.5}, {"at": [1, 1], "side": "N"}]
    world = level(start=[1, 1], walls=walls, blocked=[{"at": [1, 2]}])
    text = "with walls to the north and south and a glass wall to the east"
    assert text in describe(world)


def test_without_the_robot_the_start_is_told() -> None:
    assert "The start is at [0, 0]" in describe(level(), robot=False)
    assert "A start is at [0, 0]" in describe(level(start=[[0, 0], [1, 0]]), robot=False)
    scene = build_scene(level(display={"robot": {"show": False}}))
    assert "robot" not in scene.description


def test_descriptions_are_short_and_printable_whatever_the_level_says() -> None:
    areas = [{"at": [x, 0], "label": f"\x1b[31m{x}" + "x" * 5000} for x in range(1, 30)]
    text = describe(level(size=[31, 1], areas=areas))
    assert len(text) <= MOST_CHARACTERS
    assert text.isprintable()


def test_png_files_have_title_and_description() -> None:
    world = level(title="Глава\x1b 1")
    with Image.open(io.BytesIO(to_png(build_scene(world)))) as image:
        assert isinstance(image.info, dict)
        assert image.info["Title"] == "Глава\\x1b 1"
        assert image.info["Description"] == describe(world)
    assert to_png(build_scene(world)) == to_png(build_scene(world))
