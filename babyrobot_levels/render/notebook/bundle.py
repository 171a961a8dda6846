"""Pictures as MIME bundles, of which every front end shows one type."""

from __future__ import annotations

import base64
import math
from typing import TYPE_CHECKING, Any

from babyrobot_levels.render.raster import to_png
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.scene.shapes import screen_scale
from babyrobot_levels.render.svg import to_svg

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld
    from babyrobot_levels.render.scene.shapes import Scene

Bundle = dict[str, Any]
"""The same content by MIME types; a front end shows the one that it prefers."""

HTML = "text/html"
MARKDOWN = "text/markdown"
PNG = "image/png"
SVG = "image/svg+xml"
TEXT = "text/plain"
WIDGET = "application/vnd.jupyter.widget-view+json"

MAX_PIXELS = 1_000_000
"""The most pixels of a PNG, which is only a substitute; larger pictures are scaled down."""

PNG_COLORS = 128
"""The colours of a PNG; the reduction is hardly visible and saves two thirds of the size."""

WIDEST = 800
"""The width in pixels above which an SVG picture is as wide as its cell; few cells are narrower.

JupyterLab and nbconvert show SVG in a way that no style of the picture itself can restrict.
"""

MAX_CELLS = 40_000
"""The largest level that is shown as a picture; others would add megabytes to a notebook."""


def picture_mimebundle(scene: Scene, text: str) -> Bundle:
    """Return a picture as SVG, PNG and text.

    JupyterLab shows SVG only in trusted notebooks. The text is shown where pictures cannot be.
    """
    scale = min(1.0, math.sqrt(MAX_PIXELS / (scene.width * scene.height)))
    size = max(1, int(scale * scene.width)), max(1, int(scale * scene.height))
    shown = screen_scale(scene)
    return {
        SVG: to_svg(scene, shown if shown * scene.width <= WIDEST else None),
        PNG: base64.b64encode(to_png(scene, size, colors=PNG_COLORS)).decode(),
        TEXT: text,
    }


def level_mimebundle(level: GridWorld) -> Bundle:
    """Return the bundle of a level as the last line of a cell: its picture and its drawing.

    A random maze is shown with seed 0.
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
    """Return the substitute for the picture of a level that is too large."""
    columns, rows = level.size
    name = level.title or level.name or "a level"
    return {TEXT: f"{name}: {columns} × {rows} cells, too many for a notebook"}
