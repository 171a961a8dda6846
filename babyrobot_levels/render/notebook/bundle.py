"""Pictures as notebooks store them: in forms of which every front end shows one."""

from __future__ import annotations

import base64
import math
from typing import TYPE_CHECKING, Any

from babyrobot_levels.render.raster import to_png
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.screen import screen_scale
from babyrobot_levels.render.svg import to_svg

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld
    from babyrobot_levels.render.scene.shapes import Scene

Bundle = dict[str, Any]
"""Contents by their MIME types, all of the same thing; a front end shows the one it likes best."""

HTML = "text/html"
MARKDOWN = "text/markdown"
PNG = "image/png"
SVG = "image/svg+xml"
TEXT = "text/plain"
WIDGET = "application/vnd.jupyter.widget-view+json"

MAX_PIXELS = 1_000_000
"""A PNG is made smaller until it has no more: it is only a substitute."""

PNG_COLORS = 128
"""So few colours make it a third as large, and are hardly seen."""

MAX_CELLS = 40_000
"""Notebooks would grow by megabytes for the pictures of levels that have more."""


def picture_mimebundle(scene: Scene, text: str) -> Bundle:
    """Return a picture as an SVG, as a PNG, and as a text.

    JupyterLab shows SVG only in notebooks that it trusts: not in one from somebody else. Where
    nothing can be shown, the text is.
    """
    scale = min(1.0, math.sqrt(MAX_PIXELS / (scene.width * scene.height)))
    size = max(1, int(scale * scene.width)), max(1, int(scale * scene.height))
    return {
        SVG: to_svg(scene, screen_scale(scene)),
        PNG: base64.b64encode(to_png(scene, size, colors=PNG_COLORS)).decode(),
        TEXT: text,
    }


def level_mimebundle(level: GridWorld) -> Bundle:
    """Return what a level shows as the last line of a cell: its picture and its drawing.

    Of a level that grows another maze at each reset, the one of seed 0 is shown.
    """
    if is_too_large(level):
        return in_words(level)
    if level.has_random_maze:
        level = level.with_maze_seed(0)
    return picture_mimebundle(build_scene(level), level.draw())


def is_too_large(level: GridWorld) -> bool:
    """Return whether a level has more than `MAX_CELLS` cells."""
    columns, rows = level.size
    return columns * rows > MAX_CELLS


def in_words(level: GridWorld) -> Bundle:
    """Return what stands for the picture of a level that is too large."""
    columns, rows = level.size
    name = level.title or level.name or "a level"
    return {TEXT: f"{name}: {columns} × {rows} cells, too many for a notebook"}
