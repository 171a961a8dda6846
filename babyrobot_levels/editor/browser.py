"""The session of an editor that runs in a browser: messages and replies as texts of JSON."""

from __future__ import annotations

import json

from babyrobot_levels.editor.protocol import answer
from babyrobot_levels.editor.session import Session

_sessions: list[Session] = []
"""The one of this worker, once it has begun."""


def begin(text: str, name: str, revision: int) -> None:
    """Begin with a text. A worker that takes another one's place goes on from its revision."""
    session = Session(text, name=name or None)
    session.revision = max(session.revision, revision)
    _sessions[:] = [session]


def reply(message: str) -> str:
    """Return the reply to a message."""
    (session,) = _sessions
    return json.dumps(answer(session, json.loads(message)), allow_nan=False)


def read_again() -> None:
    """Check the text again, after NumPy and SciPy have been loaded."""
    (session,) = _sessions
    session.read_again()
