"""The messages between the editor's page or widget and Python.

A message is a mapping with `id`, which the reply repeats, and `do`, what is asked for: a gesture
(`editor/gestures.py`, with its fields), or one of

- `text`: another `text`, typed; `joined` if it belongs to the same step as the text before;
- `undo`, `redo`: the reply has `step`, what was asked for in that step, None if there is none;
- `keep_maze`: the last gesture again, with the maze written out as walls before; only if that
  gesture made the maze grow anew, as `maze_regrown` of the state says;
- `open`: another level: `source`, a name, a share code, the text of a level or a map of another
  program; `format` if the map may be in several (`convert/formats.py`);
- `save`: write the text to its file. If another program has changed the file, the reply has
  `conflict`, with the file's `text` (None if it has none): then `force` overwrites it, and
  `reload` takes its text instead;
- `reload`: take the text that the file has now;
- `downloaded`: the browser has saved the text that is at hand.

These have `revision`, that of the state that they were made from. If the text has changed since,
by another page, they are refused. Their replies have `state`, see `editor/state.py`. If the
message `has` the number of the state that was shown last, they may have `changes` of that one
instead, and `from`, its number. Questions change nothing:

- `state`: the state, for one who begins; it also has `forms`, see `editor/forms.py`, and
  `themes`, those in files beside the level's, by their names. While a change is made, it is the
  state before, see `meanwhile`;
- `answers`, with `revision`: the state again, or its changes, with the optimum and all findings,
  however long that takes; if the text has changed meanwhile, the reply has no state. See `prepare`;
- `policy`, with `revision`: what a policy drawn by hand is worth: `actions`, see
  `worth.worth_of`. The reply has `policy`;
- `filled`, with `revision` and the fields of the gesture `fill`: the `cells` that it paints;
- `lift`, with `revision`: the region between two corners, `cells`, is what the gesture `stamp` puts
  elsewhere from now on. The reply has its `size`;
- `levels`: what can be opened by name, and from texts, see `sources.known`;
- `copy`: the level in a `form` (`editor/sources.py`). The reply has `copy`;
- `quit`: end the server. The reply has `ended`; with unsaved changes, and without `force`, it is
  refused, and the reply has `unsaved`.

A reply has `id`, as it was given, and, if the message was refused, `error`, a sentence.
"""

import json
from contextlib import suppress
from typing import Any

from pydantic import ValidationError

from babyrobot_levels.extensions.editor.changes.cells import filled
from babyrobot_levels.extensions.editor.changes.draft import RefusedError
from babyrobot_levels.extensions.editor.forms import forms
from babyrobot_levels.extensions.editor.gestures import Cell, Fill, Gesture, Paint, gesture_of
from babyrobot_levels.extensions.editor.session import ConflictError, Session
from babyrobot_levels.extensions.editor.sources import FORMS, copied, known, opened
from babyrobot_levels.extensions.editor.state import state_of, themes_beside
from babyrobot_levels.mdp.numeric import NEEDS_NUMPY, is_numeric
from babyrobot_levels.text.budget import COMMAND, READ, OverBudgetError, within
from babyrobot_levels.text.source import MAX_BYTES

STALE = "the level was changed elsewhere meanwhile; this is how it is now"

QUESTIONS = ("state", "levels", "answers", "policy", "filled", "lift", "copy", "quit")
"""What changes nothing."""


SLOW = ("answers", "policy", "copy")
"""The questions that may take long, which `prepare` is for."""

_BESIDE = ("policy", "copy", "levels", "filled")
"""The questions that need not wait until a change is made: their replies have no state."""


def prepare(session: Session, message: dict[str, Any]) -> dict[str, Any] | None:
    """Do what takes long before a message is answered.

    It may run beside other messages, in a thread of its own, so that it holds up none of them.

    Returns:
        The reply, if it is of one level alone; None if `answer` gives it, which is quick then.
    """
    with within(COMMAND):
        if message.get("do") in _BESIDE:
            return _answer(session, message)
        if message.get("do") == "answers" and message.get("revision") == session.revision:
            session.catch_up()
    return None


def meanwhile(session: Session, message: dict[str, Any]) -> dict[str, Any] | None:
    """Return the reply to a message while another one is answered; None if it has to wait.

    Changes wait for each other: what is saved, too, is the text after the change before.
    """
    if message.get("do") == "state" and "text" in session.shown.last:
        with suppress(RefusedError):
            _check(message)
            return {"id": message.get("id"), "state": _begun(session, session.shown.last)}
    return None


def answer(session: Session, message: dict[str, Any]) -> dict[str, Any]:
    """Do what a message asks for, and return the reply."""
    with within(READ):
        return _answer(session, message)


def _answer(session: Session, message: dict[str, Any]) -> dict[str, Any]:
    fields = dict(message)
    number = fields.pop("id", None)
    reply: dict[str, Any] = {"id": None}
    is_current = fields.pop("revision", None) == session.revision
    is_question = fields.get("do") in QUESTIONS
    has = fields.pop("has", None)
    try:
        _check(message)
        reply["id"] = number
        if is_question:
            return reply | _asked(session, fields, has, is_current=is_current)
        if not is_current:
            raise RefusedError(STALE)
        reply |= _changed(session, fields)
    except ConflictError as error:
        reply |= {"error": str(error), "conflict": {"text": error.found}}
    except (RefusedError, OverBudgetError) as error:
        reply["error"] = str(error)
    except ModuleNotFoundError:
        if is_numeric():
            raise
        reply["error"] = NEEDS_NUMPY
    return reply if is_question else reply | session.shown.reply(state_of(session), has)


def _check(message: dict[str, Any]) -> None:
    """Refuse what no reply could repeat, and texts that no file can hold."""
    try:
        json.dumps(message, ensure_ascii=False, allow_nan=False).encode("utf-8")
    except UnicodeEncodeError:
        raise RefusedError("the message is not valid Unicode") from None
    except ValueError:
        raise RefusedError("a number of the message is too large") from None
    except RecursionError:
        raise RefusedError("the message is nested too deep") from None
    for text in (message.get("text"), message.get("source")):
        if isinstance(text, str) and len(text.encode("utf-8")) > MAX_BYTES:
            raise RefusedError("a level file has at most 1 MiB")


def _asked(
    session: Session, fields: dict[str, Any], has: Any, *, is_current: bool
) -> dict[str, Any]:
    """Answer a question."""
    match fields:
        case {"do": "state"}:
            return {"state": _begun(session, session.shown.reply(state_of(session), None)["state"])}
        case {"do": "answers"}:
            if not is_current:
                return {}
            session.catch_up()
            return session.shown.reply(state_of(session), has)
        case {"do": "policy"}:
            if not is_current:
                raise RefusedError(STALE)
            return {"policy": _policy(session, fields.get("actions"))}
        case {"do": "filled"}:
            return {"cells": _filled(session, fields)} if is_current else {}
        case {"do": "lift"}:
            return {"size": _lifted(session, fields)} if is_current else {}
        case {"do": "copy", "form": str(form)} if form in FORMS:
            return {"copy": copied(session, form)}
        case {"do": "levels"}:
            return known()
        case {"do": "quit"}:
            if not session.is_saved and fields.get("force") is not True:
                return {"unsaved": True, "error": "there are unsaved changes"}
            return {"ended": True}
    raise RefusedError("this question is not known")


def _begun(session: Session, shown: dict[str, Any]) -> dict[str, Any]:
    """Return a state for one who begins."""
    return {**shown, "forms": forms(), "themes": themes_beside(session.path)}


def _changed(session: Session, fields: dict[str, Any]) -> dict[str, Any]:
    """Change the level, or its file; return what the reply has beside the state."""
    match fields:
        case {"do": "text", "text": str(text)}:
            session.type(text, joined=fields.get("joined") is True)
        case {"do": "undo"}:
            return {"step": session.undo()}
        case {"do": "redo"}:
            return {"step": session.redo()}
        case {"do": "keep_maze"}:
            session.keep_maze()
        case {"do": "open", "source": str(source)}:
            session.open(*opened(source, fields.get("format")))
        case {"do": "save"}:
            session.save(force=fields.get("force") is True)
        case {"do": "reload"}:
            session.reload()
        case {"do": "downloaded"}:
            session.note_download()
        case _:
            session.apply(_gesture(fields))
    return {}


def _gesture(fields: dict[str, Any]) -> Gesture:
    try:
        return gesture_of.validate_python(fields)
    except ValidationError:
        raise RefusedError("this gesture is not known") from None


def _filled(session: Session, fields: dict[str, Any]) -> list[Cell]:
    gesture = _gesture({**fields, "do": "fill"})
    if session.level is None or not isinstance(gesture, Fill):
        raise RefusedError("there is no valid level yet")
    return filled(session.level, gesture)


def _lifted(session: Session, fields: dict[str, Any]) -> tuple[int, int]:
    gesture = _gesture({**fields, "do": "paint", "brush": "erase"})
    assert isinstance(gesture, Paint)
    return session.lift(gesture.cells[0], gesture.cells[-1]).size


def _policy(session: Session, actions: Any) -> dict[str, Any]:
    from babyrobot_levels.extensions.editor.worth import worth_of

    revision = session.revision
    session.answers.catch_up()
    optimum = session.answers.optimum
    if session.revision != revision:
        raise RefusedError(STALE)
    if optimum is None:
        raise RefusedError("there is no valid level yet")
    return worth_of(optimum, actions)
