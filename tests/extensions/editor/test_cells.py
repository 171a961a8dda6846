"""Puddles, blocked cells, areas, ends and things: painted, filled in, and erased."""

from __future__ import annotations

from typing import Any

import pytest
from support.gestures import done, drawn, refused, send

import babyrobot_levels as brl
from babyrobot_levels.extensions.editor.session import Session

pytestmark = pytest.mark.usefixtures("put_off")

EMPTY = "version: 1\nsize: [4, 3]\n"

DRAWN = """\
version: 1
map: |
  +---+---+---+
  | S   k     |
  +   +   +   +
  | o   g   E |
  +---+---+---+
legend:
  k: {item: key}
  g: {color: tan}
"""

DOOR = "doors:\n  - {at: [1, 0], side: E, needs: key}\n"


def paint(session: Session, brush: str, *cells: tuple[int, int], **fields: Any) -> str:
    return done(session, "paint", brush=brush, cells=[[*cell] for cell in cells], **fields)


def added(text: str, before: str = EMPTY) -> str:
    """Return what a text says beyond the one before."""
    assert text.startswith(before)
    return text.removeprefix(before)


def rows(text: str) -> list[str]:
    """Return the rows of cells of a text's drawing."""
    return [line.strip() for line in text.splitlines() if line.strip().startswith("|")]


# -- puddles -------------------------------------------------------------------------------


def test_puddles_are_painted_in_order_each_cell_once() -> None:
    text = paint(Session(EMPTY), "small", (2, 1), (1, 1), (2, 1))
    assert added(text) == (
        "puddles:\n  - {at: [2, 1], size: small}\n  - {at: [1, 1], size: small}\n"
    )


def test_puddle_of_another_size_takes_the_place_of_the_first() -> None:
    session = Session(EMPTY + "puddles:\n  - {at: [1, 1]}  # wet\n  - {at: [2, 1]}\n")
    text = paint(session, "large", (1, 1))
    assert added(text) == ("puddles:\n  - {at: [1, 1], size: large}  # wet\n  - {at: [2, 1]}\n")


def test_puddle_unblocks_its_cell() -> None:
    session = Session(EMPTY + "blocked:\n  - {at: [1, 1]}\n")
    assert added(paint(session, "small", (1, 1))) == ("puddles:\n  - {at: [1, 1], size: small}\n")


def test_cell_off_the_grid_is_refused() -> None:
    error = refused(Session(EMPTY), "paint", brush="small", cells=[[1, 1], [4, 0]])
    assert error == "the cell [4, 0] is off the grid, which is 4x3"


def test_very_many_cells_are_refused() -> None:
    session = Session("version: 1\nsize: [1024, 1024]\n")
    error = refused(session, "paint", brush="erase", cells=[[0, 0], [1023, 1023]], rectangle=True)
    assert error == "these are 1,048,576 cells; paint at most 65,536 at once"


# -- blocked cells -------------------------------------------------------------------------


def test_blocked_cells_painted_one_after_another_become_one_rectangle() -> None:
    session = Session(EMPTY)
    for cell in ((1, 1), (2, 1), (1, 2), (2, 2)):
        text = paint(session, "blocked", cell)
    assert added(text) == "blocked:\n  - {at: [1, 1], size: [2, 2]}\n"


def test_erased_cell_leaves_the_rest_of_a_rectangle() -> None:
    session = Session(EMPTY + "blocked:\n  - {at: [1, 0], size: [2, 3]}  # rock\n")
    assert added(paint(session, "erase", (1, 1))) == (
        "blocked:\n"
        "  - {at: [1, 0], size: [2, 1]}  # rock\n"
        "  - {at: [2, 1]}\n"
        "  - {at: [1, 2], size: [2, 1]}\n"
    )


def test_rectangles_beside_the_erased_cell_stay_as_they_are() -> None:
    others = "blocked:\n  - {at: [0, 1]}  # rock\n  - {at: [2, 0], size: [1, 3]}\n"
    text = paint(Session(EMPTY + others + "  - {at: [1, 0]}\n"), "erase", (1, 0))
    assert added(text) == others


def test_blocked_cell_is_empty() -> None:
    text = """\
items:
  - {name: key, at: [1, 1]}
doors:
  - {at: [0, 0], side: E, needs: key}
warps:
  - {at: [0, 2], to: [1, 1]}
puddles:
  - {at: [1, 1]}
"""
    assert added(paint(Session(EMPTY + text), "blocked", (1, 1))) == "blocked:\n  - {at: [1, 1]}\n"


def test_doors_beside_a_blocked_cell_go() -> None:
    text = "doors:\n  - {at: [1, 0], side: E, length: 2, needs: key}\n"
    text += "items:\n  - {name: key, at: [0, 1]}\n"
    blocked = paint(Session(EMPTY + text), "blocked", (2, 0))
    assert "doors:\n  - {at: [1, 1], side: E, needs: key}\n" in blocked


def test_blocked_cells_leave_out_the_only_start_and_exit() -> None:
    session = Session(EMPTY)
    paint(session, "blocked", (0, 0), (3, 2), rectangle=True)
    assert session.level is not None
    assert session.level.grid().blocked.sum() == 10
    error = refused(session, "paint", brush="blocked", cells=[[0, 0]])
    assert error == "the start or the exit is there: move it to another cell first"


def test_maze_that_needs_the_whole_rectangle_stays_without_blocked_cells() -> None:
    session = Session(EMPTY + "maze: {seed: 1, algorithm: eller}\n")
    error = refused(session, "paint", brush="blocked", cells=[[1, 1]])
    assert error == "`eller` cannot grow a maze around blocked cells"


# -- starts and exits ----------------------------------------------------------------------


def test_painted_start_is_the_only_one_unless_it_is_added() -> None:
    session = Session(EMPTY)
    assert added(paint(session, "start", (1, 1))) == "start: [1, 1]\n"
    assert added(paint(session, "start", (2, 1), add=True)) == "start: [[1, 1], [2, 1]]\n"
    assert added(paint(session, "start", (0, 0), (0, 1))) == "start: [[0, 0], [0, 1]]\n"


def test_painting_the_default_start_or_exit_writes_nothing() -> None:
    session = Session(EMPTY)
    paint(session, "start", (0, 0))
    assert paint(session, "exit", (3, 2)) == EMPTY


def test_start_takes_what_cannot_be_there_away() -> None:
    session = Session(
        EMPTY + "areas:\n  - {at: [0, 1], size: [2, 1], ends: true}\n"
        "blocked:\n  - {at: [2, 2]}\nwarps:\n  - {at: [1, 1], to: [2, 1]}\n"
    )
    assert added(paint(session, "start", (1, 1), (2, 2))) == (
        "start: [[1, 1], [2, 2]]\nareas:\n  - {at: [0, 1], ends: true}\n"
    )


def test_start_and_exit_take_each_others_cells_while_others_are_left() -> None:
    session = Session(EMPTY + "exit: [[3, 2], [1, 1]]\n")
    assert added(paint(session, "start", (1, 1))) == "start: [1, 1]\nexit: [3, 2]\n"
    error = refused(session, "paint", brush="start", cells=[[3, 2]])
    assert error == "the exit is there: move it to another cell first"
    error = refused(session, "paint", brush="exit", cells=[[1, 1]])
    assert error == "the start is there: move it to another cell first"


@pytest.mark.parametrize("things", ["items", "switches"])
def test_exit_takes_the_place_of_a_thing(things: str) -> None:
    text = f"{things}:\n  - {{name: key, at: [1, 1]}}\nexit_needs: key\n"
    assert added(paint(Session(EMPTY + text), "exit", (1, 1))) == "exit: [1, 1]\n"


def test_erased_exits_leave_a_level_without_an_exit() -> None:
    session = Session(EMPTY)
    assert added(paint(session, "erase", (3, 2))) == "exit: none\n"


def test_last_start_cannot_be_erased() -> None:
    session = Session(EMPTY + "puddles:\n  - {at: [0, 0]}\n")
    assert paint(session, "erase", (0, 0)) == EMPTY
    error = refused(session, "paint", brush="erase", cells=[[0, 0]])
    assert error == "a level needs a start: put it into another cell instead"


def test_exits_drawn_by_lot_stay_several_or_become_one() -> None:
    session = Session(EMPTY + "exit_one_of: [[1, 0], [2, 0]]\n")
    text = paint(session, "exit", (3, 0), add=True)
    assert added(text) == "exit_one_of: [[1, 0], [2, 0], [3, 0]]\n"
    paint(session, "erase", (1, 0))
    assert added(paint(session, "erase", (2, 0))) == "exit: [3, 0]\n"


# -- areas ---------------------------------------------------------------------------------


def test_area_is_a_rectangle_with_properties() -> None:
    text = paint(
        Session(EMPTY),
        "area",
        (1, 1),
        (2, 2),
        rectangle=True,
        fields={"reward": -3, "color": "tan"},
    )
    assert added(text) == "areas:\n  - {at: [1, 1], size: [2, 2], color: tan, reward: -3}\n"


def test_area_beside_one_like_it_makes_that_larger() -> None:
    session = Session(EMPTY)
    for cell in ((1, 1), (2, 1)):
        text = paint(session, "area", cell, fields={"color": "tan"})
    assert added(text) == "areas:\n  - {at: [1, 1], size: [2, 1], color: tan}\n"
    text = paint(session, "area", (3, 1), fields={"color": "red"})
    assert "  - {at: [3, 1], color: red}\n" in text


def test_area_takes_the_place_of_one_with_the_same_properties() -> None:
    session = Session(EMPTY + "areas:\n  - {at: [1, 1], color: tan}\n  - {at: [2, 1], skid: 0.5}\n")
    text = paint(session, "area", (1, 1), (2, 1), fields={"color": "red"})
    assert added(text) == (
        "areas:\n  - {at: [2, 1], skid: 0.5}\n  - {at: [1, 1], size: [2, 1], color: red}\n"
    )


def test_area_does_not_grow_below_another_one() -> None:
    areas = "areas:\n  - {at: [1, 1], color: tan}\n  - {at: [2, 1], size: [2, 1], color: red}\n"
    text = paint(Session(EMPTY + areas), "area", (2, 1), fields={"color": "tan"})
    assert added(text) == areas + "  - {at: [2, 1], color: tan}\n"


def test_area_without_properties_is_refused() -> None:
    error = refused(Session(EMPTY), "paint", brush="area", cells=[[1, 1]])
    assert error == "an area needs a colour, a reward, or another property"


def test_erased_cells_leave_the_label_with_one_part_of_an_area() -> None:
    session = Session(EMPTY + "areas:\n  - {at: [0, 1], size: [3, 1], skid: 0.5, label: ice}\n")
    assert added(paint(session, "erase", (1, 1))) == (
        "areas:\n  - {at: [0, 1], skid: 0.5, label: ice}\n  - {at: [2, 1], skid: 0.5}\n"
    )


# -- the eraser ----------------------------------------------------------------------------


def test_erased_place_of_an_item_leaves_its_others() -> None:
    items = "items:\n  - {name: key, one_of: [[1, 1], [2, 1], [3, 1]]}\n"
    session = Session(EMPTY + items)
    assert "one_of: [[1, 1], [3, 1]]}" in paint(session, "erase", (2, 1))
    assert added(paint(session, "erase", (3, 1))) == "items:\n  - {name: key, at: [1, 1]}\n"
    assert paint(session, "erase", (1, 1)) == EMPTY


@pytest.mark.parametrize(
    "thing",
    [
        "switches:\n  - {name: lever, at: [1, 1]}\n",
        "warps:\n  - {at: [1, 1], to: start}\n",
        "warps:\n  - {at: [2, 2], to: [1, 1]}\n",
        "movers:\n  - {path: [[0, 1], [1, 1]], back: true}\n",
        "movers:\n  - {within: {at: [0, 1], size: [2, 2]}}\n",
    ],
    ids=["switch", "warp", "target of a warp", "path", "wanderer"],
)
def test_thing_in_the_cell_is_erased(thing: str) -> None:
    assert paint(Session(EMPTY + thing), "erase", (1, 1)) == EMPTY


# -- filling -------------------------------------------------------------------------------

ROOM = EMPTY + "walls:\n  - {at: [1, 0], side: E, length: 3}\n"


def test_fill_stops_at_walls_and_at_what_is_different() -> None:
    session = Session(ROOM + "puddles:\n  - {at: [0, 1], size: large}\n  - {at: [1, 1]}\n")
    done(session, "fill", brush="small", at=[0, 0])
    assert session.level is not None
    assert {puddle.at for puddle in session.level.puddles if puddle.size == "small"} == {
        (0, 0), (1, 0), (1, 1)
    }  # fmt: skip


@pytest.mark.parametrize("brush", ["blocked", "erase"])
def test_fill_leaves_starts_and_exits(brush: str) -> None:
    session = Session(ROOM)
    done(session, "fill", brush=brush, at=[0, 0])
    assert session.level is not None
    assert (session.level.starts, session.level.exits) == (((0, 0),), ((3, 2),))


def test_what_a_fill_paints_is_told_before() -> None:
    session = Session(ROOM)
    told = send(session, "filled", brush="large", at=[3, 0])["cells"]
    done(session, "fill", brush="large", at=[3, 0])
    assert session.level is not None
    assert {*told} == {puddle.at for puddle in session.level.puddles}
    assert "off the grid" in refused(session, "filled", brush="large", at=[9, 9])


# -- drawings ------------------------------------------------------------------------------


def test_drawing_shows_what_is_painted() -> None:
    session = Session(DRAWN)
    paint(session, "large", (0, 1))
    paint(session, "blocked", (2, 0))
    assert rows(paint(session, "small", (1, 1))) == ["| S   k  ###|", "| O   o   E |"]


def test_only_doors_of_a_drawing_go_beside_blocked_cells() -> None:
    rows = [
        "+---+---+---+",
        "|       |   |",
        "+-/-+   +---+",
        "| S   k   E |",
        "+   +   +   +",
        "|   |       |",
        "+---+---+---+",
    ]
    lines = "".join(f"  {row}\n" for row in rows)
    door = "doors:\n  - {at: [0, 0], side: S, needs: key}\n"
    session = Session(f"version: 1\nmap: |\n{lines}legend:\n  k: {{item: key}}\n{door}")
    text = paint(session, "blocked", (0, 0), (2, 0), (0, 2), (2, 2))
    assert "doors" not in text
    assert drawn(session) == [
        "+---+---+---+",
        "|###    |###|",
        "+   +   +---+",
        "| S   k   E |",
        "+   +   +   +",
        "|###|    ###|",
        "+---+---+---+",
    ]


def test_character_that_is_no_longer_drawn_leaves_the_legend() -> None:
    session = Session(DRAWN.replace("k     |", "k /   |") + DOOR)
    text = paint(session, "erase", (1, 0))
    assert "legend:\n  g: {color: tan}\n" in text
    assert "doors" not in text


def test_drawn_start_moves_to_the_cell() -> None:
    assert rows(paint(Session(DRAWN), "start", (0, 1))) == ["|     k     |", "| S   g   E |"]


def test_start_of_a_drawing_hides_no_puddle() -> None:
    error = refused(Session(DRAWN), "paint", brush="small", cells=[[0, 0]])
    assert error == "a drawing shows one thing in a cell: move the start or exit first"


def test_exits_by_lot_of_a_drawn_level_become_a_drawn_one() -> None:
    session = Session(DRAWN.replace("E |", "  |") + "exit_one_of: [[2, 0], [2, 1]]\n")
    text = paint(session, "erase", (2, 0))
    assert rows(text) == ["| S   k     |", "| o   g   E |"]
    assert "exit_one_of" not in text


# -- things: items, switches, warps and movers ---------------------------------------------


PLAIN = """\
version: 1
size: [5, 4]  # a hall
max_steps: 50  # few
"""

WITH_KEY = """\
version: 1
map: |
  +---+---+---+---+
  | S   k       E |
  +---+---+---+---+
legend:
  k: {item: key}
"""


def add(session: Session, brush: str, *cells: list[int], **fields: Any) -> str:
    """Paint things with some fields."""
    return done(session, "paint", brush=brush, cells=cells, fields=fields)


def walk(session: Session, *cells: list[int], **more: Any) -> str:
    """Draw a mover, and return its line."""
    text = done(session, "path", cells=cells, **more)
    return text[text.index("movers:") :].split("\n")[1]


def test_item_is_a_key_with_a_name_of_its_own() -> None:
    session = Session(PLAIN)
    assert add(session, "item", [1, 1]) == PLAIN.replace(
        "max_steps", "items:\n  - {name: key, at: [1, 1]}\nmax_steps"
    )
    assert "  - {name: key-2, at: [2, 1], shape: key}\n" in add(session, "item", [2, 1])


def test_items_of_a_shape_are_named_after_it() -> None:
    text = add(Session(PLAIN), "item", [1, 1], [2, 1], shape="coin", reward=2)
    assert "  - {name: coin, at: [1, 1], reward: 2}\n" in text
    assert "  - {name: coin-2, at: [2, 1], reward: 2, shape: coin}\n" in text


@pytest.mark.slow
def test_item_with_a_name_has_the_shape_that_is_wanted() -> None:
    text = add(Session(PLAIN), "item", [1, 1], name="treasure", shape="box", color="gold")
    assert "  - {name: treasure, at: [1, 1], shape: box, color: gold}\n" in text


def test_names_are_unlike_those_of_switches_movers_and_drawn_things() -> None:
    session = Session(PLAIN + "switches:\n  - {name: key, at: [2, 2]}\n")
    assert "{name: key-2, at: [1, 1], shape: key}" in add(session, "item", [1, 1])
    assert "{name: key-2, at: [2, 0], shape: key}" in add(Session(WITH_KEY), "item", [2, 0])


def test_cells_that_have_a_thing_are_left_out() -> None:
    session = Session(PLAIN)
    add(session, "item", [1, 1])
    text = add(session, "switch", [1, 1], [2, 1])
    assert "switches:\n  - {name: switch, at: [2, 1]}\n" in text
    message = refused(session, "paint", brush="switch", cells=[[1, 1]])
    assert message == "[1, 1] has an item, a switch or a target already: a cell holds one"


def test_thing_is_refused_where_it_cannot_lie() -> None:
    assert "on an exit" in refused(Session(PLAIN), "paint", brush="item", cells=[[4, 3]])
    assert "off the grid" in refused(Session(PLAIN), "paint", brush="item", cells=[[9, 9]])


@pytest.mark.parametrize("fields", [{"colour": "red"}, {"name": ["a"]}, {"shape": {}}, {"at": 3}])
def test_wrong_fields_are_refused(fields: dict[str, Any]) -> None:
    session = Session(PLAIN)
    if "at" in fields:
        # Where it is painted is where it lies.
        assert "at: [1, 1]" in add(session, "item", [1, 1], **fields)
    else:
        assert refused(session, "paint", brush="item", cells=[[1, 1]], fields=fields)


def test_thing_stands_beside_a_drawing() -> None:
    text = add(Session(WITH_KEY), "switch", [2, 0])
    assert text == WITH_KEY + "switches:\n  - {name: switch, at: [2, 0]}\n"


def test_warp_is_added_or_led_elsewhere() -> None:
    session = Session(PLAIN)
    assert "warps:\n  - {at: [1, 1], to: [3, 3]}\n" in done(session, "warp", at=[1, 1], to=[3, 3])
    assert "warps:\n  - {at: [1, 1], to: [2, 0]}\n" in done(session, "warp", at=[1, 1], to=[2, 0])
    assert refused(session, "warp", at=[4, 3], to=[1, 0])


def test_to_meet_the_first_guard_costs_more_than_any_way() -> None:
    session = Session(PLAIN)
    assert session.level is not None
    before = brl.solve(session.level).expected_return
    done(session, "path", cells=[[1, 1], [2, 1]])
    assert brl.solve(session.level).expected_return <= before
    assert session.level.hit.reward < before
    hit = "hit: {reward: -5}"
    text = done(Session(f"{PLAIN}{hit}\n"), "path", cells=[[1, 1], [2, 1]])
    assert hit in text, "a level's own reward was changed"


def test_what_goes_with_something_erased_is_told() -> None:
    session = Session(
        f"{PLAIN}items:\n  - {{name: key, at: [1, 1]}}\n"
        "doors:\n  - {at: [2, 2], side: E, needs: key}\n"
    )
    state = send(session, "paint", brush="erase", cells=[[1, 1]])["state"]
    assert state["lost"] == "a door"
    assert session.level is not None
    assert not session.level.doors
    assert send(session, "undo")["state"]["lost"] == ""


def test_path_leads_there_and_back() -> None:
    assert walk(Session(PLAIN), [1, 1], [2, 1], [2, 2]) == (
        "  - {path: [[1, 1], [2, 1], [2, 2]], back: true}"
    )


def test_closed_path_is_a_loop() -> None:
    ring = [[1, 1], [2, 1], [2, 2], [1, 2]]
    shown = "  - {path: [[1, 1], [2, 1], [2, 2], [1, 2]]}"
    assert walk(Session(PLAIN), *ring) == shown
    assert walk(Session(PLAIN), *ring, [1, 1]) == shown


def test_cells_that_a_fast_pointer_leaves_out_are_filled_in() -> None:
    assert walk(Session(PLAIN), [3, 1], [1, 1], [1, 3]) == (
        "  - {path: [[3, 1], [2, 1], [1, 1], [1, 2], [1, 3]], back: true}"
    )
    assert "no neighbour" in refused(Session(PLAIN), "path", cells=[[1, 1], [2, 2]])


def test_path_through_a_wall_is_refused() -> None:
    session = Session(PLAIN + "walls:\n  - {at: [1, 1], side: E}\n")
    assert "cut off" in refused(session, "path", cells=[[1, 1], [2, 1]])


def test_rectangle_is_that_of_a_wanderer() -> None:
    line = walk(Session(PLAIN), [3, 1], [1, 2], rectangle=True)
    assert line == "  - {within: {at: [1, 1], size: [3, 2]}}"


BOXES = """\
version: 1
map: |
  +---+---+---+---+
  | S   $   .     |
  +   +   +   +   +
  | o           . |
  +---+---+---+---+
"""


def test_boxes_and_targets_are_drawn_where_there_is_room() -> None:
    session = Session(BOXES)
    assert "| S   $   *     |" in paint(session, "box", (2, 0))
    assert "| S   *   *     |" in paint(session, "target", (1, 0))
    assert "| S   *   *   $ |" in paint(session, "box", (3, 0))
    assert "boxes:\n  - {at: [0, 1]}" in paint(session, "box", (0, 1))
    message = refused(session, "paint", brush="box", cells=[[1, 0]])
    assert message == "[1, 0] has a box already: a cell holds one"


def test_boxes_and_targets_without_a_drawing_are_entries() -> None:
    session = Session(EMPTY)
    assert added(paint(session, "box", (1, 1))) == "boxes:\n  - {at: [1, 1]}\n"
    text = paint(session, "target", (2, 1), fields={"name": "pad"})
    assert text.endswith("targets:\n  - {at: [2, 1], name: pad}\n")


def test_boxes_on_targets_move_and_go_alone() -> None:
    session = Session(BOXES)
    places = {"route": ["map", 1, 0], "from_": [1, 0], "to": [2, 0]}
    assert "| S       *     |" in done(session, "move", **places)
    text = done(session, "move", route=["map", 2, 0], from_=[2, 0], to=[3, 1])
    assert "| S       .     |" in text
    assert "| o           * |" in text
