"""What holds whatever is drawn, in whatever order, in whatever level."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import product
from random import Random
from typing import Any

import pytest
from hypothesis import assume, example, given, note, settings
from hypothesis import strategies as st
from support.gestures import random_gesture
from support.handwriting import Scribe
from support.things import thing_worlds
from support.worlds import LEGEND, drawings, worlds

import babyrobot_levels as brl
from babyrobot_levels.extensions.editor.changes.draft import RefusedError
from babyrobot_levels.extensions.editor.gestures import gesture_of
from babyrobot_levels.extensions.editor.places import places_of, side_of
from babyrobot_levels.extensions.editor.protocol import answer
from babyrobot_levels.extensions.editor.session import Session
from babyrobot_levels.language.drawing import compose
from babyrobot_levels.library.level import loads
from babyrobot_levels.library.search_path import gallery_folder, yaml_files
from babyrobot_levels.text.document import comments
from babyrobot_levels.text.emitter import emit
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile

Thing = tuple[Any, ...]
"""A kind, and the cell or the side at which one stands."""

GALLERY = [path for path in yaml_files(gallery_folder()) if "suites" not in path.parts]

drawn_worlds = drawings(5).map(
    lambda drawing: {"version": 1, "map": compose(drawing), "legend": LEGEND}
)


few = settings(max_examples=10)
"""For laws of many gestures in a row."""


def texts() -> st.SearchStrategy[str]:
    """Levels with all that the language has, as texts."""
    walled = st.integers(0, 10**6).map(walled_world)
    anything = worlds(6) | thing_worlds() | drawn_worlds | walled
    return anything.map(emit).filter(is_valid) | st.sampled_from(GALLERY).map(
        lambda path: path.read_text("utf-8")
    )


def walled_world(seed: int) -> dict[str, Any]:
    """Return a level with long walls, one on each line, and an item that may open doors."""
    rng = Random(seed)
    lines = [{"at": [0, line], "side": "S", "length": 6} for line in range(5)]
    lines += [{"at": [line, 0], "side": "E", "length": 6} for line in range(5)]
    items = [{"name": "key", "at": [rng.randrange(1, 5), rng.randrange(5)]}]
    return {"version": 1, "size": [6, 6], "walls": rng.sample(lines, 4), "items": items}


def is_valid(text: str) -> bool:
    try:
        loads(text)
    except LevelError:
        return False
    return True


def draw_on(session: Session, message: dict[str, Any]) -> str | None:
    """Send a gesture; return the sentence by which it is refused, if it is."""
    reply = answer(session, {"id": 1, "revision": session.revision, **message})
    error: str | None = reply.get("error")
    return error


def places_in(session: Session) -> list[dict[str, Any]]:
    """Return what the editor knows of what stands where."""
    assert session.level is not None
    assert session.document is not None
    return places_of(session.level, session.document)


def standing(places: list[dict[str, Any]]) -> Counter[Thing]:
    """Return how often what stands where."""
    return Counter(
        (place["kind"], *where) for place in places for where in (*place["cells"], *place["sides"])
    )


def may_change(message: dict[str, Any], size: tuple[int, int]) -> Callable[[Thing], bool]:
    """Return what tells whether a gesture may change what stands somewhere.

    `size` is that of the region that is stamped.
    """
    match message["do"]:
        case "walls":
            (x, y), side, along = message["at"], message["side"], range(message["length"])
            run = {side_of(*((x + i, y) if side in "NS" else (x, y + i)), side) for i in along}
            return lambda thing: thing[1:] in run
        case "paint":
            cells = {*map(tuple, message["cells"])}
            if message["rectangle"]:
                (x1, y1), (x2, y2) = message["cells"][0], message["cells"][-1]
                cells = {*product(range(min(x1, x2), max(x1, x2) + 1),
                                  range(min(y1, y2), max(y1, y2) + 1))}  # fmt: skip
            # With what they lead to, or need, or pass, these go as a whole.
            whole = {"door", "mover", "warp", message["brush"]}
            return lambda thing: thing[1:] in cells or thing[0] in whole
        case "fill":
            return lambda thing: thing[0] not in ("start", "exit", "wall", "opening")
        case "stamp":
            (x, y), (columns, rows) = message["at"], size
            whole = {"door", "mover", "warp"}
            # The sides before it are those of the cells to the west and north.
            return lambda thing: (
                thing[0] in whole
                or (
                    x - (len(thing) > 3) <= thing[1] < x + columns
                    and y - (len(thing) > 3) <= thing[2] < y + rows
                )
            )
        case "resolve":
            return lambda thing: thing[0] in ("wall", "opening")
        case _:
            return lambda thing: False


def resized(things: Counter[Thing], message: dict[str, Any]) -> Counter[Thing]:
    """Return what is left in cells of a level that gets another size, but for what goes along."""
    (width, height), (dx, dy) = message["size"], message["shift"]
    moved = Counter({(kind, x + dx, y + dy, *side): n for (kind, x, y, *side), n in things.items()})
    return Counter({thing: n for thing, n in moved.items()
                    if thing[1] in range(width) and thing[2] in range(height)})  # fmt: skip


def in_cells(things: Counter[Thing]) -> Counter[Thing]:
    """Leave out what has rules of its own for what is cut off, and the exit in the corner."""
    rules = {"warp", "mover", "exit"}
    return Counter({t: n for t, n in things.items() if len(t) == 3 and t[0] not in rules})


@pytest.mark.usefixtures("put_off")
@given(texts(), st.integers(0, 10**6))
@settings(max_examples=settings().max_examples // 3)
def test_a_gesture_changes_nothing_elsewhere(text: str, seed: int) -> None:
    session, rng = Session(text), Random(seed)
    for _ in range(8):
        before, text, message = (
            standing(places_in(session)),
            session.text,
            random_gesture(rng, session),
        )
        note(f"{text}\n{message}")
        if draw_on(session, message) is not None:
            assert session.text == text
            continue
        assert session.is_valid
        after = standing(places_in(session))
        note(session.text)
        if message["do"] == "resize":
            expected, found = in_cells(resized(before, message)), in_cells(after)
            if not any(kind == "start" for kind, *_ in expected):
                # The last one comes along.
                assert sum(found.pop(each) for each in [*found] if each[0] == "start") == 1
            assert found == expected
            continue
        changed, may = (
            (before - after) + (after - before),
            may_change(message, session.region.size if session.region else (0, 0)),
        )
        assert [thing for thing in changed if not may(thing)] == []


OWN_WARP = "version: 1\nsize: [3, 1]\nwarps:\n  - {at: [1, 0], to: [1, 0], when: leave}\n"


@pytest.mark.usefixtures("put_off")
@example(OWN_WARP, 5)
@given(texts(), st.integers(0, 10**6))
@settings(max_examples=settings().max_examples // 5)
def test_only_what_is_moved_moves(text: str, seed: int) -> None:
    session, rng = Session(text), Random(seed)
    for _ in range(3):
        before, text = places_in(session), session.text
        place = rng.choice(before)
        taken = rng.choice([*place["cells"], *(side[:2] for side in place["sides"])])
        dx, dy = rng.choice([(1, 0), (0, 1), (-1, 0), (0, -2)])
        to = [taken[0] + dx, taken[1] + dy]
        message = {"do": "move", "route": place["route"], "from": taken, "to": to}
        note(f"{text}\n{message}")
        if min(to) < 0 or draw_on(session, message) is not None:
            assert session.text == text
            continue
        if place["kind"] == "warp" or "one_of" in place["fields"]:
            # Of a warp to its own cell, one end moves.
            cells = list(place["cells"])
            cells[cells.index(taken)] = to
        else:
            cells = [[x + dx, y + dy] for x, y in place["cells"]]
        sides = [side_of(x + dx, y + dy, side) for x, y, side in place["sides"]]
        moved = {**place, "cells": cells, "sides": sides}
        others = [each for each in before if each is not place]
        assert inner(standing(places_in(session))) == inner(standing([*others, moved]))


def inner(things: Counter[Thing]) -> Counter[Thing]:
    """Leave out sides of the outer wall, where N and W have names of their own."""
    return Counter({key: count for key, count in things.items() if key[-1] not in ("N", "W")})


@pytest.mark.usefixtures("put_off")
@given(texts(), st.integers(0, 10**6))
@settings(max_examples=settings().max_examples // 5)
def test_only_what_is_removed_goes(text: str, seed: int) -> None:
    session, rng = Session(text), Random(seed)
    for _ in range(3):
        before, text = places_in(session), session.text
        place = rng.choice(before)
        message = {"do": "remove", "route": place["route"]}
        note(f"{text}\n{message}")
        if draw_on(session, message) is not None:
            assert session.text == text
            continue
        after = standing(places_in(session))
        left = standing([each for each in before if each is not place])
        if place["kind"] in ("item", "switch"):
            # Doors that needed it alone go, too.
            gone = left - after
            assert {key[0] for key in gone} <= {"door"}
            left -= gone
        assert after == left


@given(texts(), st.integers(0, 10**6))
@few
def test_undone_gestures_leave_the_first_text_and_redone_ones_the_last(
    text: str, seed: int
) -> None:
    session, rng = Session(text), Random(seed)
    for _ in range(10):
        assert session.level is not None
        with suppress(RefusedError):
            session.apply(gesture_of.validate_python(random_gesture(rng, session)))
    last, steps = session.text, 0
    while session.can_undo:
        session.undo()
        steps += 1
    assert session.text == text
    for _ in range(steps):
        session.redo()
    assert session.text == last
    assert not session.can_redo


@pytest.mark.sweep
@given(worlds(6) | drawn_worlds, st.integers(0, 10**6))
@few
def test_formatted_text_stays_formatted(world: dict[str, Any], seed: int) -> None:
    session, rng = Session(brl.format(emit(world))), Random(seed)
    for _ in range(30):
        assert session.level is not None
        before, message = session.text, random_gesture(rng, session)
        draw_on(session, message)
        note(f"{before}\n{message}\n{session.text}")
        assert brl.format(session.text) == session.text


@pytest.mark.sweep
@given(worlds(6) | thing_worlds(), st.integers(0, 10**6))
@settings(max_examples=4)
def test_comments_survive_fifty_gestures(world: dict[str, Any], seed: int) -> None:
    rng = Random(seed)
    text = Scribe(rng, 0.3).write(world)
    assume(is_valid(text))
    session = Session(text)
    written = comments_of(text)
    for _ in range(50):
        assert session.level is not None
        draw_on(session, random_gesture(rng, session))
    assert comments_of(session.text) >= written


ALL_KINDS = """\
version: 1
size: [4, 2]
start: [[0, 0], [0, 1]]
exit_one_of: [[3, 0], [3, 1]]
exit_needs: [key, lever]
walls: [{at: [0, 0], side: E, length: 2, pass: 0.5}]
doors: [{at: [2, 0], side: E, needs: key, unless: [lever]}]
items: [{name: key, one_of: [[1, 0], [2, 0]]}]
switches: [{name: lever, at: [2, 1]}]
movers: [{path: [[2, 0], [2, 1]], back: true}, {within: {at: [0, 0], size: [2, 1]}, start: [0, 0]}]
warps: [{at: [1, 1], to: [0, 1]}]
areas: [{at: [0, 0], size: [2, 1], skid: {probability: 0.5}}]
wind: {north: [0, 1, 0, 0]}
rewards: {exit: 5, step: -1}
theme: {colors: {robot: red}}
"""

DRAWN = """\
version: 1
map: |
  +---+---+---+---+
  | S   k /   : E |
  +---+---+---+---+
legend: {k: {item: key}}
doors: [{at: [1, 0], side: E, needs: key}]
walls: [{at: [2, 0], side: E, pass: 0.2}]
"""


@pytest.mark.sweep
@pytest.mark.usefixtures("put_off")
@pytest.mark.parametrize("text", [ALL_KINDS, DRAWN])
def test_gestures_at_any_route_are_done_or_refused_in_a_sentence(text: str) -> None:
    session = Session(text)
    assert session.document is not None
    moved = {"do": "move", "from": [0, 0], "to": [1, 0]}
    for route in routes(session.document.data):
        for change in ({"do": "remove"}, {"do": "set", "value": "x"}, moved):
            error = draw_on(session, change | {"route": route})
            assert error is None or (0 < len(error) < 500 and session.text == text)
            assert session.is_valid
            if error is None:
                session.undo()


def routes(value: Any) -> Iterator[list[str | int]]:
    """Yield the routes to all that is in plain data, and a last one to what is not there."""
    inner = value.items() if isinstance(value, dict) else enumerate(value)
    for key, each in inner:
        yield [key]
        yield from (
            [key, *rest] for rest in (routes(each) if isinstance(each, dict | list) else [[0]])
        )
    yield ["at"]


def comments_of(text: str) -> Counter[str]:
    """Return how often a text has which comment."""
    return Counter(each.text for each in comments(read(SourceFile("", text))))
