"""What holds whatever is moved or removed, in whatever level."""

from __future__ import annotations

from collections import Counter
from random import Random
from typing import Any

import pytest
from hypothesis import assume, event, example, given, note, settings
from hypothesis import strategies as st
from support.things import thing_worlds
from support.worlds import LEGEND, drawings, worlds

from babyrobot_levels.editor.changes.draft import RefusedError
from babyrobot_levels.editor.gestures import gesture_of
from babyrobot_levels.editor.places import places_of
from babyrobot_levels.editor.session import Session
from babyrobot_levels.language.drawing import compose
from babyrobot_levels.text.emitter import emit

pytestmark = pytest.mark.usefixtures("put_off")

texts = (
    worlds(6)
    | thing_worlds()
    | drawings(5).map(lambda drawing: {"version": 1, "map": compose(drawing), "legend": LEGEND})
).map(emit)

Places = list[dict[str, Any]]


def found(session: Session) -> Places:
    assert session.level is not None
    assert session.document is not None
    return places_of(session.level, session.document)


def stands(places: Places) -> Counter[tuple[Any, ...]]:
    """Return how often what stands where."""
    return Counter(
        (place["kind"], *where) for place in places for where in (*place["cells"], *place["sides"])
    )


def is_done(session: Session, message: dict[str, Any]) -> bool:
    """Carry out a gesture, and tell whether it was not refused."""
    before = session.text
    note(f"{before}\n{message}")
    try:
        session.apply(gesture_of.validate_python(message))
    except RefusedError as error:
        event(f"{message['do']}: {error}"[:60])
        assert session.text == before
        return False
    event(f"{message['do']} {message['route'][0]}")
    note(session.text)
    return True


OWN_WARP = "version: 1\nsize: [3, 1]\nwarps:\n  - {at: [1, 0], to: [1, 0], when: leave}\n"


@example(OWN_WARP, 5)
@given(texts, st.integers(0, 10**6))
@settings(max_examples=settings().max_examples // 5)
def test_only_what_is_moved_moves(text: str, seed: int) -> None:
    session, rng = Session(text), Random(seed)
    assume(session.is_valid)
    for _ in range(3):
        before = found(session)
        place = rng.choice(before)
        wheres = [*place["cells"], *(side[:2] for side in place["sides"])]
        taken, (dx, dy) = rng.choice(wheres), rng.choice([(1, 0), (0, 1), (-1, 0), (0, -2)])
        to = [taken[0] + dx, taken[1] + dy]
        if min(to) < 0 or not is_done(
            session, {"do": "move", "route": place["route"], "from": taken, "to": to}
        ):
            continue
        is_one = place["kind"] == "warp" or "one_of" in place["fields"]
        moved = dict(place)
        if is_one:
            # Of a warp to its own cell, one end moves.
            cells = list(place["cells"])
            cells[cells.index(taken)] = to
            moved["cells"] = cells
        else:
            moved["cells"] = [[x + dx, y + dy] for x, y in place["cells"]]
        moved["sides"] = [named(x + dx, y + dy, side) for x, y, side in place["sides"]]
        others = [each for each in before if each is not place]
        assert inner(stands(found(session))) == inner(stands([*others, moved]))


def named(x: int, y: int, side: str) -> list[Any]:
    """Return a side as places name it: between two cells, it is E or S."""
    if side == "W" and x > 0:
        return [x - 1, y, "E"]
    return [x, y - 1, "S"] if side == "N" and y > 0 else [x, y, side]


def inner(places: Counter[tuple[Any, ...]]) -> Counter[tuple[Any, ...]]:
    """Leave out sides of the outer wall, where N and W have names of their own."""
    return Counter({key: count for key, count in places.items() if key[-1] not in ("N", "W")})


@given(texts, st.integers(0, 10**6))
@settings(max_examples=settings().max_examples // 5)
def test_only_what_is_removed_goes(text: str, seed: int) -> None:
    session, rng = Session(text), Random(seed)
    assume(session.is_valid)
    for _ in range(3):
        before = found(session)
        place = rng.choice(before)
        if not is_done(session, {"do": "remove", "route": place["route"]}):
            continue
        after = stands(found(session))
        left = stands([each for each in before if each is not place])
        if place["kind"] in ("item", "switch"):
            # Doors that needed it alone go, too.
            gone = left - after
            assert {key[0] for key in gone} <= {"door"}
            left -= gone
        assert after == left
