"""What the editor shows of a session, as plain data for JSON."""

from __future__ import annotations

from typing import Any

from babyrobot_levels.edit.session import Session
from babyrobot_levels.lint.registry import find
from babyrobot_levels.render.page_data import TooLargeError, page_data
from babyrobot_levels.text.diagnostics import Diagnostic


def state_of(session: Session) -> dict[str, Any]:
    """Return everything that the editor shows.

    The keys: `revision`, `text`, `name`, `path`, `is_valid`, `is_saved`, `can_undo`, `can_redo`;
    `findings`, as `Diagnostic.to_dict` gives them; and `level`, what a page knows about the level
    of the text or, if the text is invalid, about the last valid one (None if none was, or if it is
    too large for a picture: `too_large` then says so).
    """
    level, too_large = None, None
    if session.level is not None:
        try:
            level = page_data(session.level)
        except TooLargeError as error:
            too_large = str(error)
    return {
        "revision": session.revision,
        "text": session.text,
        "name": session.name,
        "path": None if session.path is None else session.path.name,
        "is_valid": session.is_valid,
        "is_saved": session.is_saved,
        "can_undo": session.can_undo,
        "can_redo": session.can_redo,
        "findings": [finding(each) for each in session.report.diagnostics],
        "level": level,
        "too_large": too_large,
    }


def finding(diagnostic: Diagnostic) -> dict[str, Any]:
    """Return a finding as `Diagnostic.to_dict` does, with the `title` of its rule."""
    rule = find(diagnostic.code)
    return {**diagnostic.to_dict(), "title": "" if rule is None else rule.summary}
