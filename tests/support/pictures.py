"""What a browser shows, as pixels, beside what a level's scene says."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import FloatRect, Locator

from babyrobot_levels.library.level import Level
from babyrobot_levels.render.colors import Rgb, over, rgba
from babyrobot_levels.render.scene.layout import CELL, Layout, layout_of

Pixels = NDArray[np.uint8]
Cell = tuple[int, int]
Landmark = tuple[str, float, float, Rgb]

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


def landmarks(level: Level) -> Iterator[Landmark]:
    """Yield points whose colours the theme alone determines: what is there, x, y, and the colour.

    They lie in the cells' ground where nothing else is, in the middles of puddles, and in the
    middles of the walls' sides. The robot covers none of them but a puddle's.
    """
    layout, colors = layout_of(level), level.resolved_theme.colors
    grounds = dict.fromkeys(level.starts, colors.start) | dict.fromkeys(level.exits, colors.exit)
    for y in range(layout.rows):
        for x in range(layout.columns):
            ground = _rgb(grounds.get((x, y), colors.base))
            yield f"ground of {x}, {y}", *layout.corner(x + 0.94, y + 0.1), ground
    for puddle in level.puddles:
        x, y = puddle.at
        # Its middle is lighter than the rest.
        water = over("rgba(255,255,255,0.16)", _rgb(colors.puddle))
        yield f"puddle in {x}, {y}", *layout.corner(x + 0.5, y + 0.5), water
    yield from _walls(level, layout)


def _walls(level: Level, layout: Layout) -> Iterator[Landmark]:
    colors = level.resolved_theme.colors
    is_open = level.grid().open
    for y in range(layout.rows):
        for x in range(layout.columns):
            for side, (dx, dy) in enumerate([(0.5, 0), (1, 0.5), (0.5, 1), (0, 0.5)]):
                if not is_open[y, x, side]:
                    outer = x + dx in (0, layout.columns) or y + dy in (0, layout.rows)
                    color = colors.border if outer else colors.walls
                    yield f"wall {side} of {x}, {y}", *layout.corner(x + dx, y + dy), _rgb(color)


def wrong(picture: Pixels, places: Iterable[Landmark]) -> list[str]:
    """Return the landmarks that have another colour than they should, for people to read."""
    found = []
    for what, x, y, expected in places:
        seen = picture[int(y), int(x)]
        if np.abs(seen.astype(int) - expected).max() > 3:
            found.append(f"{what}: {tuple(seen.tolist())} and not {expected}")
    return found


def _rgb(color: str) -> Rgb:
    return rgba(color)[:3]
