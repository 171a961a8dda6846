"""The size of a level, its wind, and its maze written out."""

from __future__ import annotations

from typing import Any

import pytest
from support.gestures import done, refused, send

from babyrobot_levels.extensions.editor.session import Session
from babyrobot_levels.mdp.grid import BIT

pytestmark = pytest.mark.usefixtures("put_off")

THINGS = """\
version: 1
size: [4, 3]
start: [1, 1]
exit: [2, 1]
walls:
  - {at: [0, 0], side: E, length: 3}
  - {at: [3, 0], side: E, length: 3, color: red}
items:
  - {name: key, at: [0, 2]}
switches:
  - {name: lever, at: [3, 0]}
movers:
  - {path: [[2, 0], [3, 0]], back: true}
  - {within: {at: [2, 1], size: [2, 2]}, start: [3, 2]}
puddles:
  - {at: [1, 2]}
areas:
  - {at: [0, 1], size: [4, 1], color: tan}
blocked:
  - {at: [0, 0]}
warps:
  - {at: [1, 0], to: [2, 0]}
  - {at: [2, 2], to: start}
wind: {north: [0, 1, 0, 2]}
"""

DRAWN = """\
version: 1
map: |
  +---+---+
  | S | k |
  +   +---+
  |     E |
  +---+---+
legend:
  k: {item: key}
exit_needs: key
"""


def resize(session: Session, width: int, height: int, across: int = 0, down: int = 0) -> str:
    return done(session, "resize", size=[width, height], shift=[across, down])


def test_how_a_wind_blows_stays_with_it() -> None:
    session = Session("version: 1\nwind: {north: [0, 1, 0], varies: true, probability: 0.5}\n")
    text = resize(session, 4, 3)
    assert "wind: {north: [0, 1, 0, 0], varies: true, probability: 0.5}" in text
    text = done(session, "wind", side="N", index=0, strength=2)
    assert "wind: {north: [2, 1, 0, 0], varies: true, probability: 0.5}" in text
    done(session, "wind", side="N", index=0, strength=0)
    assert "wind" not in done(session, "wind", side="N", index=1, strength=0)


def test_weights_go_with_their_cells() -> None:
    session = Session(
        "version: 1\nsize: [5, 1]\nstart: [[3, 0], [0, 0]]\nstart_weights: [2, 3]\nexit: [2, 0]\n"
        "warps:\n  - {at: [1, 0], to: [[4, 0], [0, 0]], weights: [5, 6]}\n"
    )
    text = resize(session, 5, 1, across=1)
    assert "start: [[4, 0], [1, 0]]\nstart_weights: [2, 3]" in text
    assert "{at: [2, 0], to: [[1, 0]], weights: [6]}" in text
    text = resize(session, 4, 1, across=-1)
    assert "start_weights: [2, 3]" in text
    text = done(session, "paint", brush="exit", cells=[[3, 0]], add=True)
    assert "start: [0, 0]" in text
    assert "start_weights" not in text


@pytest.mark.slow
def test_everything_moves_with_what_is_added_at_the_left_and_the_top() -> None:
    assert (
        resize(Session(THINGS), 5, 5, 1, 2)
        == """\
version: 1
size: [5, 5]
start: [2, 3]
exit: [3, 3]
walls:
  - {at: [1, 2], side: E, length: 3}
  - {at: [4, 2], side: E, length: 3, color: red}
items:
  - {name: key, at: [1, 4]}
switches:
  - {name: lever, at: [4, 2]}
movers:
  - {path: [[3, 2], [4, 2]], back: true}
  - {within: {at: [3, 3], size: [2, 2]}, start: [4, 4]}
puddles:
  - {at: [2, 4]}
areas:
  - {at: [1, 3], size: [4, 1], color: tan}
blocked:
  - {at: [1, 2]}
warps:
  - {at: [2, 2], to: [3, 2]}
  - {at: [3, 4], to: start}
wind: {north: [0, 0, 1, 0, 2]}
"""
    )


def test_what_falls_out_is_cut_or_removed() -> None:
    assert (
        resize(Session(THINGS), 3, 2)
        == """\
version: 1
size: [3, 2]
start: [1, 1]
exit: [2, 1]
walls:
  - {at: [0, 0], side: E, length: 2}
  - {at: [2, 0], side: E, length: 2, color: red}
movers:
  - {within: {at: [2, 1]}}
areas:
  - {at: [0, 1], size: [3, 1], color: tan}
blocked:
  - {at: [0, 0]}
warps:
  - {at: [1, 0], to: [2, 0]}
wind: {north: [0, 1, 0]}
"""
    )


def test_wall_that_comes_to_lie_on_the_rim_goes() -> None:
    text = resize(Session(THINGS), 3, 3, -1)
    assert "walls:\n  - {at: [2, 0], side: E, length: 3, color: red}\nswitches" in text


def test_start_and_exit_move_along_to_the_nearest_free_cell() -> None:
    session = Session("version: 1\nsize: [6, 4]\nstart: [5, 3]\nexit: [5, 0]\n")
    assert resize(session, 4, 4) == "version: 1\nsize: [4, 4]\nstart: [3, 3]\nexit: [3, 0]\n"
    assert resize(session, 4, 1, 0, -3) == "version: 1\nsize: [4, 1]\nstart: [3, 0]\nexit: [2, 0]\n"
    session = Session("version: 1\nsize: [4, 1]\nexit: [3, 0]\nblocked:\n  - {at: [2, 0]}\n")
    assert "exit: [1, 0]\n" in resize(session, 3, 1), "the exit was put into a blocked cell"


def test_a_level_keeps_a_start_beside_its_default_exit() -> None:
    session = Session("version: 1\nsize: [4, 3]\nstart: [1, 1]\n")
    assert resize(session, 2, 2) == "version: 1\nsize: [2, 2]\nstart: [1, 0]\n"


def test_a_size_without_a_cell_for_start_and_exit_is_refused() -> None:
    error = refused(Session(THINGS), "resize", size=[4, 1])
    assert error == "start and exit would have no free cell there"


@pytest.mark.slow
def test_what_lies_outside_is_told() -> None:
    session = Session(THINGS + "exit_needs: [key, lever]\n")
    lost = send(session, "resize", size=[3, 2])["state"]["lost"]
    assert lost == "an item, a switch, a mover, a warp and a puddle"
    assert send(session, "undo")["state"]["lost"] == ""


def test_default_exit_stays_in_the_corner_and_the_default_start_moves() -> None:
    session = Session("version: 1\n")
    assert resize(session, 8, 5) == "version: 1\nsize: [8, 5]\n"
    assert resize(session, 9, 5, 1) == "version: 1\nsize: [9, 5]\nstart: [1, 0]\n"


@pytest.mark.slow
def test_things_that_are_gone_are_no_longer_needed() -> None:
    session = Session(THINGS + "exit_needs: [key, lever]\n")
    assert "exit_needs: key\n" in resize(session, 3, 3)


def test_drawing_gets_another_size() -> None:
    session = Session(DRAWN)
    assert (
        resize(session, 3, 2, 1)
        == """\
version: 1
map: |
  +---+---+---+
  |     S | k |
  +   +   +---+
  |         E |
  +---+---+---+
legend:
  k: {item: key}
exit_needs: key
"""
    )
    send(session, "resize", size=[3, 1], shift=[0, -1])
    assert session.text.startswith("version: 1\nmap: |\n  +---+---+---+\n  |     S   E |\n")


# -- wind ----------------------------------------------------------------------------------


def blow(session: Session, side: str, index: int, strength: int) -> str:
    return done(session, "wind", side=side, index=index, strength=strength)


def test_wind_is_set_in_one_column_or_row() -> None:
    session = Session("version: 1\n")
    blow(session, "N", 1, 2)
    text = blow(session, "E", 0, 1)
    assert text == "version: 1\nwind: {north: [0, 2, 0], east: [1, 0, 0]}\n"
    blow(session, "N", 1, 0)
    assert blow(session, "E", 0, 0) == "version: 1\n"


def test_wind_takes_the_place_of_one_the_other_way() -> None:
    session = Session("version: 1\nwind: {north: [1, 2, 0]}\n")
    text = blow(session, "S", 1, 1)
    assert text == "version: 1\nwind: {north: [1, 0, 0], south: [0, 1, 0]}\n"


def test_wind_off_the_grid_is_refused() -> None:
    error = refused(Session("version: 1\n"), "wind", side="E", index=3, strength=1)
    assert error == "the level has 3 rows, counted from 0"


# -- mazes ---------------------------------------------------------------------------------


def test_maze_becomes_walls_with_the_same_digest() -> None:
    session = Session(
        "version: 1\nsize: [5, 4]\nmaze: {seed: 7}\n"
        "walls:\n  # glass\n  - {at: [0, 0], side: E, pass: 0.2}\n"
        "openings:\n  - {at: [2, 2], side: E, length: 2}\n"
    )
    assert session.level is not None
    digest = session.level.digest
    text = done(session, "resolve")
    assert "maze" not in text
    assert "openings" not in text
    assert "  # glass\n" in text
    assert session.level.digest == digest


@pytest.mark.parametrize(
    ("maze", "message"),
    [
        ("", "the level has no maze"),
        ("maze: {seed: random}\n", "each reset draws another maze: give it a seed first"),
    ],
)
def test_without_one_maze_there_is_nothing_to_write_out(maze: str, message: str) -> None:
    assert refused(Session("version: 1\n" + maze), "resolve") == message


GROWN = "version: 1\nsize: [6, 5]\nstart: [0, 0]\nmaze: {seed: 7}\n"

REGROWING = {
    "another start": {"do": "move", "route": ["start"], "from": [0, 0], "to": [3, 2]},
    "another size": {"do": "resize", "size": [7, 5], "shift": [1, 0]},
    "a blocked cell": {"do": "paint", "brush": "blocked", "cells": [[2, 2]]},
}


def sides(session: Session) -> dict[tuple[int, int, str], bool]:
    """Return which inner sides have walls."""
    assert session.level is not None
    grid, (width, height) = session.level.grid(), session.level.size
    return {
        (x, y, side): bool(grid.wall_bits[y * width + x] & BIT[side])
        for y in range(height)
        for x in range(width)
        for side in "ES"
        if (x < width - 1 if side == "E" else y < height - 1)
    }


@pytest.mark.parametrize("gesture", REGROWING.values(), ids=REGROWING)
def test_the_walls_of_a_maze_that_has_grown_anew_can_be_kept(gesture: dict[str, Any]) -> None:
    session = Session(GROWN)
    before = sides(session)
    assert send(session, **gesture)["state"]["maze_regrown"]
    assert not send(session, "keep_maze")["state"]["maze_regrown"]
    assert "maze" not in session.text
    across = gesture.get("shift", (0, 0))[0]
    kept = {(x + across, y, side): wall for (x, y, side), wall in before.items()}
    near = {(2, 2, "E"), (2, 2, "S"), (1, 2, "E"), (2, 1, "S")} if "brush" in gesture else set()
    now = sides(session)
    assert all(now[place] == wall for place, wall in kept.items() if place not in near)
    # Both are one step.
    send(session, "undo")
    assert session.text == GROWN


@pytest.mark.parametrize(
    "gesture",
    [
        {"do": "set", "route": ["maze", "seed"], "value": 8},
        {"do": "paint", "brush": "small", "cells": [[2, 2]]},
        {"do": "walls", "at": [0, 0], "side": "E", "to": "none"},
        {"do": "remove", "route": ["maze"]},
    ],
)
def test_other_gestures_do_not_tell_that_the_maze_has_grown(gesture: dict[str, Any]) -> None:
    session = Session(GROWN)
    assert not send(session, **gesture)["state"]["maze_regrown"]
    assert "did not make the maze grow" in refused(session, "keep_maze")
