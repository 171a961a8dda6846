"""The editor's front end as one ES module: the scripts of the page's painter, and its own."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

from babyrobot_levels.editor.shown.contrast import themes
from babyrobot_levels.render.page import code_of, embedded_json
from babyrobot_levels.render.page_data import common_data

PAINTER = (
    "random.js",
    "checks.js",
    "things.js",
    "game.js",
    "result.js",
    "paint.js",
    "view.js",
    "picture.js",
    "trail.js",
    "speech.js",
)
"""The scripts of the page that the editor shares."""

SCRIPTS = (
    "html.js",
    "spots.js",
    "tools.js",
    "editor.js",
    "answers.js",
    "stage.js",
    "marks_layer.js",
    "overlay.js",
    "pointer.js",
    "playing.js",
    "policy.js",
    "rail.js",
    "bar.js",
    "announce.js",
    "keys.js",
    "touch.js",
    "controls.js",
    "field_row.js",
    "inspector.js",
    "maze.js",
    "wind.js",
    "theme.js",
    "world.js",
    "findings.js",
    "yaml_lines.js",
    "text_pane.js",
    "dialogs.js",
    "help.js",
    "mount.js",
)
"""Its own scripts, in the order of their dependencies."""

STYLES = (
    "editor.css",
    "stage.css",
    "answers.css",
    "marks_layer.css",
    "playing.css",
    "inspector.css",
    "world.css",
    "findings.css",
    "text_pane.css",
    "dialogs.css",
    "help.css",
)
"""Its style sheets: of the layout, and of the parts."""


@cache
def module() -> str:
    """Return the ES module. It exports `mount(place, connection)`; see `static/mount.js`."""
    own = [static(name) for name in SCRIPTS]
    common = embedded_json({**common_data(), "themes": themes()})
    return "\n".join([f"const COMMON = {common};", code_of(PAINTER), *own])


@cache
def style() -> str:
    """Return the style sheet: what the page shares of its own, and the editor's."""
    return "\n".join([code_of(["picture.css"]), *map(static, STYLES)])


def static(name: str) -> str:
    """Return a file of the front end."""
    return files("babyrobot_levels.editor").joinpath("static", name).read_text("utf-8")
