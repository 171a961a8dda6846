"""Regions that are copied, and stamped elsewhere, mirrored or not."""

from __future__ import annotations

from collections import Counter
from typing import Any

import pytest
from hypothesis import given, note, settings
from hypothesis import strategies as st
from support.gestures import done, drawn, refused, send
from support.things import thing_worlds
from support.worlds import worlds

from babyrobot_levels.extensions.editor.places import places_of
from babyrobot_levels.extensions.editor.session import Session
from babyrobot_levels.text.emitter import emit

pytestmark = pytest.mark.usefixtures("put_off")

ROOM = """\
version: 1
size: [6, 2]
start: [5, 1]
exit: [5, 0]
walls:
  - {at: [1, 0], side: E}
  - {at: [0, 0], side: S, pass: 0.5}
doors:
  - {at: [1, 1], side: E, needs: key}
items:
  - {name: key, at: [0, 0]}
puddles:
  - {at: [1, 0], size: large}
"""


def copied(session: Session, one: tuple[int, int], other: tuple[int, int]) -> None:
    """Copy a region."""
    reply = send(session, "lift", cells=[[*one], [*other]])
    assert "error" not in reply, reply


def standing(session: Session) -> Counter[tuple[Any, ...]]:
    """Return how often what stands where, but for starts and exits."""
    assert session.level is not None
    assert session.document is not None
    return Counter(
        (place["kind"], *where)
        for place in places_of(session.level, session.document)
        if place["kind"] not in ("start", "exit")
        for where in (*place["cells"], *place["sides"])
    )


def test_a_wanderer_is_stamped_with_its_rectangle() -> None:
    wanderer = "movers:\n  - {within: {at: [0, 0], size: [2, 1]}}\n"
    session = Session(f"version: 1\nsize: [6, 2]\nstart: [5, 1]\nexit: [5, 0]\n{wanderer}")
    copied(session, (0, 0), (1, 0))
    assert "{within: {at: [2, 0], size: [2, 1]}}" in done(session, "stamp", at=[2, 0])


def test_a_room_is_stamped_with_walls_and_a_door_that_its_own_key_opens() -> None:
    session = Session(ROOM)
    copied(session, (0, 0), (1, 1))
    done(session, "stamp", at=[2, 0])
    level = session.level
    assert level is not None
    assert [(item.name, item.at, item.shape) for item in level.items] == [
        ("key", (0, 0), None),
        ("key-2", (2, 0), "key"),
    ]
    assert [(door.at, door.side, door.keys) for door in level.doors] == [
        ((1, 1), "E", ("key",)),
        ((3, 1), "E", ("key-2",)),
    ]
    assert (level.walls[-1].at, level.walls[-1].side, level.walls[-1].pass_) == ((2, 0), "S", 0.5)
    assert (level.puddles[-1].at, level.puddles[-1].size) == ((3, 0), "large")


def test_a_stamp_is_one_step_to_undo() -> None:
    session = Session(ROOM)
    copied(session, (0, 0), (1, 1))
    done(session, "stamp", at=[2, 0])
    assert send(session, "undo")["step"] == "stamp"
    assert session.text == ROOM


def test_a_mirrored_room_has_its_door_on_the_other_side() -> None:
    session = Session(ROOM)
    copied(session, (0, 0), (1, 1))
    done(session, "stamp", at=[3, 0], mirror="x")
    level = session.level
    assert level is not None
    assert (level.doors[1].at, level.doors[1].side) == ((2, 1), "E")
    assert (level.items[1].at, level.puddles[1].at) == ((4, 0), (3, 0))


def test_drawings_are_stamped_as_drawings() -> None:
    session = Session("""\
version: 1
map: |
  +---+---+---+---+---+
  | S   o |###      k |
  +   +---+   +   +   +
  | o : O           E |
  +---+---+---+---+---+
legend:
  k: {item: key}
""")
    copied(session, (0, 0), (1, 1))
    done(session, "stamp", at=[2, 0], mirror="x")
    assert drawn(session) == [
        "+---+---+---+---+---+",
        "| S   o | o       k |",
        "+   +---+---+   +   +",
        "| o : O   O : o   E |",
        "+---+---+---+---+---+",
    ]
    copied(session, (4, 0), (4, 0))
    done(session, "stamp", at=[3, 0])
    assert session.level is not None
    assert {(item.name, item.at) for item in session.level.items} == {
        ("key", (4, 0)),
        ("key-2", (3, 0)),
    }


def test_what_is_not_copied_is_told_and_ends_stay() -> None:
    session = Session(ROOM + "warps:\n  - {at: [1, 1], to: [3, 1]}\n")
    copied(session, (0, 0), (1, 1))
    assert send(session, "stamp", at=[2, 0])["state"]["left"] == "a warp"
    copied(session, (4, 0), (5, 1))
    state = send(session, "stamp", at=[0, 0])["state"]
    assert state["left"] == "a start and an exit"
    assert session.level is not None
    assert session.level.starts == ((5, 1),)
    assert session.level.exits == ((5, 0),)


def test_a_door_whose_key_is_gone_is_left_out() -> None:
    session = Session(ROOM)
    copied(session, (1, 1), (1, 1))
    send(session, "paint", brush="erase", cells=[[0, 0]])
    assert refused(session, "stamp", at=[2, 1]) == "nothing of what is copied can stand there"


def test_nothing_copied_and_cells_off_the_grid_are_refused() -> None:
    session = Session(ROOM)
    assert refused(session, "stamp", at=[0, 0]).startswith("nothing is copied yet")
    assert "off the grid" in send(session, "lift", cells=[[0, 0], [6, 0]])["error"]
    assert "not known" in send(session, "lift", cells=[])["error"]
    copied(session, (0, 0), (1, 1))
    assert refused(session, "stamp", at=[7, 7]) == "this is off the grid"


@pytest.mark.slow
@given(worlds(5) | thing_worlds(), st.sampled_from(["x", "y", "xy"]))
@settings(max_examples=settings().max_examples // 3)
def test_mirrored_twice_all_stands_where_it_stood(world: dict[str, Any], mirror: str) -> None:
    text = emit(world)
    note(text)
    session = Session(text)
    if session.level is None:
        return
    width, height = session.level.size
    corner = (width - 1, height - 1)
    plain: list[Counter[tuple[Any, ...]]] = []
    mirrored: list[Counter[tuple[Any, ...]]] = []
    for turns, found in (([""], plain), ([mirror, mirror], mirrored)):
        session = Session(text)
        for turn in turns:
            copied(session, (0, 0), corner)
            # The ends stay, so they have cells of their own.
            ends = f"start: [{width}, 0]\nexit: [{width}, 1]\n"
            session.type(f"version: 1\nsize: [{width + 1}, {max(2, height)}]\n{ends}")
            send(session, "stamp", at=[0, 0], mirror=turn)
        found.append(standing(session))
    assert plain == mirrored
