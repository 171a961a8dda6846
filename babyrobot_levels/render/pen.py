"""A pen: what a shape comes to on a Pillow image, in its pixels, in one flat colour."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

from PIL import ImageDraw, ImageFont

from babyrobot_levels.render.flatten import Polyline
from babyrobot_levels.render.scene.shapes import Point

Ink = int | tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Pen:
    """Draws in `ink` on an image whose top-left pixel is (`left`, `top`) of the picture."""

    draw: ImageDraw.ImageDraw
    ink: Ink
    left: int = 0
    top: int = 0

    def box(self, x0: float, y0: float, x1: float, y1: float, radius: float = 0.0) -> None:
        """Fill a rectangle, at least a pixel wide and high."""
        left, top = round(x0) - self.left, round(y0) - self.top
        # Pillow counts the last column and row in.
        right = max(left, round(x1) - self.left - 1)
        bottom = max(top, round(y1) - self.top - 1)
        corners = (left, top, right, bottom)
        if radius >= 1:
            self.draw.rounded_rectangle(corners, radius, self.ink)
        else:
            self.draw.rectangle(corners, self.ink)

    def ellipse(self, x: float, y: float, rx: float, ry: float) -> None:
        """Fill an ellipse around (`x`, `y`)."""
        left, top = round(x - rx) - self.left, round(y - ry) - self.top
        right = max(left, round(x + rx) - self.left - 1)
        bottom = max(top, round(y + ry) - self.top - 1)
        self.draw.ellipse((left, top, right, bottom), self.ink)

    def polygon(self, points: list[Point]) -> None:
        """Fill a polygon."""
        # Pillow takes coordinates for the middles of pixels.
        corners = [(round(x - 0.5) - self.left, round(y - 0.5) - self.top) for x, y in points]
        self.draw.polygon(corners, self.ink)

    def stroke(self, line: Polyline, width: float, *, round_caps: bool) -> None:
        """Draw a line of some width, with round joins."""
        points, closed = line
        half = width / 2
        ends = [*points, points[0]] if closed else points
        for start, end in pairwise(ends):
            self._segment(start, end, half)
        if half >= 1:
            for x, y in points if round_caps or closed else points[1:-1]:
                self.ellipse(x, y, half, half)

    def _segment(self, start: Point, end: Point, half: float) -> None:
        (x0, y0), (x1, y1) = start, end
        if x0 == x1:
            self.box(x0 - half, min(y0, y1), x0 + half, max(y0, y1))
        elif y0 == y1:
            self.box(min(x0, x1), y0 - half, max(x0, x1), y0 + half)
        else:
            length = math.hypot(x1 - x0, y1 - y0)
            dx, dy = half * (y1 - y0) / length, half * (x0 - x1) / length
            self.polygon(
                [(x0 + dx, y0 + dy), (x1 + dx, y1 + dy), (x1 - dx, y1 - dy), (x0 - dx, y0 - dy)]
            )

    def text(self, x: float, y: float, text: str, size: float, anchor: str, *, bold: bool) -> None:
        """Write a line in the font that Pillow brings; it has no bold, so bold is thickened."""
        place = (x - self.left, y - self.top)
        weight = size / 32 if bold else 0
        self.draw.text(place, text, self.ink, _font(size), anchor, stroke_width=weight)


@lru_cache(maxsize=64)
def _font(size: float) -> ImageFont.FreeTypeFont:
    font = ImageFont.load_default(size)
    assert isinstance(font, ImageFont.FreeTypeFont)
    return font
