"""Themes of greys: everything in their pictures is grey, whatever colours a level itself sets."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from babyrobot_levels.language.looks import Colors
from babyrobot_levels.render.colors import gray, is_gray
from babyrobot_levels.render.scene.shapes import Path, Shape


def toned(shapes: Iterable[Shape], colors: Colors) -> tuple[Shape, ...]:
    """Return shapes as a theme shows them: all of them in greys if its colours are greys."""
    return tuple(map(_grayed, shapes) if is_gray(colors) else shapes)


def _grayed(shape: Shape) -> Shape:
    if not isinstance(shape, Path):
        return replace(shape, fill=gray(shape.fill))
    fill, stroke = (None if color is None else gray(color) for color in (shape.fill, shape.stroke))
    return replace(shape, fill=fill, stroke=stroke)
