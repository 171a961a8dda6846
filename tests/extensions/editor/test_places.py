"""Where things stand, and which lines of the text say so."""

from __future__ import annotations

from functools import cache
from typing import Any

import pytest
import yaml
from support.gestures import places, send

from babyrobot_levels.extensions.editor.places import places_of
from babyrobot_levels.extensions.editor.session import Session
from babyrobot_levels.language.cells import Opening, sides_of
from babyrobot_levels.library.catalogue import level_path
from babyrobot_levels.library.level import Level

pytestmark = pytest.mark.usefixtures("put_off")

NAMES = ("drawbridge", "final-maze", "garden", "three-gems", "four-corners", "teleport-pads",
         "two-doors", "large-corridor", "bat-cave")  # fmt: skip
"""Levels that have, together, whatever one of the gallery has."""

# The loops by which a large level is solved are compiled first.
SLOW = pytest.param("large-corridor", marks=pytest.mark.slow)
levels = pytest.mark.parametrize("name", [SLOW if each in SLOW.values else each for each in NAMES])


@cache
def session_of(name: str) -> Session:
    """Return the same session each time."""
    return Session(level_path(f"gallery/{name}").read_text("utf-8"))


def found(session: Session) -> list[dict[str, Any]]:
    assert session.level is not None
    assert session.document is not None
    return places_of(session.level, session.document)


@pytest.mark.slow
@levels
def test_places_are_those_of_all_that_a_level_has(name: str) -> None:
    session = session_of(name)
    told = {
        (place["kind"], *where)
        for place in found(session)
        for where in (*place["cells"], *place["sides"])
    }
    assert session.level is not None
    assert told == standing(session.level)


def standing(level: Level) -> set[tuple[Any, ...]]:
    """Return the kind, and the cell or the side, of everything that stands somewhere."""
    cells: list[tuple[str, Any]] = [("start", cell) for cell in level.starts]
    cells += [("exit", cell) for cell in level.exits]
    cells += [("puddle", puddle.at) for puddle in level.puddles]
    cells += [("item", cell) for item in level.items for cell in item.places]
    cells += [("switch", switch.at) for switch in level.switches]
    cells += [("mover", cell) for mover in level.movers for cell in mover.phases]
    for warp in level.warps:
        cells += [("warp", warp.at)] + [("warp", warp.to)] * (warp.to != "start")
    for kind, areas in (("area", level.areas), ("blocked", level.blocked)):
        for area in areas:
            (x, y), (width, height) = area.at, area.size
            cells += [(kind, (x + i, y + j)) for i in range(width) for j in range(height)]
    sides: list[tuple[str, Opening]] = [("wall", wall) for wall in level.walls]
    sides += [("opening", opening) for opening in level.openings]
    sides += [("door", door) for door in level.doors]
    return {(kind, *cell) for kind, cell in cells} | {
        (kind, *named(x, y, each)) for kind, each in sides for x, y in sides_of(each)
    }


def named(x: int, y: int, opening: Opening) -> tuple[int, int, str]:
    if opening.side == "W" and x > 0:
        return x - 1, y, "E"
    return (x, y - 1, "S") if opening.side == "N" and y > 0 else (x, y, opening.side)


@levels
def test_lines_of_a_place_hold_its_entry(name: str) -> None:
    session = session_of(name)
    lines = session.text.split("\n")
    data = yaml.safe_load(session.text)
    for place in found(session):
        if not place["lines"]:
            assert place["route"][0] not in data
            continue
        first, last = place["lines"]
        text = "\n".join(lines[first - 1 : last])
        if "columns" in place:
            left, right = place["columns"]
            shown = [line[left - 1 : right] for line in lines[first - 1 : last]]
            assert set("".join(shown)) <= characters(session, place)
        else:
            value: Any = data
            for segment in place["route"]:
                value = value[segment]
            assert holds(yaml.safe_load(text), value)


def holds(data: Any, value: Any) -> bool:
    """Tell whether data are a value, or hold it somewhere."""
    inner = data.values() if isinstance(data, dict) else data if isinstance(data, list) else ()
    return data == value or any(holds(each, value) for each in inner)


def characters(session: Session, place: dict[str, Any]) -> set[str]:
    """Return the characters by which a drawing may show something."""
    assert session.level is not None
    if place["sides"]:
        return set("- +|:")
    if place["kind"] in ("start", "exit", "puddle", "blocked"):
        character = {"start": "S", "exit": "E", "blocked": "#", "small": "o", "large": "O"}
        return {" ", character[place["fields"].get("size", place["kind"])]}
    return {" ", *session.level.legend}


DRAWN = """\
version: 1
# The way in.
map: |
  +---+---+---+
  | S   k : o |
  +- -+   +-/-+
  |###  E   d |
  +---+---+---+
legend:
  k: {item: key}
  d: {color: red, skid: 0.5}
walls:
  - {at: [1, 0], side: E, pass: 0.2}
doors:
  - {at: [2, 0], side: S, needs: key}
"""


def test_drawn_places_are_named_by_their_cells_and_sides() -> None:
    session = Session(DRAWN)
    told = {
        place["kind"]: (place["route"], place["label"], place["lines"], place.get("columns"))
        for kind in ("start", "exit", "puddle", "blocked", "area", "item", "door")
        for place in places(session, kind)
    }
    assert told == {
        "start": (["map", 0, 0], "start", [5, 5], [4, 6]),
        "exit": (["map", 1, 1], "exit", [7, 7], [8, 10]),
        "puddle": (["map", 2, 0], "small puddle", [5, 5], [12, 14]),
        "blocked": (["map", 0, 1], "blocked", [7, 7], [4, 6]),
        "area": (["map", 2, 1], "area", [7, 7], [12, 14]),
        "item": (["map", 1, 0], "key", [5, 5], [8, 10]),
        "door": (["doors", 0], "door, needs key", [15, 15], None),
    }


def test_drawn_wall_with_an_entry_is_that_entry() -> None:
    walls = [(each["route"], each["sides"]) for each in places(Session(DRAWN), "wall")]
    assert walls == [(["map", 0, 0, "S"], [[0, 0, "S"]]), (["walls", 0], [[1, 0, "E"]])]


def test_fields_of_drawn_places_are_those_of_entries() -> None:
    session = Session(DRAWN)
    (item,), (area,) = places(session, "item"), places(session, "area")
    assert item["fields"] == {"at": [1, 0], "name": "key"}
    assert area["fields"] == {"at": [2, 1], "color": "red", "skid": {"probability": 0.5}}


def test_drawing_that_is_no_block_has_places_without_columns() -> None:
    text = 'version: 1\nmap: "+---+---+\\n| S   E |\\n+---+---+\\n"\n'
    (start,) = places(Session(text), "start")
    assert start["lines"] == [2, 2]
    assert "columns" not in start


def test_ends_that_are_left_out_have_no_lines() -> None:
    session = Session("version: 1\nsize: [4, 2]\n")
    (start,), (exit_,) = places(session, "start"), places(session, "exit")
    assert (start["cells"], start["lines"]) == ([[0, 0]], [])
    assert (exit_["cells"], exit_["lines"]) == ([[3, 1]], [])


def test_several_ends_are_places_of_their_own() -> None:
    text = "version: 1\nstart:\n  - [0, 0]\n  - [1, 0]  # here\nexit_one_of: [[2, 2], [0, 2]]\n"
    session = Session(text)
    starts, exits = places(session, "start"), places(session, "exit")
    assert [(each["route"], each["lines"]) for each in starts] == [
        (["start", 0], [3, 3]),
        (["start", 1], [4, 4]),
    ]
    assert [(each["route"], each["label"]) for each in exits] == [
        (["exit_one_of", 0], "possible exit"),
        (["exit_one_of", 1], "possible exit"),
    ]


def test_comment_below_an_entry_is_not_of_its_lines() -> None:
    text = "version: 1\nwalls:\n  - at: [0, 0]\n    side: E\n  # the other\n\nmax_steps: 9\n"
    (wall,) = places(Session(text), "wall")
    assert wall["lines"] == [3, 4]


def test_places_of_an_invalid_text_are_those_of_the_last_valid_one() -> None:
    session = Session("version: 1\nwalls:\n  - {at: [0, 0], side: E}\n")
    state = send(session, "text", text="version: 1\nwalls:\n  - {at: [0, 0], side: Q}\n")["state"]
    assert not state["is_valid"]
    assert [each["kind"] for each in state["places"]] == ["start", "exit", "wall"]


def test_text_that_was_never_valid_has_no_places() -> None:
    state = send(Session("version: 2\n"), "state")["state"]
    assert (state["places"], state["fields"]) == ([], {})


def test_rectangles_of_very_many_cells_have_two_corners(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("babyrobot_levels.extensions.editor.places.MAX_LISTED", 30)
    areas = "  - {at: [0, 0], size: [5, 5], color: red}\n" * 2
    first, last = places(Session(f"version: 1\nsize: [5, 5]\nareas:\n{areas}"), "area")
    assert len(first["cells"]) == 25
    assert last["cells"] == [[0, 0], [4, 4]]


def test_walls_of_a_maze_have_no_places() -> None:
    assert places(Session("version: 1\nsize: [9, 9]\nmaze: {seed: 1}\n"), "wall") == []


def test_drawn_walls_and_glass_say_how_often_they_let_pass() -> None:
    session = Session("version: 1\nmap: |\n  +---+---+---+\n  | S : E |   |\n  +---+---+---+\n")
    sides = {
        place["fields"]["at"][0]: place["fields"] for place in found(session) if place["sides"]
    }
    assert {x: fields["pass"] for x, fields in sides.items()} == {0: 0.5, 1: 0}
