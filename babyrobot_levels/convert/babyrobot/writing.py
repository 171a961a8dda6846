"""Levels to setups."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from babyrobot_levels.convert.babyrobot.reading import (
    COLORS,
    NO_EXIT,
    PANEL_SIDES,
    SIZES,
    THEMES,
    USUAL_SLEEP,
    WIDTHS,
)
from babyrobot_levels.convert.babyrobot.toggles import ALMOST_NEVER, maze_edges
from babyrobot_levels.convert.blocks import SPATIAL, UNLIKE, only_first
from babyrobot_levels.convert.conversion import Conversion, Lost, fields_lost
from babyrobot_levels.convert.data import truncated
from babyrobot_levels.convert.edges import (
    Edge,
    edge_runs,
    free_edges,
    is_inner,
    wall_at,
    wall_looks,
)
from babyrobot_levels.language.cells import as_skid
from babyrobot_levels.language.looks import BUILTIN_THEMES, Panel
from babyrobot_levels.language.runs import rectangles
from babyrobot_levels.library.level import Level

DEFAULT = BUILTIN_THEMES["default"]
PLACE = "a setup"
CARRIED = SPATIAL | UNLIKE | {"puddles", "puddle_types", "max_steps", "theme", "display"}


def write_setup(level: Level) -> Conversion:
    """Return a level as a setup of PyPI babyrobot 1.0.40, a Python literal."""
    setup, lost = setup_of(level)
    lines = "".join(f"    {key!r}: {_literal(value)},\n" for key, value in setup.items())
    return Conversion(f"{{\n{lines}}}\n", tuple(dict.fromkeys(lost)))


def setup_of(level: Level) -> tuple[dict[str, Any], list[Lost]]:
    """Return a level as keywords of the package, and what they do not keep."""
    lost = list(fields_lost(level, CARRIED, PLACE))
    setup: dict[str, Any] = {"width": level.size[0], "height": level.size[1]}
    setup |= {"start": level.starts[0], "end": (level.exits or (NO_EXIT,))[0]}
    for name, cells in (("start", level.starts), ("exit", level.exits)):
        if len(cells) > 1:
            lost.append(only_first(name, cells, PLACE))
    setup |= _maze_and_walls(level, lost)
    setup |= _cells(level, lost)
    lost += _lost_rewards(level)
    if level.max_steps is not None:
        setup["max_steps"] = level.max_steps
    setup |= _theme(level, lost)
    setup |= _display(level, lost)
    return setup, lost


def _literal(value: Any) -> str:
    if isinstance(value, list):
        lines = "".join(f"        {each!r},\n" for each in value)
        return f"[\n{lines}    ]"
    return repr(value)


# -- walls -----------------------------------------------------------------------------------


def _maze_and_walls(level: Level, lost: list[Lost]) -> dict[str, Any]:
    grid, maze = level.grid(), level.maze
    setup: dict[str, Any] = {}
    in_maze: set[Edge] = set()
    # The package has one algorithm, and its mazes go through blocked cells.
    is_theirs = maze is not None and maze.algorithm == "depth-first" and not maze.loops
    if maze is not None and is_theirs and not level.blocked and isinstance(maze.seed, int):
        setup = {"add_maze": True, "maze_seed": maze.seed}
        in_maze = maze_edges(*level.size, level.starts[0], maze.seed)
    looks = wall_looks(level)
    if any(not is_inner(*edge, *level.size) for edge in looks):
        lost.append(Lost("walls.color", "the outer wall has one look"))
    once: dict[Edge, dict[str, Any]] = {}
    again: dict[Edge, dict[str, Any]] = {}
    for edge in free_edges(grid):
        glass = wall_at(grid, edge)
        prob = 0.0 if glass == ALMOST_NEVER else glass
        given = ({"prob": prob} if glass else {}) | looks.get(edge, {})
        if edge not in in_maze and glass is not None:
            once[edge] = given
        elif edge in in_maze and glass is None:
            once[edge] = {}
        elif edge in in_maze and given:
            # Removed, and added again with its properties.
            once[edge], again[edge] = {}, given
    walls = [*_entries(once), *_entries(again)]
    return setup | ({"walls": walls} if walls else {})


def _entries(edges: dict[Edge, dict[str, Any]]) -> Iterator[tuple[Any, ...]]:
    """Yield entries of `walls`, each for a run of equal edges."""
    for (x, y, side), length, given in edge_runs(edges):
        place = (x, y, length) if length > 1 else (x, y)
        yield (place, side, given) if given else (place, side)


# -- cells -----------------------------------------------------------------------------------


def _cells(level: Level, lost: list[Lost]) -> dict[str, Any]:
    setup: dict[str, Any] = {}
    numbers = {name: number for number, name in SIZES.items()}
    if level.puddles:
        setup["puddles"] = [(puddle.at, numbers[puddle.size]) for puddle in level.puddles]
    properties: dict[str, Any] = {}
    for name in numbers:
        kind, usual = (
            getattr(level.puddle_types, name),
            {"small": (-2, 0.4), "large": (-4, 0.6)}[name],
        )
        skid = as_skid(kind.skid)
        if kind.reward != usual[0]:
            properties[f"{name}_reward"] = _reward(kind.reward, f"puddle_types.{name}.reward", lost)
        if skid.probability != usual[1]:
            properties[f"{name}_prob"] = round(1 - skid.probability, 12)
        if skid.to != "open":
            lost.append(Lost(f"puddle_types.{name}.skid", "the package skids to open sides only"))
    if properties:
        setup["puddle_props"] = properties
    areas = []
    for area in level.areas:
        entry: tuple[Any, ...] = ((*area.at, *area.size), area.color)
        if area.reward is not None:
            entry = (*entry, _reward(area.reward, "areas.reward", lost))
        areas.append(entry)
    lost += [
        Lost(f"areas.{name}", "an area of a setup has only a colour and a reward")
        for name in ("skid", "ends", "label")
        if any(getattr(area, name) is not None for area in level.areas)
    ]
    if areas:
        setup["grid_areas"] = areas
    if level.blocked:
        setup["base_areas"] = _blocked(level)
    return setup


def _blocked(level: Level) -> list[Any]:
    """Return the blocked rectangles, without overlaps: the package cannot remove a cell twice."""
    cells = level.grid().blocked_cells
    found = [(*rectangle.at, *rectangle.size) for rectangle in level.blocked]
    if sum(columns * rows for *_, columns, rows in found) != sum(cells):
        found = list(rectangles(cells, level.size[0]))
    color = level.resolved_theme.colors.blocked
    if level.theme in THEMES or color == DEFAULT.colors.blocked:
        return found
    return [(rectangle, color) for rectangle in found]


def _reward(value: float, where: str, lost: list[Lost]) -> float:
    if int(value) != value:
        lost.append(Lost(where, f"the package counts {value:g} as {int(value)}"))
    return truncated(value)


def _lost_rewards(level: Level) -> Iterator[Lost]:
    """Yield the rewards that differ from those of the package."""
    theirs = {"step": -1, "exit": -1, "bounce": -1}
    wet = {puddle.at: puddle.size for puddle in level.puddles}
    if level.exits and level.exits[0] in wet:
        theirs["exit"] = int(getattr(level.puddle_types, wet[level.exits[0]]).reward)
    for name, value in level.rewards.model_dump().items():
        if value != theirs.get(name) and (name != "exit" or level.exits):
            usual = f"always {theirs[name]:g}" if name in theirs else "that of the cell"
            yield Lost(f"rewards.{name}", f"in the package it is {usual}, not {value:g}")


# -- looks -----------------------------------------------------------------------------------


def _theme(level: Level, lost: list[Lost]) -> dict[str, Any]:
    if level.theme in THEMES:
        return {"grid": {"theme": level.theme}}
    theme = level.resolved_theme
    colors = {}
    for name, value in theme.colors.model_dump().items():
        if value != getattr(DEFAULT.colors, name):
            if name in COLORS:
                colors[name] = value
            elif name != "blocked" or not level.blocked:
                lost.append(Lost(f"theme.colors.{name}", "the package has no such colour"))
    widths = {name: getattr(theme.widths, name) for name in WIDTHS}
    widths = {name: w for name, w in widths.items() if w != getattr(DEFAULT.widths, name)}
    grid = ({"colors": colors} if colors else {}) | ({"widths": widths} if widths else {})
    return {"grid": grid} if grid else {}


def _display(level: Level, lost: list[Lost]) -> dict[str, Any]:
    display = level.display
    setup: dict[str, Any] = {}
    setup |= {"add_compass": True} if display.compass else {}
    setup |= {} if display.start_text else {"show_start_text": False}
    setup |= {} if display.exit_text else {"show_end_text": False}
    if display.coordinates:
        lost.append(Lost("display.coordinates", "the package shows them only on request"))
    for keyword, (size, _) in PANEL_SIDES.items():
        panel = getattr(display, keyword)
        if isinstance(panel, Panel):
            given = {size: panel.width, "color": panel.color, "text_fg": panel.text_color}
            setup[keyword] = {name: value for name, value in given.items() if value is not None}
        elif panel != "none":
            setup[keyword] = int(panel)
    robot: dict[str, Any] = {} if display.robot.show else {"show": False}
    if display.robot.speed != 1:
        robot["sleep"] = round(USUAL_SLEEP / display.robot.speed, 6)
    return setup | ({"robot": robot} if robot else {})
