"""Levels as text: joints, symbols, the robot, and colours for terminals."""

from __future__ import annotations

import os
import re
import unicodedata
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.scenes import CORRIDOR, VAULT
from support.worlds import level

from babyrobot_levels.mdp.states import configuration_with, initial_configuration
from babyrobot_levels.render.colors import rgba
from babyrobot_levels.render.scene.heat import scale_of
from babyrobot_levels.render.scene.layout import Overlay
from babyrobot_levels.render.terminal import ALL_COLORS
from babyrobot_levels.render.text import TextPainter
from babyrobot_levels.render.text_plan import escape

ESCAPE = re.compile(r"\x1b\[[\d;]*m")


def picture(world: Any, state: int | None = None, *, color: bool = False) -> str:
    lines = TextPainter(world).lines(state, colors=ALL_COLORS if color else 0, held=False)
    return "\n".join([*lines, ""])


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


# -- colours -------------------------------------------------------------------------------

COLORFUL = level(
    size=[4, 3],
    puddles=[{"at": [1, 1]}, {"at": [2, 1], "size": "large"}],
    areas=[{"at": [0, 1], "size": [1, 2], "color": "plum"}],
    blocked=[{"at": [3, 0]}],
    walls=[{"at": [1, 0], "side": "E", "pass": 0.5}],
)


def test_colours_change_no_character_and_end_with_the_line() -> None:
    painted = picture(COLORFUL, state=2, color=True)
    assert ESCAPE.sub("", painted) == picture(COLORFUL, state=2)
    for line in painted.split("\n")[:-1]:
        assert line.endswith("\x1b[0m")
        assert line.startswith("\x1b[38;2;")


# -- values and policies in colour ---------------------------------------------------------


LAKE = level(
    map="+---+---+---+\n| S   o   H |\n+   +   +   +\n|         E |\n+---+---+---+\n",
    legend={"H": {"ends": True}},
    wind={"north": [0, 1, 0]},
)
VALUES = [[-12.5, 0.25, None], [1.0, 2.0, None]]
ACTIONS = [[(2, 3), (3,), ()], [(2,), (2,), ()]]


def painted(overlay: Overlay, columns: int = 80, colors: int = ALL_COLORS) -> list[str]:
    room = os.terminal_size((columns, 50))
    return TextPainter(LAKE, overlay=overlay).lines(None, colors=colors, room=room)


def code(color: str) -> str:
    return ";".join(str(share) for share in rgba(color)[:3])


def grounds_of(line: str) -> list[tuple[str, str]]:
    """Return the characters of a line with the colours behind them."""
    ground, found = "", []
    for sent, character in re.findall(r"\x1b\[([\d;]*)m|(.)", line):
        if character:
            found.append((character, ground))
        elif sent:
            ground = sent.partition("48;2;")[2]
    return found


def test_values_stand_on_the_colours_of_their_scale() -> None:
    lines = painted(Overlay(values=VALUES, actions=ACTIONS))
    assert [ESCAPE.sub("", line) for line in lines] == [
        "┌─────────────────────────────┐",
        "│S↓ -12.50 ∘↓   0.25     H    │",
        "│         ·         ·         │",
        "│ →   1.00  →   2.00     E    │",
        "└─────────────────────────────┘",
        "",
        f"-12.50 {24 * ' '} 2.00",
    ]
    colors = LAKE.resolved_theme.colors
    scale = scale_of([-12.5, 0.25, 1.0, 2.0], colors)
    row = grounds_of(lines[1])
    assert row[1] == ("S", code(colors.start))
    assert row[2] == ("↓", code(scale.color(-12.5)))
    assert {ground for _, ground in row[2:9]} == {code(scale.color(-12.5))}
    assert row[11] == ("∘", code(colors.puddle))
    assert {ground for _, ground in row[13:20]} == {code(scale.color(0.25))}
    legend = grounds_of(lines[-1])
    assert legend[7][1] == code(scale.strip(24)[0])
    assert legend[30][1] == code(scale.strip(24)[-1])


@pytest.mark.parametrize(("columns", "cell"), [(31, 9), (28, 8), (27, 3), (13, 3)])
def test_numbers_are_shown_where_they_fit(columns: int, cell: int) -> None:
    lines = painted(Overlay(values=VALUES, actions=ACTIONS), columns)
    assert len(ESCAPE.sub("", lines[0])) == 3 * (cell + 1) + 1
    shown = ESCAPE.sub("", lines[1])
    assert ("-12.50" in shown) == (cell > 3)
    # Without numbers, colours and arrows are left.
    assert shown[1:3] == "S↓"
    assert len({ground for _, ground in grounds_of(lines[1])}) >= 4


def test_an_arrow_of_the_policy_takes_the_place_of_one_of_the_wind() -> None:
    world = level(size=[3, 1], wind={"east": [1]})
    actions: Any = [[(2,), (4,), ()]]
    lines = TextPainter(world, overlay=Overlay(actions=actions)).lines(None, colors=ALL_COLORS)
    assert ESCAPE.sub("", lines[1]) == "│S→   ←   E │"


def test_without_colour_numbers_are_below_the_drawing() -> None:
    lines = painted(Overlay(values=VALUES, actions=ACTIONS), colors=0)
    assert lines[1::2][:2] == ["│S↓  ∘↓   H │", "│ →   →   E │"]
    assert lines[6:] == ["-12.50    0.25", "  1.00    2.00"]


def test_the_robot_stands_beside_the_number_of_its_cell() -> None:
    painter = TextPainter(LAKE, overlay=Overlay(values=VALUES))
    assert ESCAPE.sub("", painter.lines(1, colors=ALL_COLORS)[1]) == "│S-12.50  ☻  0.25     H    │"


@pytest.mark.parametrize(
    ("colors", "form"),
    [
        (ALL_COLORS, r"38;2;\d+;\d+;\d+;48;2;\d+;\d+;\d+"),
        (256, r"38;5;\d+;48;5;\d+"),
        (16, r"(3[0-7]|9[0-7]);(4[0-7]|10[0-7])"),
    ],
)
def test_escapes_are_those_that_the_terminal_knows(colors: int, form: str) -> None:
    for line in painted(Overlay(values=VALUES), colors=colors):
        for sent in re.findall(r"\x1b\[([\d;]+)m", line):
            assert sent == "0" or re.fullmatch(form, sent)


@pytest.mark.parametrize(
    ("ink", "ground", "colors", "expected"),
    [
        ((255, 255, 255), (0, 0, 0), 256, "38;5;231;48;5;16"),
        ((128, 128, 128), (255, 135, 0), 256, "38;5;244;48;5;208"),
        ((255, 0, 0), (0, 0, 0), 16, "91;40"),
        # Two greys that would be the same one.
        ((120, 120, 120), (130, 130, 130), 16, "30;100"),
    ],
)
def test_colours_are_replaced_by_the_nearest(
    ink: Any, ground: Any, colors: int, expected: str
) -> None:
    assert escape(ink, ground, colors) == f"\x1b[{expected}m"


# -- large levels --------------------------------------------------------------------------


@given(
    columns=st.integers(1, 90),
    lines=st.integers(2, 40),
    cell=st.integers(0, 19 * 15 - 1),
    colors=st.sampled_from([0, ALL_COLORS]),
)
def test_a_part_fits_and_shows_the_robot(columns: int, lines: int, cell: int, colors: int) -> None:
    world = level(size=[19, 15], maze={"seed": 1})
    room = os.terminal_size((columns, lines))
    shown = [ESCAPE.sub("", line) for line in TextPainter(world).lines(cell, colors=colors,
             room=room)]  # fmt: skip
    assert len(shown) <= lines
    assert all(len(line) <= columns for line in shown)
    whole = columns >= 77 and lines >= 31
    assert whole or shown[-1] == "cells"[:columns] or shown[-1].startswith("cells "[:columns])
    if columns >= 5 and lines >= 4:
        assert sum(line.count("☻") for line in shown) == 1


def test_blocks_are_the_cells_and_walls_in_their_colours() -> None:
    drawn = "+---+---+\n| S   o |\n+   +---+\n|     E |\n+---+---+\n"
    world = level(map=drawn)
    lines = TextPainter(world).blocks(colors=ALL_COLORS)
    pixels: list[list[str]] = []
    for line in lines:
        above: list[str] = []
        below: list[str] = []
        for ink, ground in re.findall(r"(?:\x1b\[38;2;([\d;]+?)(?:;48;2;([\d;]+))?m)?▀", line):
            above.append(ink or above[-1])
            below.append(ground if ink else below[-1])
        pixels += [above, below]
    colors = world.resolved_theme.colors
    wall, base, start, exit_ = (
        code(color) for color in (colors.walls, colors.base, colors.start, colors.exit)
    )
    assert pixels == [
        [wall] * 5,
        [wall, start, base, pixels[1][3], wall],
        [wall, base, wall, wall, wall],
        [wall, base, base, exit_, wall],
        [wall] * 5,
        [""] * 5,
    ]
    assert pixels[1][3] not in (base, wall)


# -- things ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("plain", "heading", "expected"),
    [
        (
            False,
            None,
            "┌───────────────────┬───────┐\n"
            "│ S           ¢     │     Ω │\n"
            "│   ·   ·   ·   ·   │   ·   │\n"
            "│                   │ ♦     │\n"
            "│   ·   ·   ·   ·   ╵   ·   │\n"
            "│         ☻1  1     :       │\n"
            "├───╴╴ ╶╶───────╴   ╷   ·   │\n"
            "│                   │   ┃   │\n"
            "│   ·   ·   ·   ·   │   ·   │\n"
            "│         Ω         │     X │\n"
            "└───────────────────┴───────┘\n"
            "\n"
            "held: key",
        ),
        (
            True,
            1,
            "+---+---+---+---+---+---+---+\n"
            "| S           c     |     & |\n"
            "+   +   +   +   +   +   +   +\n"
            "|                   | g     |\n"
            "+   +   +   +   +   +   +   +\n"
            "|         >1  1     :       |\n"
            "+---+- -+---+---+   +   +   +\n"
            "|                   |   /   |\n"
            "+   +   +   +   +   +   +   +\n"
            "|         &         |     X |\n"
            "+---+---+---+---+---+---+---+\n"
            "\n"
            "held: key",
        ),
    ],
)
def test_a_state_as_text(plain: bool, heading: int | None, expected: str) -> None:
    state = configuration_with(VAULT, ["key", "lever", "plate"]) * 35 + 2 * 7 + 2
    assert "\n".join(TextPainter(VAULT, plain=plain).lines(state, heading=heading)) == expected


def test_nothing_is_held_at_first_and_the_line_can_be_left_out() -> None:
    painter = TextPainter(CORRIDOR)
    assert painter.lines(0)[-2:] == ["", "held: nothing"]
    assert painter.lines(0, held=False)[-1].startswith("└")
    assert TextPainter(level(size=[3, 1])).lines(0)[-1].startswith("└")


def test_arrows_leave_room_for_things_beside_them() -> None:
    overlay = Overlay(actions=[[(2,), (2,), (2,), (), ()]])
    painter = TextPainter(CORRIDOR, plain=True, overlay=overlay)
    assert painter.lines(None, configuration=0, held=False) == [
        "+---+---+---+---+---+",
        "|S>  k>  0> /     & |",
        "+---+---+---+---+---+",
    ]


def test_characters_of_things_have_colors_that_are_seen() -> None:
    state = initial_configuration(CORRIDOR) * 5
    line = TextPainter(CORRIDOR).lines(state, colors=ALL_COLORS)[1]
    # The key on its own colour, and the door on that of the key.
    escapes = re.findall(r"\x1b\[38;2;\d+;\d+;\d+;48;2;(\d+);(\d+);(\d+)m([^\x1b]*)", line)
    grounds = {text: (red, green, blue) for red, green, blue, text in escapes}
    assert grounds["♀"] == grounds["┃"] == ("255", "194", "26")
    assert grounds["Ω"] == ("255", "93", "115")
