"""The editor's front end: its script, which is an ES module, and its style sheet."""

from __future__ import annotations

import json
from functools import cache

from babyrobot_levels.editor.state import themes
from babyrobot_levels.language.kinds import KINDS, NEEDED, Where
from babyrobot_levels.render.page import common_data, common_module
from babyrobot_levels.render.templates import put_together
from babyrobot_levels.text.words import listed


@cache
def served_script() -> str:
    """Return the script of the page that the server shows."""
    return put_together("editor/static/served.js", _common())


@cache
def widget_script() -> str:
    """Return the module of the widget: it exports `render`, and brings its style sheet."""
    sheet = f"export const STYLE = {json.dumps(style())};"
    return put_together("editor/static/widget.js", {**_common(), "editor/static/style.js": sheet})


@cache
def style() -> str:
    """Return the style sheet: what the page shares of its own, and the editor's."""
    return put_together("editor/static/editor.css")


def _common() -> dict[str, str]:
    kinds = {
        "on_top": [kind.name for kind in KINDS],
        "at_sides": [kind.name for kind in KINDS if kind.where is Where.SIDE],
        "none_needed": listed([kind.plural for kind in NEEDED], "or"),
    }
    return common_module({**common_data(), **kinds, "themes": themes()})
