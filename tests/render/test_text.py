"""Levels as text: joints, symbols, the robot, and colours for terminals."""

from __future__ import annotations

import re
import unicodedata
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from babyrobot_levels.library.level import Level
from babyrobot_levels.render.text import unicode_drawing

ESCAPE = re.compile(r"\x1b\[[\d;]*m")


def level(**fields: Any) -> Any:
    return Level.from_fields({"version": 1, **fields})


def picture(world: Any, **options: Any) -> str:
    return unicode_drawing(world, world.grid(), **options)


EXPECTED = {
    "every joint": (
        """\
+---+---+---+
| S |       |
+   +---+   +
|   |   |   |
+---+---+---+
|       |   |
+   +   +   +
|       | E |
+---+---+---+
""",
        """\
┌───┬───────┐
│ S │       │
│   ├───┐   │
│   │   │   │
├───┴───┼───┤
│       │   │
│   ·   │   │
│       │ E │
└───────┴───┘
""",
    ),
    "loose ends": (
        """\
+---+---+---+---+
| S             |
+   +---+   +   +
|           |   |
+   +   +   +   +
|   |           |
+   +   +---+   +
|             E |
+---+---+---+---+
""",
        """\
┌───────────────┐
│ S             │
│   ╶───╴   ╷   │
│           │   │
│   ╷   ·   ╵   │
│   │           │
│   ╵   ╶───╴   │
│             E │
└───────────────┘
""",
    ),
    "corners": (
        """\
+---+---+---+
| S         |
+   +---+   +
|   |   |   |
+   +---+   +
|         E |
+---+---+---+
""",
        """\
┌───────────┐
│ S         │
│   ┌───┐   │
│   │   │   │
│   └───┘   │
│         E │
└───────────┘
""",
    ),
    "glass": (
        """\
+---+---+---+
| S :       |
+   +   +---+
|   :   |   |
+- -+- -+- -+
|   |       |
+   +- -+- -+
|   |     E |
+---+---+---+
""",
        """\
┌───┬───────┐
│ S ╎       │
│   ╎   ┌───┤
│   ╎   │   │
├╌╌╌┼╌╌╌┴╌╌╌┤
│   │       │
│   ├╌╌╌╌╌╌╌┤
│   │     E │
└───┴───────┘
""",
    ),
    "puddles and blocks": (
        """\
+---+---+---+---+
| S   o |###|###|
+   +   +---+---+
|     O |###|###|
+---+   +   +---+
|###|   |###| E |
+---+---+---+---+
""",
        """\
┌───────┬───────┐
│ S   ∘ │███████│
│   ·   │███████│
│     ◯ │███████│
├───┐   │███┌───┤
│███│   │███│ E │
└───┴───┴───┴───┘
""",
    ),
}


@pytest.mark.parametrize("name", EXPECTED)
def test_the_terminal_picture_is_joined_up(name: str) -> None:
    drawn, expected = EXPECTED[name]
    assert picture(level(map=drawn)) == expected


def test_one_cell() -> None:
    world = level(size=[1, 1], exit="none")
    assert picture(world) == "┌───┐\n│ S │\n└───┘\n"
    assert picture(world, state=0) == "┌───┐\n│ ☻ │\n└───┘\n"


def test_warps_and_wind_are_arrows() -> None:
    world = level(
        size=[4, 3],
        warps=[
            {"at": [1, 0], "to": [3, 0]},
            {"at": [2, 1], "to": "start"},
            {"at": [3, 1], "to": [0, 2], "when": "leave"},
            {"at": [0, 1], "to": [0, 1], "when": "leave"},
        ],
        wind={"north": [0, 0, 2, 0], "west": [0, 0, 1]},
    )
    assert picture(world) == (
        "┌───────────────┐\n"
        "│ S   ⇒   ↑     │\n"
        "│   ·   ·   ·   │\n"
        "│ ◉       ↻   ⇐ │\n"
        "│   ·   ·   ·   │\n"
        "│ ←   ←   ↖   E │\n"
        "└───────────────┘\n"
    )


def test_a_legend_s_characters_are_shown() -> None:
    drawn = "+---+---+\n| S   H |\n+---+---+\n"
    assert "│ S   H │" in picture(level(map=drawn, legend={"H": {"ends": True}}))


@given(
    width=st.integers(1, 7),
    height=st.integers(1, 7),
    seed=st.integers(0, 10**6),
    color=st.booleans(),
)
def test_columns_line_up_with_the_language_s_drawing(
    width: int, height: int, seed: int, color: bool
) -> None:
    fields: dict[str, Any] = {"exit": "none"} if width * height == 1 else {}
    world = level(size=[width, height], maze={"seed": seed, "loops": 0.5}, **fields)
    lines = ESCAPE.sub("", picture(world, state=width * height - 1, color=color)).split("\n")
    drawn = world.draw().split("\n")
    assert [len(line) for line in lines] == [len(line) for line in drawn]
    for line, other in zip(lines, drawn, strict=True):
        for character, plain in zip(line, other, strict=True):
            assert unicodedata.east_asian_width(character) not in "WF"
            assert not unicodedata.combining(character)
            if plain in "-|":
                assert character in "─│"


# -- the robot -----------------------------------------------------------------------------


def test_the_robot_stands_in_its_cell_and_changes_nothing_else() -> None:
    world = level(size=[4, 3], maze={"seed": 5})
    without, with_robot = picture(world), picture(world, state=6)
    changed = [
        i for i, pair in enumerate(zip(without, with_robot, strict=True)) if len({*pair}) > 1
    ]
    assert changed == [3 * 18 + 2 + 4 * 2]
    assert with_robot[changed[0]] == "☻"


# -- colours -------------------------------------------------------------------------------

COLORFUL = level(
    size=[4, 3],
    puddles=[{"at": [1, 1]}, {"at": [2, 1], "size": "large"}],
    areas=[{"at": [0, 1], "size": [1, 2], "color": "plum"}],
    blocked=[{"at": [3, 0]}],
    walls=[{"at": [1, 0], "side": "E", "pass": 0.5}],
)


def test_without_colour_there_are_no_escapes() -> None:
    assert "\x1b" not in picture(COLORFUL, state=2)


def test_colours_change_no_character_and_end_with_the_line() -> None:
    painted = picture(COLORFUL, state=2, color=True)
    assert ESCAPE.sub("", painted) == picture(COLORFUL, state=2)
    for line in painted.split("\n")[:-1]:
        assert line.endswith("\x1b[0m")
        assert line.startswith("\x1b[38;2;")


def test_colours_are_the_theme_s() -> None:
    rows = []
    for line in picture(COLORFUL, color=True).split("\n")[:-1]:
        ground, row = "", []
        for escape, character in re.findall(r"\x1b\[([\d;]*)m|(.)", line):
            ground = ";".join(escape.split(";")[-3:]) if escape else ground
            row += [ground] if character else []
        rows.append(row)
    orange, red, green = "255;165;0", "237;24;24", "0;128;0"
    plum, water = "221;160;221", "31;99;176"
    assert rows[1][2::4] == [red, orange, orange, orange]
    assert rows[3][2::4] == [plum, water, water, orange]
    assert rows[5][2::4] == [plum, orange, orange, green]
    # Between the cells of an area goes the area's colour on, around it does not.
    assert rows[4][2] == plum
    assert rows[3][4] == rows[4][4] == rows[2][2] == orange
    assert rows[3][8] == water
