"""Messages of the editor to a session, as its page sends them."""

from __future__ import annotations

from typing import Any

from babyrobot_levels.editor.protocol import answer
from babyrobot_levels.editor.session import Session


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


def places(session: Session, kind: str) -> list[dict[str, Any]]:
    """Return the places of a kind."""
    found: list[dict[str, Any]] = send(session, "state")["state"]["places"]
    return [each for each in found if each["kind"] == kind]
