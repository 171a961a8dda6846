"""Puddles: no two alike, and each the same wherever it is painted."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from babyrobot_levels.render.scene.layout import Layout
from babyrobot_levels.render.scene.paths import Point, curve, smooth
from babyrobot_levels.render.scene.shapes import Ellipse, Path, Shape

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

_POINTS = 12
_FLATTEN = 0.84
_RADIUS = {"small": 14.0, "large": 23.5}
_WAVES = ((1, 0.06), (2, 0.11), (3, 0.09), (4, 0.03))
"""How the outline wavers: waves in a round, and how far they reach as a share of the radius."""
_WHITE = "#ffffff"
_SHORE = "#000000"


def puddle_shapes(level: GridWorld, layout: Layout) -> Iterator[Shape]:
    """Yield the puddles: water, a lighter middle, a highlight, and drops beside small ones."""
    fill = level.resolved_theme.colors.puddle
    for puddle in level.puddles:
        x, y = puddle.at
        centre_x, centre_y = layout.corner(x + 0.5, y + 0.5)
        radius = _RADIUS[puddle.size]
        outline = _outline(x, y, radius)
        if puddle.size == "small":
            yield from _drops(x, y, centre_x, centre_y, radius, fill)
        for scale, colour, opacity in (
            (1.06, _SHORE, 0.22),
            (1.0, fill, 1.0),
            (0.74, _WHITE, 0.16),
        ):
            points = [(centre_x + scale * dx, centre_y + scale * dy) for dx, dy in outline]
            yield Path(smooth(points), fill=colour, opacity=opacity)
        yield _highlight(centre_x, centre_y, radius)
        yield Ellipse(
            centre_x + 0.36 * radius,
            centre_y + 0.3 * radius,
            0.09 * radius,
            0.07 * radius,
            _WHITE,
            0.7,
        )


def _outline(x: int, y: int, radius: float) -> list[Point]:
    """Return points around (0, 0): a circle that wavers, a little flat."""
    phases = [2 * math.pi * _noise(x, y, waves) for waves, _ in _WAVES]
    points = []
    for index in range(_POINTS):
        angle = 2 * math.pi * index / _POINTS
        reach = radius * (
            1
            + sum(
                share * math.cos(waves * angle + phase)
                for (waves, share), phase in zip(_WAVES, phases, strict=True)
            )
        )
        points.append((reach * math.cos(angle), _FLATTEN * reach * math.sin(angle)))
    return points


def _drops(
    x: int, y: int, centre_x: float, centre_y: float, radius: float, fill: str
) -> Iterator[Shape]:
    angle = 2 * math.pi * _noise(x, y, 200)
    for turn, size, distance in ((0.0, 3.4, 1.55), (0.75, 2.2, 1.5)):
        drop_x = centre_x + distance * radius * math.cos(angle + turn)
        drop_y = centre_y + _FLATTEN * distance * radius * math.sin(angle + turn)
        yield Ellipse(drop_x, drop_y, size, _FLATTEN * size, fill)


def _highlight(centre_x: float, centre_y: float, radius: float) -> Path:
    start = (centre_x - 0.56 * radius, centre_y + 0.02 * radius)
    end = (centre_x - 0.02 * radius, centre_y - 0.47 * radius)
    control = (centre_x - 0.5 * radius, centre_y - 0.42 * radius)
    return Path(
        curve(start, control, end), stroke=_WHITE, width=0.1 * radius, cap="round", opacity=0.75
    )


def _noise(x: int, y: int, salt: int) -> float:
    """Return a number in 0..1 that looks drawn by chance and depends on nothing else."""
    mixed = (x * 0x9E3779B1 ^ y * 0x85EBCA77 ^ salt * 0xC2B2AE3D) & 0xFFFFFFFF
    for factor in (0x7FEB352D, 0x846CA68B):
        mixed = ((mixed ^ mixed >> 15) * factor) & 0xFFFFFFFF
    return (mixed ^ mixed >> 16) / 2**32
