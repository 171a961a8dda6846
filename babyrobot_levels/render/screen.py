"""How large pictures are shown on a screen."""

from __future__ import annotations

from babyrobot_levels.render.scene.shapes import Scene

MAX_SIDE = 2048
"""A picture is shown at most this many pixels wide and high; larger ones are made smaller."""


def screen_scale(scene: Scene) -> float:
    """Return the pixels that are shown for each of a scene's: 1, or fewer for a large one."""
    return min(1.0, MAX_SIDE / max(scene.width, scene.height))
