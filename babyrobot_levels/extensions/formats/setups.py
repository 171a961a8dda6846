"""Keyword setups of PyPI babyrobot 1.0.40 as levels, with the MDP that the package plays."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from babyrobot_levels.extensions.formats.conversion import (
    Codec,
    ConversionError,
    Lost,
    World,
    color,
    integer,
    integers,
    level_of,
    mapping,
    number,
    probability,
    read_data,
    sequence,
    shown,
    truncated,
)
from babyrobot_levels.extensions.formats.places import route_of
from babyrobot_levels.extensions.formats.setup_walls import maze_edges, toggle
from babyrobot_levels.language.base import MAX_SIZE
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.words import did_you_mean

if TYPE_CHECKING:
    import gymnasium

Cell = tuple[int, int]

SIZES = {1: "small", 2: "large"}
MAX_BLOCKED = 2_000_000
"""More than the largest grid has cells."""

NO_EXIT = (-1, -1)
"""An `end` that cannot be reached: how a setup says that there is no exit."""

THEMES = frozenset({"black_orange", "blue_green", "green"})
"""The themes that the package and the language both have."""

COLORS = (
    *("base", "lines", "start", "start_text", "exit", "exit_text", "border", "walls"),
    *("arrows", "text_bg", "text_fg"),
)
WIDTHS = ("padding", "walls", "border")

USUAL_SLEEP = 0.07
"""The default number of seconds that the package sleeps between two frames."""

_FLAGS = {"add_compass": "compass", "show_start_text": "start_text", "show_end_text": "exit_text"}
_FLAG_DEFAULTS = {"compass": False, "start_text": True, "exit_text": True}
PANEL_SIDES = {"side_panel": ("width", "height"), "bottom_panel": ("height", "width")}
"""For each panel, the keyword for its extent, and the one that the package ignores."""

_DEFAULT_SIZES = {"side_panel": 100, "bottom_panel": 50}

_PLAYING = {
    "seed": "give it to `env.reset(seed=…)`",
    "render_mode": "give it to `level.make(render_mode=…)`",
    "action_space": 'give `actions="all"` to `level.make` for all five actions everywhere',
    "apply_api_compatibility": "a step returns five values",
    "drawmode": "pictures look the same everywhere",
    "offset": "the robot is drawn in its cell",
}
KEYWORDS = {"width", "height", "start", "end", "initial_pos", "puddles", "puddle_props", "walls"}
KEYWORDS |= {"base_areas", "grid_areas", "add_maze", "maze_seed", "max_steps", "grid", "robot"}
KEYWORDS |= {"add_compass", "show_start_text", "show_end_text", "side_panel", "bottom_panel"}
KEYWORDS |= set(_PLAYING)
"""The keywords of the package."""


def from_setup(setup: Mapping[str, Any], *, name: str | None = None) -> Level:
    """Return the level that a keyword setup of PyPI babyrobot 1.0.40 describes.

    The MDP is the one that the package plays, so reaching the exit gives -1. Each keyword that a
    level cannot hold is a `ConversionWarning`.

    Args:
        setup: the keywords: `{"width": 8, "add_maze": True, "walls": [((2, 0), "E")], …}`.
        name: the level's name.

    Raises:
        LevelError: a value is not valid in the package, or the setup is not a valid level.
    """
    return level_of(read_setup(setup), name=name)


def read_setup(setup: Mapping[str, Any]) -> World:
    """Return the world of a setup; see `from_setup`."""
    return _Reader(mapping(plain(setup), "the setup")).world()


class _Reader:
    def __init__(self, setup: dict[str, Any]):
        self.setup = dict(setup)
        self.lost: list[Lost] = []
        self.comments: dict[str, str] = {}
        self.fields: dict[str, Any] = {"version": 1}

    def world(self) -> World:
        take = self.setup.pop
        self.size = self._size()
        self._ends()
        self._blocked()
        self._walls()
        self._puddles()
        self._areas()
        self._look()
        if take("action_space", "dynamic") != "dynamic":
            self._lose("action_space", _PLAYING["action_space"])
        if (steps := take("max_steps", None)) is not None:
            self.fields["max_steps"] = integer(steps, "max_steps")
        for found, keyword in enumerate(self.setup):
            # A file can have so many that looking for what was meant takes seconds.
            meant = did_you_mean(keyword, KEYWORDS) if found < 100 else ""
            unknown = f"the package has no such keyword{meant}"
            self._lose(shown(keyword).strip("'"), _PLAYING.get(keyword, unknown))
        lost = (replace(each, at=route_of(each.field)) for each in self.lost)
        return World(self.fields, "A setup of PyPI babyrobot 1.0.40.", self.comments, tuple(lost))

    def _lose(self, name: str, message: str) -> None:
        self.lost.append(Lost(name, message))

    def _size(self) -> Cell:
        width = integer(self.setup.pop("width", 3), "width")
        height = integer(self.setup.pop("height", 3), "height")
        if not (1 <= width <= MAX_SIZE and 1 <= height <= MAX_SIZE):
            raise ConversionError(
                f"width and height must be 1 to {MAX_SIZE}, not {width} and {height}"
            )
        self.fields["size"] = [width, height]
        return width, height

    def _inside(self, x: int, y: int) -> bool:
        return 0 <= x < self.size[0] and 0 <= y < self.size[1]

    def _ends(self) -> None:
        width, height = self.size
        x, y = integers(self.setup.pop("start", [0, 0]), "start", 2)
        if not self._inside(x, y):
            raise ConversionError(f"start must be a cell of the grid, not ({x}, {y})")
        self.start = x, y
        first = integers(self.setup.pop("initial_pos", None) or [x, y], "initial_pos", 2)
        self.fields["start"] = first
        if first != [x, y]:
            self._lose("start", "the start square is drawn at initial_pos, where episodes start")
        end = integers(self.setup.pop("end", [width - 1, height - 1]), "end", 2)
        self.end = end[0], end[1]
        self.fields["exit"] = end if self._inside(*end) else "none"
        self.fields["rewards"] = {"exit": -1}
        if not self._inside(*end):
            del self.fields["rewards"]
            if self.end != NO_EXIT:
                self._lose("end", f"({end[0]}, {end[1]}) is off the grid, so there is no exit")

    def _walls(self) -> None:
        entries = sequence(self.setup.pop("walls", None) or [], "walls")
        seed = self.setup.pop("maze_seed", 0)
        has_maze = bool(self.setup.pop("add_maze", False))
        if has_maze and seed is None:
            self.fields["maze"] = {"seed": "random"}
            if entries:
                raise ConversionError(
                    "walls cannot be toggled in a maze without a seed; add maze_seed"
                )
            return
        maze = maze_edges(*self.size, self.start, integer(seed, "maze_seed")) if has_maze else set()
        # The package grows its maze from `start`, and through cells that are off the grid.
        is_ours = "blocked" not in self.fields and tuple(self.fields["start"]) == self.start
        toggled = toggle(entries, self.size, maze, write_maze=not is_ours)
        if has_maze and is_ours:
            self.fields["maze"] = {"seed": seed}
        elif has_maze:
            self.comments["walls"] = f"The maze of seed {seed}, written out."
        if toggled.walls:
            self.fields["walls"] = toggled.walls
        if toggled.openings:
            self.fields["openings"] = toggled.openings
        self.lost += toggled.lost

    def _puddles(self) -> None:
        self._puddle_types()
        given = sequence(self.setup.pop("puddles", None) or [], "puddles")
        found: dict[Cell, int] = {}
        is_row = bool(given) and isinstance(given[0], list)
        is_table = is_row and not (given[0] and isinstance(given[0][0], list))
        for index, entry in enumerate(given):
            where = f"puddles[{index}]"
            row = sequence(entry, where)
            if is_table:
                pairs = [((x, index), each) for x, each in enumerate(row)]
            elif len(row) == 2:
                x, y = integers(row[0], where, 2)
                pairs = [((x, y), row[1])]
            else:
                raise ConversionError(f"{where} must be ((x, y), size)")
            for cell, value in pairs:
                size = integer(value, where)
                if size not in (0, *SIZES):
                    raise ConversionError(f"{where}: size must be 1 or 2, not {size}")
                if not self._inside(*cell) or (cell in self.blocked and size):
                    self._lose(where, f"cell {cell} is not a free cell of the grid")
                elif cell in found and size != found[cell]:
                    self._lose(where, f"cell {cell} has a puddle already; the first one counts")
                else:
                    found[cell] = size
        if found.get(self.end):
            types = self.fields.get("puddle_types", {})
            default = {"small": -2, "large": -4}[SIZES[found[self.end]]]
            reward = types.get(SIZES[found[self.end]], {}).get("reward", default)
            self.fields["rewards"]["exit"] = reward
            self.comments["rewards"] = "The exit is in a puddle, whose reward counts."
        puddles = [{"at": [*cell], "size": SIZES[size]} for cell, size in found.items() if size]
        if puddles:
            self.fields["puddles"] = puddles

    def _puddle_types(self) -> None:
        given = mapping(self.setup.pop("puddle_props", None) or {}, "puddle_props")
        types: dict[str, dict[str, Any]] = {}
        for keyword, value in given.items():
            where = f"puddle_props {keyword}"
            name, _, what = keyword.partition("_")
            if name not in SIZES.values() or what not in ("reward", "prob"):
                known = [f"{size}_{each}" for size in SIZES.values() for each in ("reward", "prob")]
                guess = did_you_mean(str(keyword), known)
                self._lose(where, f"the package has no such property{guess}")
            elif what == "reward":
                types.setdefault(name, {})["reward"] = self._reward(value, where)
            else:
                # The probability is that of not skidding. Rounded, so that 1 - 0.9 is 0.1.
                types.setdefault(name, {})["skid"] = round(1 - probability(value, where), 12)
        if types:
            self.fields["puddle_types"] = types

    def _reward(self, value: Any, where: str) -> float:
        """Return a reward as the package counts it, without its fraction."""
        given = number(value, where)
        if int(given) != given:
            self._lose(where, f"the package counts {given:g} as {int(given)}")
        return truncated(given)

    def _rectangle(self, value: Any, where: str) -> dict[str, Any] | None:
        """Return the part of a rectangle that is on the grid, None if it is empty."""
        x, y, *size = integers(value, where, 2, 4)
        columns, rows = size or (1, 1)
        right, bottom = min(x + columns, self.size[0]), min(y + rows, self.size[1])
        x, y = max(x, 0), max(y, 0)
        if right <= x or bottom <= y:
            self._lose(where, "none of its cells is on the grid")
            return None
        cells = {"at": [x, y]}
        return (
            cells
            if (right - x, bottom - y) == (1, 1)
            else cells | {"size": [right - x, bottom - y]}
        )

    def _blocked(self) -> None:
        self.blocked: set[Cell] = set()
        self.blocked_colors: list[str] = []
        blocked, count = [], 0
        given = sequence(self.setup.pop("base_areas", None) or [], "base_areas")
        for index, entry in enumerate(given):
            where = f"base_areas[{index}]"
            parts = sequence(entry, where)
            is_bare = bool(parts) and not isinstance(parts[0], list)
            rectangle = self._rectangle(parts if is_bare else (parts or [None])[0], where)
            if rectangle is None:
                continue
            blocked.append(rectangle)
            (x, y), (columns, rows) = rectangle["at"], rectangle.get("size", (1, 1))
            count += columns * rows
            if count > MAX_BLOCKED:
                raise ConversionError(f"base_areas cover more than {MAX_BLOCKED:,} cells")
            self.blocked |= {(x + i, y + j) for i in range(columns) for j in range(rows)}
            rest = [] if is_bare else parts[1:]
            if rest and isinstance(rest[0], str):
                self.blocked_colors.append(rest.pop(0))
            if rest:
                self._lose(f"{where} borders", "blocked cells have no borders of their own")
        if blocked:
            self.fields["blocked"] = blocked

    def _areas(self) -> None:
        areas = []
        for index, entry in enumerate(
            sequence(self.setup.pop("grid_areas", None) or [], "grid_areas")
        ):
            where = f"grid_areas[{index}]"
            parts = sequence(entry, where)
            area = self._rectangle(parts[0] if parts else None, where)
            if area is None:
                continue
            if len(parts) > 1 and parts[1] is not None:
                known = color(parts[1])
                if known is None:
                    self._lose(where, f"{shown(parts[1])} is not a valid colour of a level")
                else:
                    area["color"] = known
            if len(parts) > 2:
                area["reward"] = self._reward(parts[2], where)
            areas.append(area)
        if areas:
            self.fields["areas"] = areas

    def _look(self) -> None:
        theme = _read_theme(mapping(self.setup.pop("grid", None) or {}, "grid"), self.lost)
        theme = _with_blocked_color(self.blocked_colors, theme, self.lost)
        if theme:
            self.fields["theme"] = theme
        if display := _read_display(self.setup, self.lost):
            self.fields["display"] = display


# -- looks -----------------------------------------------------------------------------------


def _read_display(setup: dict[str, Any], lost: list[Lost]) -> dict[str, Any]:
    """Return the field `display` of a setup."""
    display: dict[str, Any] = {}
    for keyword, name in _FLAGS.items():
        given = bool(setup.pop(keyword, _FLAG_DEFAULTS[name]))
        if given != _FLAG_DEFAULTS[name]:
            display[name] = given
    for keyword in PANEL_SIDES:
        if (panel := setup.pop(keyword, None)) is not None:
            display[keyword] = _panel(keyword, panel, lost)
    robot = _robot(mapping(setup.pop("robot", {}), "robot"), lost)
    return display | ({"robot": robot} if robot else {})


def _panel(keyword: str, panel: Any, lost: list[Lost]) -> Any:
    if isinstance(panel, bool) or not isinstance(panel, int | float | dict):
        # The package takes any other value for a panel of the default size.
        return _DEFAULT_SIZES[keyword]
    if not isinstance(panel, dict):
        return _pixels(panel, keyword)
    size, other = PANEL_SIDES[keyword]
    room = panel.get(size, _DEFAULT_SIZES[keyword])
    found: dict[str, Any] = {"width": _pixels(room, f"{keyword} {size}")}
    for name, ours in (("color", "color"), ("text_fg", "text_color")):
        if name in panel:
            found |= _color(panel[name], ours, f"{keyword} {name}", lost)
    if other in panel:
        lost.append(Lost(f"{keyword} {other}", "a panel always spans its side of the grid"))
    unknown = [name for name in panel if name not in (size, other, "color", "text_fg")]
    lost += (_unknown(keyword, name, (size, "color", "text_fg")) for name in unknown)
    return found if len(found) > 1 else found["width"]


def _unknown(where: str, name: Any, known: Iterable[str]) -> Lost:
    guess = did_you_mean(str(name), known)
    return Lost(f"{where} {name}", f"unknown to the package as well{guess}")


def _pixels(value: Any, where: str) -> float:
    return min(max(number(value, where), 0), 1000)


def _robot(robot: dict[str, Any], lost: list[Lost]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    if not robot.pop("show", True):
        found["show"] = False
    sleep = number(robot.pop("sleep", USUAL_SLEEP), "robot sleep")
    # A robot that never sleeps gets the largest speed.
    speed = round(min(max(USUAL_SLEEP / sleep, 0.01), 100.0), 4) if sleep > 0 else 100.0
    if speed != 1:
        found["speed"] = speed
    lost += [Lost(f"robot {name}", "a level has no such setting of the robot") for name in robot]
    return found


def _read_theme(grid: dict[str, Any], lost: list[Lost]) -> Any:
    """Return the field `theme` of a setup's `grid`, None if there is nothing to set."""
    name = grid.get("theme")
    if name in THEMES:
        # The package ignores the rest of `grid` beside a theme that it knows.
        return name
    if name is not None:
        lost.append(Lost("grid theme", f"{shown(name)} is unknown; write it as colours"))
    colors: dict[str, Any] = {}
    for key, value in mapping(grid.get("colors") or {}, "grid colors").items():
        if key in COLORS:
            colors |= _color(value, key, f"grid colors {key}", lost)
        else:
            guess = did_you_mean(str(key), COLORS)
            lost.append(Lost(f"grid colors {key}", f"a theme has no such colour{guess}"))
    widths: dict[str, Any] = {}
    for key, value in mapping(grid.get("widths") or {}, "grid widths").items():
        if key in WIDTHS and 0 <= number(value, f"grid widths {key}") <= 100:
            widths[key] = value
        else:
            lost.append(Lost(f"grid widths {key}", f"a theme cannot have {shown(value)} for it"))
    unknown = [key for key in grid if key not in ("theme", "colors", "widths")]
    lost += (_unknown("grid", key, ("theme", "colors", "widths")) for key in unknown)
    theme = {"colors": colors} if colors else {}
    return theme | ({"widths": widths} if widths else {}) or None


def _color(value: Any, name: str, where: str, lost: list[Lost]) -> dict[str, str]:
    known = color(value)
    if known is None:
        lost.append(Lost(where, f"{shown(value)} is not a valid colour of a level"))
        return {}
    return {name: known}


def _with_blocked_color(colors: Iterable[Any], theme: Any, lost: list[Lost]) -> Any:
    """Return the theme with the colour of the blocked cells, if they all share one."""
    given = list(colors)
    known = {color(each) for each in given}
    if not given:
        return theme
    (first, *others) = known
    if others or first is None or isinstance(theme, str):
        lost.append(Lost("base_areas", "blocked cells share one colour, and a named theme sets it"))
        return theme
    theme = dict(theme or {})
    return {"colors": {**theme.pop("colors", {}), "blocked": first}, **theme}


CODEC = Codec(
    lambda source: read_setup(mapping(read_data(source), "the setup")),
    holds=lambda data: isinstance(data, dict) and (not data or bool(data.keys() & KEYWORDS)),
)


ID = "BabyRobot-v0"
"""The environment id of PyPI babyrobot, for notebooks that use it."""


def register_babyrobot() -> None:
    """Let `gymnasium.make("BabyRobot-v0", **setup)` play a setup of PyPI babyrobot as a level.

    An environment that is already registered under this id is replaced.
    """
    from gymnasium.envs.registration import register, registry

    from babyrobot_levels.envs.single import LevelEnv

    make_babyrobot.metadata = LevelEnv.metadata  # type: ignore[attr-defined]
    # Gymnasium warns when an id is registered twice.
    registry.pop(ID, None)
    register(ID, entry_point=f"{__name__}:make_babyrobot", order_enforce=False)


def make_babyrobot(
    render_mode: str | None = None, action_space: str = "dynamic", **setup: Any
) -> gymnasium.Env[Any, Any]:
    """Return the environment of a keyword setup.

    Args:
        render_mode: a render mode of `LevelEnv`.
        action_space: `"dynamic"` samples only valid actions, `"discrete"` all five.
        setup: the keywords of the package; see `from_setup`.
    """
    from gymnasium.wrappers import TimeLimit

    from babyrobot_levels.envs.single import LevelEnv

    actions = "valid" if action_space == "dynamic" else "all"
    level = from_setup(setup)
    env = LevelEnv(level, render_mode=render_mode, actions=actions)
    # This id's spec does not know the limit of a setup.
    return env if level.max_steps is None else TimeLimit(env, level.max_steps)
