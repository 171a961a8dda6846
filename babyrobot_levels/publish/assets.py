"""The files that all pages of a gallery share."""

from __future__ import annotations

from collections.abc import Callable
from importlib.resources import files

from babyrobot_levels.language.looks import Theme
from babyrobot_levels.language.play import program
from babyrobot_levels.publish.icons import icons_style
from babyrobot_levels.render.page import PLAYER, code_of, embedded_json
from babyrobot_levels.render.page_data import common_data
from babyrobot_levels.render.scene.layout import CELL
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.scene.shapes import Scene, toned
from babyrobot_levels.render.svg import to_svg


def static(name: str) -> str:
    """Return the text of a template, a script or a style sheet of this room."""
    return files("babyrobot_levels.publish").joinpath("static", name).read_text("utf-8")


def _icon() -> str:
    """Return the icon of all pages: the robot, as SVG."""
    theme = Theme()
    return to_svg(Scene(CELL, CELL, toned(robot_shapes(theme, 0, 0), theme.colors)))


def _common_script() -> str:
    """Return the script of what all levels share: the robot's pictures, the meaning of codes."""
    return f"const COMMON = {embedded_json({**common_data(), 'made_by': program()})};\n"


ASSETS: dict[str, Callable[[], str]] = {
    "icon.svg": _icon,
    "icons.css": icons_style,
    "site.css": lambda: code_of(["picture.css"]) + "\n" + static("site.css"),
    "common.js": _common_script,
    "level.css": lambda: static("level.css"),
    "level.js": lambda: static("level.js"),
    "player.css": lambda: code_of(["player.css"]) + "\n",
    "player.js": lambda: f'"use strict";\n{code_of(PLAYER)}\n',
    "wall.css": lambda: static("wall.css"),
    "wall.js": lambda: static("wall.js"),
}
"""The text of each file, by its name in the folder `assets`."""
