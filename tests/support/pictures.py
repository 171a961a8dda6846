"""What a browser shows, as pixels, beside what a level's scene says."""

from __future__ import annotations

import io

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import FloatRect, Locator

from babyrobot_levels.library.level import Level
from babyrobot_levels.render.scene.layout import CELL, layout_of

Pixels = NDArray[np.uint8]
Cell = tuple[int, int]

TOLERANCE = 48
"""Colours that differ by no more in any channel look alike: edges are smoothed differently."""

CHANGED = 0.08
"""The share of a cell's pixels that differ where the robot stands: more than where fonts do."""


def photograph(element: Locator) -> Pixels:
    """Return what is seen of an element, `[height, width, 3]`."""
    element.scroll_into_view_if_needed()
    box = element.bounding_box()
    assert box is not None
    # Elements may begin between two pixels; then the browser paints them on the nearer one.
    x, y, width, height = (round(box[side]) for side in ("x", "y", "width", "height"))
    clip = FloatRect(x=x, y=y, width=width, height=height)
    png = element.page.screenshot(clip=clip)
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB"))


def unlike(picture: Pixels, other: Pixels) -> NDArray[np.bool_]:
    """Return where two pictures differ, `[height, width]`; those of two sizes do everywhere."""
    if picture.shape != other.shape:
        return np.ones(other.shape[:2], np.bool_)
    difference = np.abs(picture.astype(int) - other.astype(int))
    return np.asarray((difference > TOLERANCE).any(axis=2))


def changed_cells(
    level: Level, picture: Pixels, other: Pixels, share: float = CHANGED
) -> set[Cell]:
    """Return the cells of a level in which more than a share of its pictures' pixels differ."""
    layout, differs, size = layout_of(level), unlike(picture, other), int(CELL)
    cells = set()
    for y in range(layout.rows):
        for x in range(layout.columns):
            left, top = (int(place) for place in layout.corner(x, y))
            if differs[top : top + size, left : left + size].mean() > share:
                cells.add((x, y))
    return cells
