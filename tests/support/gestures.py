"""Messages of the editor to a session, as its page sends them: given ones, and random ones."""

from __future__ import annotations

from random import Random
from typing import Any

from babyrobot_levels.extensions.editor.gestures import GROUND
from babyrobot_levels.extensions.editor.places import places_of
from babyrobot_levels.extensions.editor.protocol import answer
from babyrobot_levels.extensions.editor.session import Session


def send(session: Session, do: str, **fields: Any) -> dict[str, Any]:
    """Send a message and return the reply. `from_` is `from`, which Python has as a word."""
    names = {"from_": "from"}
    message = {names.get(name, name): value for name, value in fields.items()}
    return answer(session, {"id": 1, "revision": session.revision, "do": do, **message})


def done(session: Session, do: str, **fields: Any) -> str:
    """Send a gesture that is carried out, and return the text after it."""
    before = session.text
    reply = send(session, do, **fields)
    assert "error" not in reply, reply["error"]
    assert session.is_valid
    assert session.can_undo or session.text == before
    return session.text


def refused(session: Session, do: str, **fields: Any) -> str:
    """Send a gesture that is refused, and return the sentence that says why."""
    before = session.text
    error: str = send(session, do, **fields)["error"]
    assert session.text == before
    return error


def drawn(session: Session) -> list[str]:
    """Return the lines of a level's drawing."""
    assert session.level is not None
    return str(session.level.map).splitlines()


def places(session: Session, kind: str) -> list[dict[str, Any]]:
    """Return the places of a kind."""
    found: list[dict[str, Any]] = send(session, "state")["state"]["places"]
    return [each for each in found if each["kind"] == kind]


def random_gesture(rng: Random, session: Session) -> dict[str, Any]:
    """Return a random gesture, rather where something stands, now and then against the rules."""
    assert session.level is not None
    assert session.document is not None
    size = session.level.size
    standing = places_of(session.level, session.document)
    cells = [cell for place in standing for cell in place["cells"]]
    sides = [side for place in standing for side in place["sides"]]

    def cell() -> list[int]:
        if cells and rng.random() < 0.5:
            return list(rng.choice(cells))
        return [rng.randrange(count) for count in size]

    x, y, side = (
        rng.choice(sides) if sides and rng.random() < 0.5 else (*cell(), rng.choice("NESW"))
    )
    names = ["walls", "paint", "fill", "resize", "stamp", "wind", "resolve"]
    do = rng.choices(names, [9, 9, 3, 2, 3, 2, 1])[0]
    brush = rng.choice([*GROUND, "start", "exit"] if do == "paint" else GROUND)
    looks: dict[str, Any] = {"color": rng.choice(["red", "gold"])}
    traits: dict[str, Any] = rng.choice(
        [{}, {"reward": -3}, {"label": "here"}, {"ends": True, "skid": 0.5}]
    )
    fields: dict[str, Any] = {"fields": looks | traits} if brush == "area" else {}
    wall: dict[str, Any] = {"at": [x, y], "side": side, "length": rng.choice([1, 1, 1, 2, 3])}
    wall |= {"to": rng.choice(["none", "none", "wall", "wall", "glass", "door"])}
    wall |= rng.choice([{}, {"pass": 0.2}, {"pass": 0}, {"pass": 1}])
    painted: dict[str, Any] = {
        "cells": [cell() for _ in range(rng.choice([1, 1, 2, 3]))],
        "brush": brush,
    }
    painted |= {"rectangle": rng.random() < 0.3, "add": rng.random() < 0.3}
    other = [min(9, max(1, old + rng.randint(-1, 2))) for old in size]
    messages: dict[str, dict[str, Any]] = {
        "walls": wall,
        "paint": painted | fields,
        "fill": {"brush": brush, "at": cell()} | fields,
        "resize": {"size": other, "shift": [rng.randint(-1, 1), rng.randint(-1, 1)]},
        "stamp": {"at": cell(), "mirror": rng.choice(["", "x", "y", "xy"])},
        "wind": {"side": side, "index": rng.randrange(max(size)), "strength": rng.randrange(3)},
        "resolve": {},
    }
    if do == "stamp":
        (x, y), (right, down) = cell(), cell()
        session.lift((x, y), (right, down))
    return {"do": do, **messages[do]}
