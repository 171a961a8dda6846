"""Walls, glass, doors and openings, drawn along the sides of cells."""

from __future__ import annotations

import pytest
from support.gestures import done, drawn, refused

from babyrobot_levels.extensions.editor.session import Session

pytestmark = pytest.mark.usefixtures("put_off")

EMPTY = "version: 1\nsize: [5, 3]\n"

KEY = "items:\n  - {name: key, at: [1, 1]}\n"

LONG = """\
version: 1
size: [5, 3]
walls:
  # the long one
  - {at: [0, 0], side: S, length: 5, color: red}  # red
"""

DRAWN = """\
version: 1
map: |
  +---+---+---+
  | S |       |
  +   +---+   +
  |         E |
  +---+---+---+
"""


def build(session: Session, x: int, y: int, side: str, to: str, **fields: object) -> str:
    return done(session, "walls", at=[x, y], side=side, to=to, **fields)


def added(text: str, before: str = EMPTY) -> str:
    """Return what a text says beyond the one before."""
    assert text.startswith(before)
    return text.removeprefix(before)


def test_straight_run_is_one_entry() -> None:
    text = build(Session(EMPTY), 1, 0, "S", "wall", length=3)
    assert added(text) == "walls:\n  - {at: [1, 0], side: S, length: 3}\n"


def test_side_is_named_from_the_cell_in_the_north_or_the_west() -> None:
    session = Session(EMPTY)
    build(session, 1, 1, "N", "wall")
    text = build(session, 1, 1, "W", "wall", length=2)
    entries = "  - {at: [1, 0], side: S}\n  - {at: [0, 1], side: E, length: 2}\n"
    assert added(text) == "walls:\n" + entries


def test_a_side_is_a_wall_glass_a_door_or_open() -> None:
    session = Session(EMPTY + KEY)
    assert "- {at: [1, 0], side: E}\n" in build(session, 1, 0, "E", "wall")
    assert "- {at: [1, 0], side: E, pass: 0.5}\n" in build(session, 1, 0, "E", "glass")
    text = build(session, 1, 0, "E", "door")
    assert "doors:\n  - {at: [1, 0], side: E, needs: key}\n" in text
    assert "walls" not in text
    assert build(session, 1, 0, "E", "none") == EMPTY + KEY


def test_a_side_does_not_become_what_comes_next() -> None:
    error = refused(Session(EMPTY), "walls", at=[1, 0], side="E", to="next")
    assert error == "this gesture is not known"


def test_door_needs_what_opens_nothing_yet() -> None:
    key, lever = "  - {name: key, at: [1, 1]}\n", "switches:\n  - {name: lever, at: [3, 1]}\n"
    session = Session(f"{EMPTY}items:\n{key}{lever}")
    assert "{at: [0, 0], side: E, needs: lever}" in build(session, 0, 0, "E", "door")
    assert "{at: [1, 0], side: E, needs: key}" in build(session, 1, 0, "E", "door")


def test_door_without_anything_to_open_it_is_refused() -> None:
    error = refused(Session(EMPTY), "walls", at=[1, 0], side="E", to="door")
    assert error == "a door needs an item, a switch or a target that opens it: add one first"


def test_glass_lets_through_with_the_probability_asked_for() -> None:
    session = Session(EMPTY)
    assert "side: E, pass: 0.2}" in build(session, 1, 0, "E", "glass", **{"pass": 0.2})
    assert "side: E, pass: 0.75}" in build(session, 1, 0, "E", "glass", **{"pass": 0.75})


def test_glass_that_lets_nobody_through_is_a_wall() -> None:
    text = build(Session(EMPTY), 1, 0, "E", "glass", **{"pass": 0})
    assert added(text) == "walls:\n  - {at: [1, 0], side: E}\n"


def test_removed_part_leaves_the_rest_of_an_entry_as_it_is() -> None:
    assert added(build(Session(LONG), 1, 0, "S", "none", length=3)) == (
        "walls:\n  # the long one\n  - {at: [0, 0], side: S, color: red}  # red\n"
        "  - {at: [4, 0], side: S, color: red}\n"
    )
    assert "\n  - {at: [2, 0], side: S, length: 3, color: red}  # red\n" in build(
        Session(LONG), 0, 0, "S", "none", length=2
    )


def test_entry_along_the_same_sides_keeps_its_looks() -> None:
    text = build(Session(LONG), 0, 0, "S", "glass", length=5)
    assert "  - {at: [0, 0], side: S, length: 5, pass: 0.5, color: red}  # red\n" in text


def test_run_across_other_walls_becomes_one_wall() -> None:
    session = Session(EMPTY)
    build(session, 1, 0, "S", "wall")
    build(session, 3, 0, "S", "glass")
    text = build(session, 0, 0, "S", "wall", length=5)
    assert added(text) == "walls:\n  - {at: [0, 0], side: S, length: 5}\n"


def test_run_that_is_so_already_changes_nothing() -> None:
    session = Session(LONG)
    assert build(session, 1, 0, "S", "wall", length=3) == LONG
    assert not session.can_undo


def test_named_sides_and_lengths_are_understood() -> None:
    session = Session(EMPTY + "walls:\n  - {at: [2.0, 1], side: north, length: 2}\n")
    assert "  - {at: [3, 1], side: north}\n" in build(session, 2, 0, "S", "none")


# -- mazes ---------------------------------------------------------------------------------

MAZE = "version: 1\nsize: [5, 3]\nmaze: {seed: 3}\n"


def wall_of(session: Session) -> tuple[int, int]:
    """Return a cell with a wall to the east."""
    assert session.level is not None
    rows = enumerate(session.level.grid().open[:, :, 1].tolist())
    return next((x, y) for y, row in rows for x, is_open in enumerate(row[:-1]) if not is_open)


def test_wall_of_a_maze_is_opened_and_closed_again() -> None:
    session = Session(MAZE)
    x, y = wall_of(session)
    text = build(session, x, y, "E", "none")
    assert added(text, MAZE) == f"openings:\n  - {{at: [{x}, {y}], side: E}}\n"
    assert build(session, x, y, "E", "wall") == MAZE


def test_glass_in_a_maze_stands_in_place_of_its_wall() -> None:
    session = Session(MAZE)
    x, y = wall_of(session)
    text = build(session, x, y, "E", "glass")
    assert added(text, MAZE) == f"walls:\n  - {{at: [{x}, {y}], side: E, pass: 0.5}}\n"
    assert "openings" in build(session, x, y, "E", "none")


def test_door_in_a_maze_stands_in_an_opening() -> None:
    session = Session(MAZE + KEY)
    x, y = wall_of(session)
    text = build(session, x, y, "E", "door")
    assert f"openings:\n  - {{at: [{x}, {y}], side: E}}\ndoors:\n" in text
    assert build(session, x, y, "E", "wall") == MAZE + KEY


def test_run_that_is_open_already_keeps_its_opening_whole() -> None:
    session = Session(MAZE)
    x, y = wall_of(session)
    opening = f"openings:\n  - {{at: [{x}, {y}], side: E, length: 2}}\n"
    session = Session(MAZE + opening)
    assert build(session, x, y, "E", "none") == MAZE + opening


def test_run_in_a_maze_opens_only_its_walls() -> None:
    session = Session(MAZE)
    build(session, 0, 0, "S", "none", length=5)
    assert session.level is not None
    assert all(session.level.grid().open[0, :, 2])
    assert sum(opening.length for opening in session.level.openings) < 5


def test_maze_that_each_reset_draws_is_opened_wherever_it_may_have_a_wall() -> None:
    random = "version: 1\nsize: [5, 3]\nmaze: {seed: random}\n"
    session = Session(random)
    text = build(session, 1, 0, "E", "none", length=2)
    assert added(text, random) == "openings:\n  - {at: [1, 0], side: E, length: 2}\n"
    text = build(session, 1, 0, "E", "wall", length=2)
    assert added(text, random) == "walls:\n  - {at: [1, 0], side: E, length: 2}\n"


# -- where nothing can stand ---------------------------------------------------------------


def test_outer_wall_stays() -> None:
    error = refused(Session(EMPTY), "walls", at=[2, 0], side="N", to="none")
    assert error == "side N of [2, 0] is part of the outer wall, which always stays"


@pytest.mark.parametrize(("at", "length"), [([4, 0], 2), ([0, 3], 1)])
def test_run_off_the_grid_is_refused(at: list[int], length: int) -> None:
    error = refused(Session(EMPTY), "walls", at=at, side="S", to="wall", length=length)
    assert error == "these sides are not all on the grid, which is 5x3"


def test_run_leaves_out_sides_between_blocked_cells() -> None:
    text = EMPTY + "blocked:\n  - {at: [2, 0], size: [1, 2]}\n"
    session = Session(text)
    walls = "walls:\n  - {at: [0, 0], side: S, length: 2}\n  - {at: [3, 0], side: S, length: 2}\n"
    assert walls in build(session, 0, 0, "S", "wall", length=5)
    error = refused(Session(text), "walls", at=[2, 0], side="S", to="wall")
    assert error == "beside blocked cells, a wall has no effect: unblock them first"


@pytest.mark.parametrize("to", ["glass", "door"])
def test_neither_glass_nor_doors_stand_beside_blocked_cells(to: str) -> None:
    session = Session(EMPTY + KEY + "blocked:\n  - {at: [2, 0]}\n")
    error = refused(session, "walls", at=[1, 0], side="E", to=to)
    assert error == f"beside blocked cells, a {to} has no effect: unblock them first"
    assert "{at: [1, 0], side: E}" in build(session, 1, 0, "E", "wall")


# -- drawings ------------------------------------------------------------------------------


def test_drawing_shows_walls_and_glass() -> None:
    session = Session(DRAWN)
    build(session, 0, 0, "E", "none")
    build(session, 0, 0, "S", "glass", length=2)
    text = build(session, 2, 0, "S", "wall")
    assert drawn(session) == [
        "+---+---+---+",
        "| S         |",
        "+- -+- -+---+",
        "|         E |",
        "+---+---+---+",
    ]
    assert "walls" not in text


def test_drawn_glass_with_another_probability_has_an_entry() -> None:
    session = Session(DRAWN)
    text = build(session, 0, 0, "E", "glass", **{"pass": 0.8})
    assert added(text, DRAWN.replace("S |", "S :")) == (
        "walls:\n  - {at: [0, 0], side: E, pass: 0.8}\n"
    )
    assert build(session, 0, 0, "E", "glass") == DRAWN.replace("S |", "S :")
    assert build(session, 0, 0, "E", "wall") == DRAWN


def test_looks_of_drawn_walls_stay_until_they_are_removed() -> None:
    looks = "walls:\n  - {at: [0, 0], side: E, color: red}\n"
    session = Session(DRAWN + looks)
    assert "{at: [0, 0], side: E, color: red}" in build(session, 0, 0, "E", "glass")
    assert "walls" not in build(session, 0, 0, "E", "none")


def test_drawn_door_has_a_mark_and_an_entry() -> None:
    session = Session(DRAWN.replace("         E", "     k   E") + "legend:\n  k: {item: key}\n")
    text = build(session, 0, 0, "E", "door")
    assert "| S /       |" in drawn(session)
    assert "doors:\n  - {at: [0, 0], side: E, needs: key}\n" in text
    assert "doors" not in build(session, 0, 0, "E", "none")
