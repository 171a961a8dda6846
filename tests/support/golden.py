"""The pictures of which `tests/render/golden` has the expected SVG texts, or their digests."""

from __future__ import annotations

import hashlib
from functools import cache

from babyrobot_levels.language.looks import BUILTIN_THEMES
from babyrobot_levels.language.things import SHAPES
from babyrobot_levels.library.catalogue import levels, load
from babyrobot_levels.mdp.actions import MOVES, Action
from babyrobot_levels.mdp.states import configuration_with
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.scene.icons import (
    Spot,
    default_color,
    figure_shapes,
    item_shapes,
    padlock_shapes,
)
from babyrobot_levels.render.scene.info import overlay_from
from babyrobot_levels.render.scene.layout import CELL
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.scene.shapes import Rect, Scene, Shape
from babyrobot_levels.render.situation import Mood, Pose
from babyrobot_levels.render.svg import to_svg
from babyrobot_levels.render.terminal import ALL_COLORS
from babyrobot_levels.render.text import TextPainter
from babyrobot_levels.render.words.describe import goal_of
from babyrobot_levels.render.words.rules import rules_of
from support.places import TESTS

FOLDER = TESTS / "render" / "golden"

INFO = {
    "values": [[1, -2.5, 1e6, None], [float("inf"), float("-inf"), 0, -13.25], [None] * 4],
    "policy": [["E", "S", 0, -1], [{1, 2, 3, 4}, "W", "N", "S"], ["E", "E", "E", None]],
    "action_values": [[[None] * 5] * 4] * 2 + [[[0, -1, -2.25, -3.5, -4], *[[None] * 5] * 3]],
    "visits": [[120, 3, 1, 0], [0, 9, 2, 1], [0, 0, 0, 4]],
    "text": [((1, 2), "a note"), ((2.5, 0), "between", "gold")],
    "side_panel": ["beside the grid"],
    "bottom_panel": ["below"],
}


@cache
def pictures() -> dict[str, Scene]:
    """Return the pictures by name: levels, one of them with overlays, and the robot's poses."""
    found = {path.stem: build_scene(load(str(path))) for path in sorted(FOLDER.glob("*.yaml"))}
    level = load(str(FOLDER / "little-of-all.yaml"))
    found["overlay"] = build_scene(level, state=5, overlay=overlay_from(INFO, level))
    for name, keys in {"values": ("values", "policy"), "visits": ("visits", "coordinates")}.items():
        info = {key: INFO.get(key, True) for key in keys}
        found[name] = build_scene(level, state=5, overlay=overlay_from(info, level))
    things = load(str(FOLDER / "things.yaml"))
    configuration = configuration_with(things, ["key", "lever"])
    state = configuration * 35 + 2 * 7 + 2
    found["things-in-play"] = build_scene(things, state=state, heading=1)
    return found | {"poses": poses(), "icons": icons()}


def icons() -> Scene:
    """Return a sheet of icons: items and movers from left to right, themes from top to bottom."""
    shapes: list[Shape] = []
    for y, theme in enumerate(BUILTIN_THEMES.values()):
        colors = theme.colors
        shapes.append(Rect(0, CELL * y, 8 * CELL, CELL, colors.base))
        spots = [Spot(CELL * (x + 0.5), CELL * (y + 0.5)) for x in range(8)]
        for name, spot in zip(SHAPES, spots, strict=False):
            shapes += item_shapes(name, default_color(name, colors), spot)
        for kind, spot in zip(("guard", "wanderer"), spots[5:], strict=False):
            shapes += figure_shapes(kind, default_color(kind, colors), spot)
        shapes += padlock_shapes(default_color("key", colors), spots[7])
    return Scene(8 * CELL, len(BUILTIN_THEMES) * CELL, tuple(shapes), "Icons")


def poses() -> Scene:
    """Return a sheet of poses: facings from left to right, moods and themes from top to bottom."""
    rows = [[Pose(facing, mood) for facing in (Action.STAY, *MOVES)] for mood in Mood] + [
        [Pose(Action.EAST, phase=phase / 5) for phase in range(5)]
    ]
    shapes: list[Shape] = []
    for y, (row, theme) in enumerate(zip(rows, BUILTIN_THEMES.values(), strict=False)):
        shapes.append(Rect(0, CELL * y, 5 * CELL, CELL, theme.colors.base))
        for x, pose in enumerate(row):
            shapes += robot_shapes(theme, CELL * x, CELL * y, pose)
    return Scene(5 * CELL, len(rows) * CELL, tuple(shapes), "Poses")


def svg(name: str) -> str:
    """Return the picture of that name."""
    return to_svg(pictures()[name])


def gallery() -> str:
    """Return digests of all levels of the gallery: of picture, rules and goal, and drawing."""
    lines = []
    for info in levels():
        level = load(info.name)
        level = level.with_maze_seed(0) if level.has_random_maze else level
        drawn = TextPainter(level).lines(None, colors=ALL_COLORS)
        told = (to_svg(build_scene(level)), f"{rules_of(level)} {goal_of(level)}", f"{drawn}")
        digests = [hashlib.sha256(text.encode()).hexdigest()[:12] for text in told]
        lines.append(f"{' '.join(digests)} {info.name}\n")
    return "".join(lines)
