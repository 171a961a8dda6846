"""The messages between the editor's page or widget and Python.

A message is a mapping with `id`, a number that the reply repeats, and `do`, what is asked for: a
gesture (`edit/gestures.py`, with its fields), or

- `state`: the state, for one who begins; its reply also has `forms`, see `edit/forms.py`;
- `text`: another `text`, typed; `joined` if it belongs to the same step as the text before;
- `undo`, `redo`;
- `answers`: the state again, with the optimum, however long that takes; if the text has changed
  meanwhile, the reply has no state. See `prepare`;
- `policy`: what a policy drawn by hand is worth: `actions`, see `policy.worth_of`. The reply has
  `policy`, and no state.

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
from babyrobot_levels.edit.policy import worth_of
from babyrobot_levels.edit.session import Session
from babyrobot_levels.edit.state import state_of

STALE = "the level was changed elsewhere meanwhile; this is how it is now"


def prepare(session: Session, message: dict[str, Any]) -> None:
    """Do what takes long before a message is answered.

    It may run beside other messages, in a thread of its own, so that it holds up none of them.
    """
    if message.get("do") in ("answers", "policy"):
        session.answers.catch_up()


def answer(session: Session, message: dict[str, Any]) -> dict[str, Any]:
    """Do what a message asks for, and return the reply."""
    fields = dict(message)
    number, revision = fields.pop("id", None), fields.pop("revision", None)
    reply: dict[str, Any] = {"id": number}
    prepare(session, message)
    if fields.get("do") == "answers" and revision != session.revision:
        return reply
    try:
        if fields.get("do") != "state" and revision != session.revision:
            raise RefusedError(STALE)
        if fields.get("do") == "policy":
            return {**reply, "policy": _policy(session, fields.get("actions"))}
        _do(session, fields)
    except RefusedError as error:
        reply["error"] = str(error)
    state = state_of(session)
    if fields.get("do") == "state":
        state["forms"] = forms()
    return {**reply, "state": state}


def _do(session: Session, fields: dict[str, Any]) -> None:
    match fields:
        case {"do": "state" | "answers"}:
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


def _policy(session: Session, actions: Any) -> dict[str, Any]:
    optimum = session.answers.optimum
    if optimum is None:
        raise RefusedError("there is no valid level yet")
    return worth_of(optimum, actions)
