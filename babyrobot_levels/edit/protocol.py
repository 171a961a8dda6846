"""The messages between the editor's page or widget and Python.

A message is a mapping with `id`, a number that the reply repeats, and `do`, what is asked for: a
gesture (`edit/gestures.py`, with its fields), or

- `state`: the state, for one who begins; its reply also has `forms`, see `edit/forms.py`;
- `text`: another `text`, typed; `joined` if it belongs to the same step as the text before;
- `undo`, `redo`.

A message that changes the text also has `revision`, that of the state that it was made from. If
the text has changed since, by another page, it is refused. A reply has `id`; `state`, see
`edit/state.py`; and, if the message was refused, `error`, a sentence.
"""

from __future__ import annotations

from typing import Any

from pydantic import ValidationError

from babyrobot_levels.edit.draft import RefusedError
from babyrobot_levels.edit.forms import forms
from babyrobot_levels.edit.gestures import gesture_of
from babyrobot_levels.edit.session import Session
from babyrobot_levels.edit.state import state_of

STALE = "the level was changed elsewhere meanwhile; this is how it is now"


def answer(session: Session, message: dict[str, Any]) -> dict[str, Any]:
    """Do what a message asks for, and return the reply."""
    fields = dict(message)
    number, revision = fields.pop("id", None), fields.pop("revision", None)
    reply: dict[str, Any] = {"id": number}
    try:
        if fields.get("do") != "state" and revision != session.revision:
            raise RefusedError(STALE)
        _do(session, fields)
    except RefusedError as error:
        reply["error"] = str(error)
    state = state_of(session)
    if fields.get("do") == "state":
        state["forms"] = forms()
    return {**reply, "state": state}


def _do(session: Session, fields: dict[str, Any]) -> None:
    match fields:
        case {"do": "state"}:
            pass
        case {"do": "text", "text": str(text)}:
            session.type(text, joined=fields.get("joined") is True)
        case {"do": "undo"}:
            session.undo()
        case {"do": "redo"}:
            session.redo()
        case _:
            try:
                gesture = gesture_of.validate_python(fields)
            except ValidationError:
                raise RefusedError("this gesture is not known") from None
            session.apply(gesture)
