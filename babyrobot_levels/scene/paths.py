"""Paths from points: lines, polygons, arcs and smooth outlines."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from babyrobot_levels.scene.shapes import Command

Point = tuple[float, float]


def polyline(points: Iterable[Point]) -> tuple[Command, ...]:
    """Return straight lines from point to point."""
    return tuple(("L" if index else "M", point) for index, point in enumerate(points))


def polygon(points: Iterable[Point]) -> tuple[Command, ...]:
    """Return straight lines from point to point and back to the first."""
    return (*polyline(points), ("Z", ()))


def curve(start: Point, control: Point, end: Point) -> tuple[Command, ...]:
    """Return a quadratic Bézier curve, as the cubic one that it is."""
    first = tuple(a + 2 / 3 * (b - a) for a, b in zip(start, control, strict=True))
    second = tuple(a + 2 / 3 * (b - a) for a, b in zip(end, control, strict=True))
    return ("M", start), ("C", (*first, *second, *end))


def smooth(points: Sequence[Point]) -> tuple[Command, ...]:
    """Return the closed smooth curve through the points (a Catmull-Rom spline)."""
    commands: list[Command] = [("M", points[0])]
    count = len(points)
    for index, (x, y) in enumerate(points):
        before_x, before_y = points[index - 1]
        next_x, next_y = points[(index + 1) % count]
        after_x, after_y = points[(index + 2) % count]
        commands.append(
            (
                "C",
                (
                    x + (next_x - before_x) / 6,
                    y + (next_y - before_y) / 6,
                    next_x - (after_x - x) / 6,
                    next_y - (after_y - y) / 6,
                    next_x,
                    next_y,
                ),
            )
        )
    return (*commands, ("Z", ()))
