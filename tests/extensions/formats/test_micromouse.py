"""Mazes of micromouse contests, as text and as 256 bytes."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.conversions import level_of_world, lost_fields, world_of

import babyrobot_levels as brl
from babyrobot_levels.extensions.formats.conversion import ConversionError
from babyrobot_levels.extensions.formats.formats import export
from babyrobot_levels.extensions.formats.micromouse import decode_maz
from babyrobot_levels.extensions.formats.reading import guess
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.source import SourceFile

MAZE = """\
o---o---o---o---o
| G   G |       |
o   o   o   o---o
|               |
o---o---o---o   o
|               |
o   o---o---o   o
| S |           |
o---o---o---o---o
"""
UNMARKED = MAZE.replace("S", " ").replace("G", " ")
OWN = ["+---+---+", "| S   E |", "+---+---+"]


def test_walls_start_and_goals_are_those_of_the_drawing() -> None:
    world = world_of(MAZE, "micromouse")
    level = level_of_world(world)
    assert (level.size, level.starts, level.exits) == ((4, 4), ((0, 3),), ((0, 0), (1, 0)))
    assert world.lost == ()
    assert level.grid().open[3, 0].tolist() == [True, False, False, False]
    assert brl.solve(level, 0.9).exit_probability == 1


def test_a_maze_comes_back_as_it_was() -> None:
    assert export(level_of_world(world_of(MAZE, "micromouse")), "micromouse").text == MAZE


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (MAZE, ["micromouse"]),
        (UNMARKED, ["micromouse"]),
        (MAZE.replace("o", "+"), ["micromouse"]),
        (UNMARKED.replace("o", "+"), ["micromouse"]),
        (f"Final of 2024\n{MAZE}", ["micromouse"]),
        ("\n".join(OWN), ["drawing"]),
        ("\n".join([*OWN, "", "G  gem: taken"]).replace("E", "G"), ["drawing"]),
        ("\n".join(OWN).replace("E", " "), ["drawing"]),
    ],
)
def test_it_is_told_from_drawings_of_the_language(text: str, found: list[str]) -> None:
    assert guess(SourceFile("maze.txt", text)) == found


def test_the_text_around_it_is_the_description() -> None:
    world = world_of(f"Final of 2024\n{MAZE}\nby A. Mouse\n", "micromouse")
    assert world.fields["description"] == "Final of 2024\n\nby A. Mouse"
    assert level_of_world(world).size == (4, 4)


def test_blanks_at_the_ends_of_lines_may_be_there() -> None:
    spaced = "".join(f"{line}  \r\n" for line in MAZE.splitlines())
    assert world_of(spaced, "micromouse").fields == world_of(MAZE, "micromouse").fields


def test_without_marks_the_rules_of_contests_hold() -> None:
    odd = "\n".join(["o---o---o---o", *["|           |", "o   o   o   o"] * 2, "|           |"])
    world = world_of(f"{odd}\no---o---o---o\n", "micromouse")
    level = level_of_world(world)
    assert (level.starts, level.exits, lost_fields(world)) == (((0, 2),), ((1, 1),), ["S", "G"])


def test_a_middle_that_cannot_be_reached_is_no_exit() -> None:
    closed = UNMARKED.replace("o---o---o---o   o", "o---o---o---o---o")
    world = world_of(closed, "micromouse")
    # Of the four cells in the middle, the two below are reached.
    assert level_of_world(world).exits == ((1, 2), (2, 2))
    shut = closed[::-1].replace("|               |", "|           |   |", 1)[::-1]
    world = world_of(shut, "micromouse")
    assert level_of_world(world).exits == ()
    assert str(world.lost[-1]) == "G: none is drawn, so there is no exit: no way to the middle"


def test_openings_of_the_outer_wall_are_told() -> None:
    world = world_of(MAZE.replace("| G   G |", "  G   G |", 1), "micromouse")
    assert [*map(str, world.lost)] == ["the outer wall: 1 openings in it are closed"]


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ("o---o---o---o   o", "o---o---o- -o   o", "5:10"),
        ("| S |           |", "| S |     X     |", "8:10"),
        ("| S |           |", "| S |           | |", "8:18"),
        ("o---o---o---o   o\n", "", "5:1"),
    ],
)
def test_a_faulty_line_is_pointed_at(old: str, new: str, place: str) -> None:
    with pytest.raises(ConversionError, match=rf"world.txt:{place}: error: this is no row of"):
        world_of(MAZE.replace(old, new, 1), "micromouse")


def test_a_text_without_a_maze_is_refused() -> None:
    with pytest.raises(ConversionError, match="no maze of posts and walls"):
        world_of("hello\n", "micromouse")


# -- 256 bytes -------------------------------------------------------------------------------


def _maze_of_bytes() -> bytes:
    """Return one long corridor up and down, as a binary file."""
    cells = []
    for x in range(16):
        for y in range(16):
            turn = 15 if x % 2 == 0 else 0
            east = 2 * (x == 15 or y != turn)
            west = 8 * (x == 0 or y != 15 - turn)
            cells.append((y == 15) | east | 4 * (y == 0) | west)
    return bytes(cells)


def test_the_bytes_are_columns_from_the_bottom_up() -> None:
    data = _maze_of_bytes()
    text = decode_maz(data)
    assert text is not None
    lines = text.splitlines()
    assert (lines[0], lines[1][:9], lines[31][:9]) == ("o---" * 16 + "o", "|       |", "|   |    ")
    level = level_of_world(world_of(text, "micromouse"))
    assert (level.starts, len(level.exits)) == (((0, 15),), 4)


def test_further_bits_are_the_mouses_own() -> None:
    data = _maze_of_bytes()
    assert decode_maz(bytes(each | 0x40 for each in data)) == decode_maz(data)


@pytest.mark.parametrize("data", [b"", b"\x0e" * 255, b"a" * 256])
def test_other_bytes_are_no_maze(data: bytes) -> None:
    assert decode_maz(data) is None


@pytest.mark.slow
@given(st.integers(0, 2**32), st.sampled_from(["depth-first", "prim", "sidewinder"]))
def test_a_maze_of_a_contest_goes_there_and_back(seed: int, algorithm: str) -> None:
    middle = [[x, y] for x in (7, 8) for y in (7, 8)]
    maze = {"seed": seed, "algorithm": algorithm}
    fields = {"version": 1, "size": [16, 16], "start": [0, 15], "exit": middle, "maze": maze}
    level = Level.from_fields(fields)
    conversion = export(level, "maz")
    assert conversion.warnings == ()
    assert conversion.data is not None
    text = decode_maz(conversion.data)
    assert text == conversion.text
    assert level_of_world(world_of(text, "maz")).digest == level.digest


def test_what_256_bytes_do_not_hold_is_told(tmp_path: Path) -> None:
    level = Level.from_fields({"version": 1, "size": [16, 16], "start": [3, 3], "exit": [9, 9]})
    told = [lost.field for lost in export(level, path=tmp_path / "a.maz").warnings]
    assert (told, len((tmp_path / "a.maz").read_bytes())) == (["start", "exit"], 256)
    with pytest.warns(brl.ConversionWarning, match="^[SG]: none is drawn"):
        assert brl.load(tmp_path / "a.maz").starts == ((0, 15),)
    with pytest.raises(ValueError, match="has 16 by 16 cells, not 8 by 5"):
        export(brl.load("final-maze"), "maz")


def test_cells_that_disagree_are_named() -> None:
    data = bytearray(_maze_of_bytes())
    data[0] ^= 1
    with pytest.raises(ConversionError, match=r"column 0\.5, row 15 disagree"):
        decode_maz(bytes(data))
