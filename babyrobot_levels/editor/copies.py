"""A level in the forms in which it is handed on."""

from __future__ import annotations

from contextlib import suppress
from typing import Literal, get_args

from babyrobot_levels.analysis.guides import guide_of
from babyrobot_levels.analysis.solver.results import UndefinedReturnError
from babyrobot_levels.editor.changes.draft import RefusedError
from babyrobot_levels.editor.session import Session
from babyrobot_levels.library.level import Level
from babyrobot_levels.render.page import link_fragment
from babyrobot_levels.render.page_format import TooLargeError
from babyrobot_levels.text.errors import LevelError

Form = Literal["yaml", "drawing", "python", "code", "link"]
"""The forms: the text, a drawing, a call in Python, a share code, the end of a link."""

FORMS: tuple[Form, ...] = get_args(Form)


def copied(session: Session, form: Form) -> str:
    """Return the level of a session in a form.

    A link is the address of any page that `babyrobot preview LEVEL -o page.html` has made, and
    what this returns for `"link"`: `#`, the share code, and what the page plays.

    Raises:
        RefusedError: the text has errors, or the level does not have this form.
    """
    if form == "yaml":
        return session.text
    if not session.is_valid or session.level is None:
        raise RefusedError("the text has errors; correct them, or copy the text")
    try:
        match form:
            case "drawing":
                return session.level.draw()
            case "python":
                return _python(session.text)
            case "code":
                return session.level.share_code()
            case "link":
                return _link(session.level)
    except TooLargeError as error:
        raise RefusedError(f"{error}; send the level file") from None
    except LevelError as error:
        raise RefusedError(str(error).partition("\n")[0]) from None


def _python(text: str) -> str:
    quoted = text.replace("\\", "\\\\").replace('"""', '\\"\\"\\"').rstrip("\n")
    return f'import babyrobot_levels as brl\n\nlevel = brl.loads("""\\\n{quoted}\n""")\n'


def _link(level: Level) -> str:
    played = level.with_maze_seed(0) if level.has_random_maze else level
    fragment = link_fragment(level, played)
    with suppress(UndefinedReturnError, TooLargeError):
        fragment = link_fragment(level, played, guide_of(played))
    return f"#{fragment}"
