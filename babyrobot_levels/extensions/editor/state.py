"""What the editor shows of a session, as plain data for JSON."""

import json
from collections import Counter
from functools import cache
from math import floor
from pathlib import Path
from typing import Any

from babyrobot_levels.extensions.editor.findings import findings_of
from babyrobot_levels.extensions.editor.forms import expanded, own_fields
from babyrobot_levels.extensions.editor.places import places_of
from babyrobot_levels.extensions.editor.session import Session
from babyrobot_levels.language.documents import read_theme, theme_folders, theme_names
from babyrobot_levels.language.kinds import KIND, KINDS, NEEDED
from babyrobot_levels.language.looks import BUILTIN_THEMES, Theme
from babyrobot_levels.mdp.numeric import NEEDS_NUMPY, is_numeric
from babyrobot_levels.render.colors import GRAPHICS, TEXT, contrast
from babyrobot_levels.render.page import common_data, common_module
from babyrobot_levels.render.page_format import TooLargeError
from babyrobot_levels.render.templates import put_together, static
from babyrobot_levels.text.words import listed


def state_of(session: Session) -> dict[str, Any]:
    """Return everything that the editor shows.

    The keys: `revision`, `text`, `name`, `path`, `is_made`, whether there is a file of that path,
    `is_valid`, `is_saved`, `can_undo`, `can_redo`;
    `lacks`, why nothing is solved or played here, empty where it is;
    `maze_regrown`, whether the last gesture made the maze grow anew, which `keep_maze` undoes;
    `lost`, what it removed that it did not point at, such as `a door`, in words;
    `left`, what it left out of a stamp, in the same way;
    `findings`, see `findings_of`; `findings_pending`, whether some are still to be looked for,
    which the question `answers` does; and of the level of the text or, if the text is invalid, of
    the last valid one:

    - `level`, what a page knows about it (None if none was valid, or if it is too large for a
      picture: `too_large` then says so);
    - `unreachable`, the cells `[x, y]` in which no episode can ever be;
    - `answers`, see `Answers.to_dict`;
    - `places`, what stands where, see `places.py`;
    - `fields`, its own fields as the file gives them, see `forms.py`;
    - `theme` and `contrast`, how it looks, see `contrasts`.
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
    look: dict[str, Any] = {}
    if session.level is not None:
        theme = session.level.resolved_theme
        look = {"theme": theme.model_dump(), "contrast": contrasts(theme)}
    return {
        "revision": session.revision,
        "text": session.text,
        "name": session.name,
        "path": None if session.path is None else session.path.name,
        "is_made": session.file is not None and session.file.exists,
        "is_valid": session.is_valid,
        "is_saved": session.is_saved,
        "can_undo": session.can_undo,
        "can_redo": session.can_redo,
        "lacks": "" if is_numeric() else NEEDS_NUMPY,
        "maze_regrown": session.is_maze_regrown,
        "lost": _counted(session.lost),
        "left": _counted(session.left),
        "findings": [*findings_of(session.linting, size)],
        "findings_pending": bool(session.linting.waiting),
        "unreachable": answers.unreachable,
        "answers": answers.to_dict(is_valid=session.is_valid),
        "level": level,
        "places": places,
        "fields": fields,
        "too_large": too_large,
        **look,
    }


def _counted(counts: Counter[str]) -> str:
    """Return how many of which kinds, in words."""
    return listed(
        [
            KIND[name].one if count == 1 else f"{count} {KIND[name].plural}"
            for name, count in counts.items()
            if count
        ]
    )


# -- themes ------------------------------------------------------------------------------


STATIC = "extensions/editor/static"
"""The folder of the front end, below that of the package."""

OUTLINED = "pictures outline it in black or white"
REPLACED = "pictures write it in black or white"

PAIRS = (
    ("walls", "base", GRAPHICS, OUTLINED),
    ("border", "base", GRAPHICS, OUTLINED),
    ("puddle", "base", GRAPHICS, OUTLINED),
    ("start", "base", GRAPHICS, None),
    ("exit", "base", GRAPHICS, None),
    ("robot", "base", GRAPHICS, None),
    ("start_text", "start", TEXT, REPLACED),
    ("exit_text", "exit", TEXT, REPLACED),
    ("text_fg", "text_bg", TEXT, "pictures choose another ground"),
)
"""What lies on what, the least contrast that it needs, and what pictures do if it has less."""


MOST_THEMES = 50
"""The most themes of files that are offered."""


def contrasts(theme: Theme) -> list[dict[str, Any]]:
    """Return the contrasts of a theme's colours as plain data.

    The keys: `color` and `ground`, the names of the two; `ratio`, from 1 to 21; `least`, what it
    needs; `is_enough`; and `remedy`, what pictures do where it is not, None for nothing.
    """
    return [
        {
            "color": color,
            "ground": ground,
            "ratio": floor(100 * ratio) / 100,
            "least": least,
            "is_enough": ratio >= least,
            "remedy": remedy,
        }
        for color, ground, least, remedy in PAIRS
        for ratio in [contrast(getattr(theme.colors, color), getattr(theme.colors, ground))]
    ]


def themes_beside(path: Path | None) -> dict[str, Any]:
    """Return the valid themes that stand beside a level's file as plain data, by their names."""
    if path is None:
        return {}
    folders = theme_folders(path.parent)
    names = [name for name in theme_names(folders) if name not in BUILTIN_THEMES]
    found = {name: read_theme(name, folders).value for name in names[:MOST_THEMES]}
    return {name: theme.model_dump() for name, theme in found.items() if theme is not None}


# -- the front end: its script, which is an ES module, and its style sheet -----------------


@cache
def served_script() -> str:
    """Return the script of the page that the server shows."""
    return put_together(f"{STATIC}/served.js", _common())


@cache
def site_script() -> str:
    """Return the script of the page of a site."""
    return put_together(f"{STATIC}/site.js", _common())


@cache
def playground_script() -> str:
    """Return the module of examples that are changed in their places: it exports `show`."""
    return put_together(f"{STATIC}/playground.js", _common())


@cache
def widget_script() -> str:
    """Return the module of the widget: it exports `render`, and brings its style sheet."""
    sheet = f"export const STYLE = {json.dumps(style())};"
    return put_together(f"{STATIC}/widget.js", {**_common(), f"{STATIC}/style.js": sheet})


@cache
def style() -> str:
    """Return the style sheet: what the page shares of its own, and the editor's."""
    return put_together(f"{STATIC}/editor.css")


def _common() -> dict[str, str]:
    kinds = {
        "on_top": [kind.name for kind in KINDS],
        "at_sides": [kind.name for kind in KINDS if kind.where == "side"],
        "answers": static(f"{STATIC}/answers.html"),
        "example": static(f"{STATIC}/playground.html"),
        "frame": static(f"{STATIC}/frame.html"),
        "keys": json.loads(static(f"{STATIC}/keys.json")),
        "learn": static("render/static/learn.html"),
        "none_needed": listed([kind.plural for kind in NEEDED], "or"),
        "text": static(f"{STATIC}/text.html"),
        **json.loads(static(f"{STATIC}/tools.json")),
    }
    themes = {name: theme.model_dump() for name, theme in BUILTIN_THEMES.items()}
    return common_module({**common_data(), **kinds, "themes": themes})
