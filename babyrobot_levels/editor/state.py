"""What the editor shows of a session, as plain data for JSON."""

from __future__ import annotations

from typing import Any

from babyrobot_levels.editor.entries.forms import expanded, own_fields
from babyrobot_levels.editor.entries.places import places_of
from babyrobot_levels.editor.session import Session
from babyrobot_levels.editor.shown.contrast import look_of
from babyrobot_levels.editor.shown.findings import findings_of
from babyrobot_levels.render.page_format import TooLargeError


def state_of(session: Session) -> dict[str, Any]:
    """Return everything that the editor shows.

    The keys: `revision`, `text`, `name`, `path`, `is_valid`, `is_saved`, `can_undo`, `can_redo`;
    `maze_regrown`, whether the last gesture made the maze grow anew, which `keep_maze` undoes;
    `findings`, see `findings_of`; `findings_pending`, whether some are still to be looked for,
    which the question `answers` does; and of the level of the text or, if the text is invalid, of
    the last valid one:

    - `level`, what a page knows about it (None if none was valid, or if it is too large for a
      picture: `too_large` then says so);
    - `unreachable`, the cells `[x, y]` in which no episode can ever be;
    - `answers`, see `Answers.to_dict`;
    - `places`, what stands where, see `places.py`;
    - `fields`, its own fields as the file gives them, see `forms.py`;
    - `theme` and `contrast`, how it looks, see `contrast.py`.
    """
    answers = session.answers
    level, too_large = None, None
    places: list[dict[str, Any]] = []
    fields: dict[str, Any] = {}
    try:
        level = answers.page()
        if session.level is not None and session.document is not None:
            fields = expanded(own_fields(session.document.data))
            places = places_of(session.level, session.document)
    except TooLargeError as error:
        too_large = str(error)
    size = answers.level.size if answers.level is not None else (0, 0)
    return {
        "revision": session.revision,
        "text": session.text,
        "name": session.name,
        "path": None if session.path is None else session.path.name,
        "is_valid": session.is_valid,
        "is_saved": session.is_saved,
        "can_undo": session.can_undo,
        "can_redo": session.can_redo,
        "maze_regrown": session.is_maze_regrown,
        "findings": findings_of(session.linting, size),
        "findings_pending": bool(session.linting.waiting),
        "unreachable": answers.unreachable,
        "answers": answers.to_dict(),
        "level": level,
        "places": places,
        "fields": fields,
        "too_large": too_large,
        **({} if session.level is None else look_of(session.level.resolved_theme)),
    }
