"""Scenes as tests compare them, and levels with things."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from babyrobot_levels.library.catalogue import load
from babyrobot_levels.render.pdf import width_of
from babyrobot_levels.render.raster import polylines
from babyrobot_levels.render.scene.build import build_layers
from babyrobot_levels.render.scene.layout import Overlay, layout_of
from babyrobot_levels.render.scene.shapes import Ellipse, Path, Rect, Scene, Shape, Text
from support.golden import FOLDER
from support.worlds import level

VAULT = load(str(FOLDER / "things.yaml"))

CORRIDOR = level(
    size=[5, 1],
    items=[{"name": "key", "at": [1, 0]}],
    doors=[{"at": [2, 0], "side": "E", "needs": "key"}],
    switches=[{"name": "lever", "at": [2, 0]}],
    movers=[{"path": [[4, 0], [3, 0]]}],
    exit="none",
    hit={"ends": False},
)


def bounds(shape: Shape) -> tuple[float, float, float, float]:
    """Return the left, upper, right and lower end of a shape."""
    match shape:
        case Rect():
            return shape.x, shape.y, shape.x + shape.width, shape.y + shape.height
        case Ellipse():
            x, y, rx, ry = shape.x, shape.y, shape.rx, shape.ry
            return x - rx, y - ry, x + rx, y + ry
        case Path():
            points = [point for line, _ in polylines(shape.commands) for point in line]
            half = shape.width / 2 if shape.stroke else 0
            xs, ys = [x for x, _ in points], [y for _, y in points]
            return min(xs) - half, min(ys) - half, max(xs) + half, max(ys) + half
        case Text():
            width = width_of(shape.text, shape.size, bold=shape.bold)
            left = shape.x - {"start": 0, "middle": width / 2, "end": width}[shape.anchor]
            return left, shape.y - shape.size, left + width, shape.y + 0.25 * shape.size


def without_legend(
    world: Any, *, cells_only: bool = False, overlay: Overlay | None = None, **told: Any
) -> Scene:
    """Return the scene of a level as frames show it: without the legend of a heat map."""
    layout = layout_of(world, cells_only=cells_only, overlay=overlay)
    layout = replace(layout, legend=0.0, caption=0.0)
    layers = build_layers(world, cells_only=cells_only, overlay=overlay, layout=layout, **told)
    shapes = tuple(shape for layer in layers.values() for shape in layer.shapes)
    return replace(layers["base"], shapes=shapes)
