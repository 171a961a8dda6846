"""What holds whatever is drawn, in whatever order, in whatever level."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from random import Random
from typing import Any

import pytest
from hypothesis import assume, given, note, settings
from hypothesis import strategies as st
from support.edited import Message, Refused, expected, gesture
from support.handwriting import Scribe
from support.things import thing_worlds
from support.worlds import LEGEND, drawings, worlds

import babyrobot_levels as brl
from babyrobot_levels.editor.changes.draft import RefusedError
from babyrobot_levels.editor.gestures import gesture_of
from babyrobot_levels.editor.protocol import answer
from babyrobot_levels.editor.session import Session
from babyrobot_levels.language.drawing import compose
from babyrobot_levels.library.level import Level
from babyrobot_levels.library.reading import loads
from babyrobot_levels.library.search_path import gallery_folder, yaml_files
from babyrobot_levels.text.document import comments
from babyrobot_levels.text.emitter import emit
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile

GALLERY = [path for path in yaml_files(gallery_folder()) if "suites" not in path.parts]

drawn_worlds = drawings(5).map(
    lambda drawing: {"version": 1, "map": compose(drawing), "legend": LEGEND}
)


fewer = settings(max_examples=settings().max_examples // 3)
"""For the law whose oracle takes long."""

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


def draw_on(session: Session, message: Message) -> str | None:
    """Send a gesture; return the sentence by which it is refused, if it is."""
    reply = answer(session, {"id": 1, "revision": session.revision, **message})
    error: str | None = reply.get("error")
    return error


def digest(level: Level) -> str:
    return (level.with_maze_seed(7) if level.has_random_maze else level).digest


@fewer
@given(st.data())
def test_gesture_comes_to_the_same_as_the_change_in_sets_of_cells(data: st.DataObject) -> None:
    session, rng = Session(data.draw(texts())), Random(data.draw(st.integers(0, 10**6)))
    for _ in range(8):
        before, level = session.text, session.level
        assert level is not None
        message = gesture(rng, level)
        note(f"{before}\n{message}")
        error = draw_on(session, message)
        if error is not None:
            assert session.text == before
            with pytest.raises((Refused, LevelError)):
                expected(level, message)
            continue
        assert session.is_valid
        note(session.text)
        assert session.level is not None
        assert digest(session.level) == digest(expected(level, message))


@given(texts(), st.integers(0, 10**6))
@few
def test_undone_gestures_leave_the_first_text_and_redone_ones_the_last(
    text: str, seed: int
) -> None:
    session, rng = Session(text), Random(seed)
    for _ in range(10):
        assert session.level is not None
        with suppress(RefusedError):
            session.apply(gesture_of.validate_python(gesture(rng, session.level)))
    last, steps = session.text, 0
    while session.can_undo:
        session.undo()
        steps += 1
    assert session.text == text
    for _ in range(steps):
        session.redo()
    assert session.text == last
    assert not session.can_redo


@given(worlds(6) | drawn_worlds, st.integers(0, 10**6))
@few
def test_formatted_text_stays_formatted(world: dict[str, Any], seed: int) -> None:
    session, rng = Session(brl.format(emit(world))), Random(seed)
    for _ in range(30):
        assert session.level is not None
        before, message = session.text, gesture(rng, session.level)
        draw_on(session, message)
        note(f"{before}\n{message}\n{session.text}")
        assert brl.format(session.text) == session.text


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
        draw_on(session, gesture(rng, session.level))
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
