"""A figure that can lean and hop: shapes in its own box of 64 by 64, brought into a picture."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from babyrobot_levels.render.scene.shapes import (
    Command,
    Ellipse,
    Path,
    Point,
    Rect,
    circle,
    rounded,
)

_SCALE, _LEFT, _TOP = 0.9, 3.2, 0.8
"""A figure leaves room for a text below."""


@dataclass(frozen=True, slots=True)
class Figure:
    """Where a figure stands, and how.

    Attributes:
        left: the left edge of its cell in the picture.
        top: the upper edge of its cell.
        lean: the angle by which it leans to the right, in degrees.
        lift: how far it is above the ground.
        pivot: the point around which it leans.
    """

    left: float
    top: float
    lean: float = 0.0
    lift: float = 0.0
    pivot: Point = (32.0, 46.0)

    def at(self, x: float, y: float) -> Point:
        """Return a point of the figure in the picture."""
        if self.lean:
            dx, dy = x - self.pivot[0], y - self.pivot[1]
            cos, sin = math.cos(math.radians(self.lean)), math.sin(math.radians(self.lean))
            x, y = self.pivot[0] + cos * dx - sin * dy, self.pivot[1] + sin * dx + cos * dy
        return self.left + _LEFT + _SCALE * x, self.top + _TOP + _SCALE * (y - self.lift)

    def bar(
        self,
        x: float,
        y: float,
        width: float,
        height: float,
        radius: float,
        fill: str,
        opacity: float = 1.0,
    ) -> Rect | Path:
        """Return a rectangle with round corners; `x`, `y` is its upper left one."""
        if self.lean:
            outline = self._bent(rounded(x, y, width, height, radius))
            return Path(outline, fill=fill, opacity=opacity)
        corner = self.at(x, y)
        return Rect(*corner, _SCALE * width, _SCALE * height, fill, _SCALE * radius, opacity)

    def disc(
        self, x: float, y: float, rx: float, ry: float, fill: str, opacity: float = 1.0
    ) -> Ellipse | Path:
        """Return an ellipse; `x`, `y` is its centre."""
        if self.lean and rx != ry:
            outline = self._bent(circle(x, y, rx, ry))
            return Path(outline, fill=fill, opacity=opacity)
        return Ellipse(*self.at(x, y), _SCALE * rx, _SCALE * ry, fill, opacity)

    def line(self, commands: Iterable[Command], stroke: str, width: float) -> Path:
        """Return a line with round ends."""
        return Path(self._bent(commands), stroke=stroke, width=_SCALE * width, cap="round")

    def patch(self, commands: Iterable[Command], fill: str) -> Path:
        """Return a filled outline."""
        return Path(self._bent(commands), fill=fill)

    def _bent(self, commands: Iterable[Command]) -> tuple[Command, ...]:
        return tuple(
            (
                letter,
                tuple(
                    place
                    for x, y in zip(numbers[::2], numbers[1::2], strict=True)
                    for place in self.at(x, y)
                ),
            )
            for letter, numbers in commands
        )
