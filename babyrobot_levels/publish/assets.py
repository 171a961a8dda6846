"""The files that all pages of a gallery share."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from babyrobot_levels.language.looks import Theme
from babyrobot_levels.language.play import program
from babyrobot_levels.publish.icons import icons_style
from babyrobot_levels.render.page import common_module
from babyrobot_levels.render.page_data import common_data
from babyrobot_levels.render.scene.layout import CELL
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.scene.shapes import Scene, toned
from babyrobot_levels.render.scripts import put_together
from babyrobot_levels.render.svg import to_svg


def _icon() -> str:
    """Return the icon of all pages: the robot, as SVG."""
    theme = Theme()
    return to_svg(Scene(CELL, CELL, toned(robot_shapes(theme, 0, 0), theme.colors)))


def _player_script() -> str:
    """Return the script of levels that can be played, with what is the same for all of them."""
    common = common_module({**common_data(), "made_by": program()})
    return _script("publish/static/played_level.js", common)


def _script(path: str, given: Mapping[str, str] | None = None) -> str:
    """Return a script that is no module, which browsers would not load from a disk."""
    return f'"use strict";\n{put_together(path, given)}\n'


def _style(path: str) -> str:
    return put_together(path) + "\n"


ASSETS: dict[str, Callable[[], str]] = {
    "icon.svg": _icon,
    "icons.css": icons_style,
    "site.css": lambda: _style("publish/static/site.css"),
    "level.css": lambda: _style("publish/static/level.css"),
    "level.js": lambda: _script("publish/static/level.js"),
    "player.css": lambda: _style("render/static/player.css"),
    "player.js": _player_script,
    "wall.css": lambda: _style("publish/static/wall.css"),
    "wall.js": lambda: _script("publish/static/wall.js"),
}
"""The text of each file, by its name in the folder `assets`."""
