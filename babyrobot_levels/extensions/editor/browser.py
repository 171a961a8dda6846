"""The sessions of editors that run in a browser: messages and replies as texts of JSON."""

import json

from babyrobot_levels.extensions.editor.protocol import answer
from babyrobot_levels.extensions.editor.session import Session

_sessions: dict[int, Session] = {}
"""Those of a page, which numbers them."""


def begin(key: int, text: str, name: str, revision: int) -> None:
    """Begin with a text. A worker that takes another one's place goes on from its revision."""
    session = Session(text, name=name or None)
    session.revision = max(session.revision, revision)
    _sessions[key] = session


def reply(key: int, message: str) -> str:
    """Return the reply to a message."""
    return json.dumps(answer(_sessions[key], json.loads(message)), allow_nan=False)


def read_again() -> None:
    """Check all texts again, after NumPy and SciPy have been loaded."""
    for session in _sessions.values():
        session.read_again()
