"""Scenes as tests compare them, and levels with things."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from babyrobot_levels.library.catalogue import load
from babyrobot_levels.render.scene.build import build_layers
from babyrobot_levels.render.scene.layout import Overlay, layout_of
from babyrobot_levels.render.scene.shapes import Scene
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


def without_legend(
    world: Any, *, cells_only: bool = False, overlay: Overlay | None = None, **told: Any
) -> Scene:
    """Return the scene of a level as frames show it: without the legend of a heat map."""
    layout = replace(layout_of(world, cells_only=cells_only, overlay=overlay), legend=0.0)
    layers = build_layers(world, cells_only=cells_only, overlay=overlay, layout=layout, **told)
    shapes = tuple(shape for layer in layers.values() for shape in layer.shapes)
    return replace(layers["base"], shapes=shapes)
