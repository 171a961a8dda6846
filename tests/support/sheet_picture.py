"""The picture of `docs/sheets.md`: a sheet and its key, side by side."""

from __future__ import annotations

import babyrobot_levels as brl
from babyrobot_levels.render.raster import to_png
from babyrobot_levels.render.scene.shapes import Path, Rect, Scene, Shape, rounded, scaled, shifted
from support.places import DOCS

PICTURE = DOCS / "images" / "sheet.png"
LEVELS = ("frozen-lake", "gridworld-3-5", "first-key")

_SCALE, _GAP = 0.9, 12.0


def picture() -> bytes:
    """Return the picture as a PNG file."""
    shapes: list[Shape] = []
    left = _GAP
    for key in (False, True):
        [page] = brl.sheet(LEVELS, title="Value iteration", grids=3, key=key).pages
        width, height = _SCALE * page.width, _SCALE * page.height
        shapes.append(Rect(left, _GAP, width, height, "white"))
        shapes.append(Path(rounded(left, _GAP, width, height, 0), stroke="#b0b0b0"))
        shapes += shifted(scaled(page.shapes, _SCALE), left, _GAP)
        left += width + _GAP
    return to_png(Scene(left, height + 2 * _GAP, tuple(shapes)), colors=32)
