"""How a setup looks: colours, panels, texts and the robot, in the language's fields."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from babyrobot_levels.convert.checked import color, mapping, number
from babyrobot_levels.convert.conversion import Lost, shown

THEMES = frozenset({"black_orange", "blue_green", "green"})
"""The themes that the package and the language both have."""

COLORS = (
    *("base", "lines", "start", "start_text", "exit", "exit_text", "border", "walls"),
    *("arrows", "text_bg", "text_fg"),
)
WIDTHS = ("padding", "walls", "border")

USUAL_SLEEP = 0.07
"""The seconds that the package's robot sleeps between two pictures, if nothing is said."""

_FLAGS = {"add_compass": "compass", "show_start_text": "start_text", "show_end_text": "exit_text"}
_FLAG_DEFAULTS = {"compass": False, "start_text": True, "exit_text": True}
PANEL_SIDES = {"side_panel": ("width", "height"), "bottom_panel": ("height", "width")}
"""For each panel, the keyword that says how much room it takes, and the one that says nothing."""

_DEFAULT_SIZES = {"side_panel": 100, "bottom_panel": 50}


def read_display(setup: dict[str, Any], lost: list[Lost]) -> dict[str, Any]:
    """Return the field `display` of a setup."""
    display: dict[str, Any] = {}
    for keyword, name in _FLAGS.items():
        given = bool(setup.pop(keyword, _FLAG_DEFAULTS[name]))
        if given != _FLAG_DEFAULTS[name]:
            display[name] = given
    for keyword in PANEL_SIDES:
        panel = setup.pop(keyword, None)
        if panel is not None:
            display[keyword] = _panel(keyword, panel, lost)
    robot = _robot(mapping(setup.pop("robot", {}), "robot"), lost)
    return display | ({"robot": robot} if robot else {})


def _panel(keyword: str, panel: Any, lost: list[Lost]) -> Any:
    if isinstance(panel, bool) or not isinstance(panel, int | float | dict):
        # To the package, anything else that is there asks for a panel of the usual size.
        return _DEFAULT_SIZES[keyword]
    if not isinstance(panel, dict):
        return _pixels(panel, keyword)
    size, other = PANEL_SIDES[keyword]
    room = panel.get(size, _DEFAULT_SIZES[keyword])
    told: dict[str, Any] = {"width": _pixels(room, f"{keyword} {size}")}
    for name, ours in (("color", "color"), ("text_fg", "text_color")):
        if name in panel:
            told |= _color(panel[name], ours, f"{keyword} {name}", lost)
    if other in panel:
        lost.append(Lost(f"{keyword} {other}", "a panel is as long as its side of the grid"))
    unknown = [name for name in panel if name not in (size, other, "color", "text_fg")]
    lost += [Lost(f"{keyword} {name}", "the package does not know it either") for name in unknown]
    return told if len(told) > 1 else told["width"]


def _pixels(value: Any, where: str) -> float:
    return min(max(number(value, where), 0), 1000)


def _robot(robot: dict[str, Any], lost: list[Lost]) -> dict[str, Any]:
    told: dict[str, Any] = {}
    if not robot.pop("show", True):
        told["show"] = False
    sleep = number(robot.pop("sleep", USUAL_SLEEP), "robot sleep")
    # The speed of a robot that never sleeps is the greatest that there is.
    speed = round(min(max(USUAL_SLEEP / sleep, 0.01), 100.0), 4) if sleep > 0 else 100.0
    if speed != 1:
        told["speed"] = speed
    lost += [Lost(f"robot {name}", "the robot moves in a way of its own") for name in robot]
    return told


def read_theme(grid: dict[str, Any], lost: list[Lost]) -> Any:
    """Return the field `theme` of a setup's `grid`, None if it says nothing."""
    name = grid.get("theme")
    if name in THEMES:
        # Nothing else of `grid` counts beside a theme that is found.
        return name
    if name is not None:
        lost.append(Lost("grid theme", f"{shown(name)} is a file of its own; write it as colours"))
    colors: dict[str, Any] = {}
    for key, value in mapping(grid.get("colors") or {}, "grid colors").items():
        if key in COLORS:
            colors |= _color(value, key, f"grid colors {key}", lost)
        else:
            lost.append(Lost(f"grid colors {key}", "a theme has no such colour"))
    widths: dict[str, Any] = {}
    for key, value in mapping(grid.get("widths") or {}, "grid widths").items():
        if key in WIDTHS and 0 <= number(value, f"grid widths {key}") <= 100:
            widths[key] = value
        else:
            lost.append(Lost(f"grid widths {key}", f"a theme cannot have {shown(value)} for it"))
    unknown = [key for key in grid if key not in ("theme", "colors", "widths")]
    lost += [Lost(f"grid {key}", "the package does not know it either") for key in unknown]
    theme = {"colors": colors} if colors else {}
    return theme | ({"widths": widths} if widths else {}) or None


def _color(value: Any, name: str, where: str, lost: list[Lost]) -> dict[str, str]:
    known = color(value)
    if known is None:
        lost.append(Lost(where, f"{shown(value)} is no colour that a level can have"))
        return {}
    return {name: known}


def blocked_color(colors: Iterable[Any], theme: Any, lost: list[Lost]) -> Any:
    """Return the theme with the colour of the blocked cells in it, if they have one in common."""
    given = list(colors)
    known = {color(each) for each in given}
    if not given:
        return theme
    (first, *others) = known
    if others or first is None or isinstance(theme, str):
        message = "blocked cells have one colour in common, and themes that are named have theirs"
        lost.append(Lost("base_areas", message))
        return theme
    theme = dict(theme or {})
    return {"colors": {**theme.pop("colors", {}), "blocked": first}, **theme}
