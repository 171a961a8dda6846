"""Scenes as tests compare them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from babyrobot_levels.render.scene.build import build_layers
from babyrobot_levels.render.scene.layout import layout_of
from babyrobot_levels.render.scene.overlay import Overlay
from babyrobot_levels.render.scene.shapes import Scene


def without_legend(
    level: Any, *, cells_only: bool = False, overlay: Overlay | None = None, **told: Any
) -> Scene:
    """Return the scene of a level as frames show it: without the legend of a heat map."""
    layout = replace(layout_of(level, cells_only=cells_only, overlay=overlay), legend=0.0)
    layers = build_layers(level, cells_only=cells_only, overlay=overlay, layout=layout, **told)
    shapes = tuple(shape for layer in layers.values() for shape in layer.shapes)
    return replace(layers["base"], shapes=shapes)
