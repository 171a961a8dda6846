"""Items, switches, warps and movers that are added by drawing."""

from __future__ import annotations

from typing import Any

import pytest
from support.gestures import done, refused

from babyrobot_levels.editor.session import Session

pytestmark = pytest.mark.usefixtures("put_off")

PLAIN = """\
version: 1
size: [5, 4]  # a hall
max_steps: 50  # few
"""

DRAWN = """\
version: 1
map: |
  +---+---+---+---+
  | S   k       E |
  +---+---+---+---+
legend:
  k: {item: key}
"""


def paint(session: Session, brush: str, *cells: list[int], **fields: Any) -> str:
    return done(session, "paint", brush=brush, cells=cells, fields=fields)


def walk(session: Session, *cells: list[int], **more: Any) -> str:
    """Draw a mover, and return its line."""
    text = done(session, "path", cells=cells, **more)
    return text[text.index("movers:") :].split("\n")[1]


def test_item_is_a_key_with_a_name_of_its_own() -> None:
    session = Session(PLAIN)
    assert paint(session, "item", [1, 1]) == PLAIN.replace(
        "max_steps", "items:\n  - {name: key, at: [1, 1]}\nmax_steps"
    )
    assert "  - {name: key-2, at: [2, 1], shape: key}\n" in paint(session, "item", [2, 1])


def test_items_of_a_shape_are_named_after_it() -> None:
    text = paint(Session(PLAIN), "item", [1, 1], [2, 1], shape="coin", reward=2)
    assert "  - {name: coin, at: [1, 1], reward: 2}\n" in text
    assert "  - {name: coin-2, at: [2, 1], reward: 2, shape: coin}\n" in text


def test_item_with_a_name_has_the_shape_that_is_wanted() -> None:
    text = paint(Session(PLAIN), "item", [1, 1], name="treasure", shape="box", color="gold")
    assert "  - {name: treasure, at: [1, 1], shape: box, color: gold}\n" in text


def test_names_are_unlike_those_of_switches_movers_and_drawn_things() -> None:
    session = Session(PLAIN + "switches:\n  - {name: key, at: [2, 2]}\n")
    assert "{name: key-2, at: [1, 1], shape: key}" in paint(session, "item", [1, 1])
    assert "{name: key-2, at: [2, 0], shape: key}" in paint(Session(DRAWN), "item", [2, 0])


def test_cells_that_have_a_thing_are_left_out() -> None:
    session = Session(PLAIN)
    paint(session, "item", [1, 1])
    text = paint(session, "switch", [1, 1], [2, 1])
    assert "switches:\n  - {name: switch, at: [2, 1]}\n" in text
    message = refused(session, "paint", brush="switch", cells=[[1, 1]])
    assert message == "[1, 1] has an item or a switch already: a cell holds one"


def test_thing_is_refused_where_it_cannot_lie() -> None:
    assert "on an exit" in refused(Session(PLAIN), "paint", brush="item", cells=[[4, 3]])
    assert "off the grid" in refused(Session(PLAIN), "paint", brush="item", cells=[[9, 9]])


@pytest.mark.parametrize("fields", [{"colour": "red"}, {"name": ["a"]}, {"shape": {}}, {"at": 3}])
def test_wrong_fields_are_refused(fields: dict[str, Any]) -> None:
    session = Session(PLAIN)
    if "at" in fields:
        # Where it is painted is where it lies.
        assert "at: [1, 1]" in paint(session, "item", [1, 1], **fields)
    else:
        assert refused(session, "paint", brush="item", cells=[[1, 1]], fields=fields)


def test_thing_stands_beside_a_drawing() -> None:
    text = paint(Session(DRAWN), "switch", [2, 0])
    assert text == DRAWN + "switches:\n  - {name: switch, at: [2, 0]}\n"


def test_warp_is_added_or_led_elsewhere() -> None:
    session = Session(PLAIN)
    assert "warps:\n  - {at: [1, 1], to: [3, 3]}\n" in done(session, "warp", at=[1, 1], to=[3, 3])
    assert "warps:\n  - {at: [1, 1], to: [2, 0]}\n" in done(session, "warp", at=[1, 1], to=[2, 0])
    assert refused(session, "warp", at=[4, 3], to=[1, 0])


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
