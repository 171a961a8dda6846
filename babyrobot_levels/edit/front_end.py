"""The editor's front end as one ES module: the scripts of the page's painter, and its own."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

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
    "stage.js",
    "overlay.js",
    "pointer.js",
    "rail.js",
    "bar.js",
    "findings.js",
    "yaml_lines.js",
    "text_pane.js",
    "mount.js",
)
"""Its own scripts, in the order of their dependencies."""

STYLES = ("editor.css", "stage.css", "findings.css", "text_pane.css")
"""Its style sheets: of the layout, and of the parts."""


@cache
def module() -> str:
    """Return the ES module. It exports `mount(place, connection)`; see `static/mount.js`."""
    own = [static(name) for name in SCRIPTS]
    return "\n".join([f"const COMMON = {embedded_json(common_data())};", code_of(PAINTER), *own])


@cache
def style() -> str:
    """Return the style sheet: what the page shares of its own, and the editor's."""
    return "\n".join([code_of(["picture.css"]), *map(static, STYLES)])


def static(name: str) -> str:
    """Return a file of the front end."""
    return files("babyrobot_levels.edit").joinpath("static", name).read_text("utf-8")
