"""Baby Robot himself, drawn for a cell of 64 pixels; he never leaves his cell."""

from __future__ import annotations

from babyrobot_levels.scene.paths import Point, curve, polyline
from babyrobot_levels.scene.shapes import Ellipse, Path, Rect, Shape
from babyrobot_levels.spec.looks import Theme

_OUTLINE = "#232c38"
_VISOR = "#17202b"
_GLOW = "#8af3ff"
_LAMP = "#ffd54a"
_WHITE = "#ffffff"
_BLACK = "#000000"

_SCALE, _LEFT, _TOP = 0.9, 3.2, 0.8
"""He leaves room for a text below."""


def robot_shapes(theme: Theme, left: float, top: float) -> tuple[Shape, ...]:
    """Return the robot in the cell whose top-left corner is (`left`, `top`) in pixels."""
    body = theme.colors.robot

    def at(x: float, y: float) -> Point:
        return left + _LEFT + _SCALE * x, top + _TOP + _SCALE * y

    def rect(
        x: float,
        y: float,
        width: float,
        height: float,
        radius: float,
        fill: str,
        opacity: float = 1,
    ) -> Rect:
        return Rect(*at(x, y), _SCALE * width, _SCALE * height, fill, _SCALE * radius, opacity)

    def disc(x: float, y: float, rx: float, ry: float, fill: str, opacity: float = 1) -> Ellipse:
        return Ellipse(*at(x, y), _SCALE * rx, _SCALE * ry, fill, opacity)

    antenna = polyline([at(32, 14), at(32, 7)])
    smile = curve(at(29.5, 28.2), at(32, 31), at(34.5, 28.2))
    return (
        disc(32, 50.5, 16, 3, _BLACK, 0.28),
        # Wheels.
        rect(17.5, 41, 9, 10, 4.5, _OUTLINE),
        rect(37.5, 41, 9, 10, 4.5, _OUTLINE),
        disc(22, 46, 1.8, 1.8, _WHITE, 0.55),
        disc(42, 46, 1.8, 1.8, _WHITE, 0.55),
        # Body, with a lamp.
        rect(20.5, 32, 23, 17, 8, _OUTLINE),
        rect(22, 33, 20, 14.5, 6.5, body),
        rect(22, 33, 20, 6, 3, _BLACK, 0.18),
        disc(32, 43, 2.4, 2.4, _LAMP),
        # Antenna and ears.
        Path(antenna, stroke=_OUTLINE, width=_SCALE * 2.4),
        disc(32, 6.2, 3.8, 3.8, _OUTLINE),
        disc(32, 6.2, 2.5, 2.5, _LAMP),
        rect(8.5, 19, 7, 11, 3.5, _OUTLINE),
        rect(48.5, 19, 7, 11, 3.5, _OUTLINE),
        # Head.
        rect(11, 10.5, 42, 28, 13.5, _OUTLINE),
        rect(12.6, 12.1, 38.8, 24.8, 12, body),
        rect(18, 13.4, 28, 4.4, 2.2, _WHITE, 0.5),
        # Visor and face.
        rect(16.5, 17, 31, 16.5, 8.2, _VISOR),
        disc(25.5, 24, 3.4, 4.1, _GLOW),
        disc(38.5, 24, 3.4, 4.1, _GLOW),
        disc(26.7, 22.4, 1.2, 1.2, _WHITE),
        disc(39.7, 22.4, 1.2, 1.2, _WHITE),
        Path(smile, stroke=_GLOW, width=_SCALE * 1.6, cap="round"),
    )
