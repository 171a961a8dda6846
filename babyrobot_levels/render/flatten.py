"""Paths as straight lines: for painters that know neither curves nor dashes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

from babyrobot_levels.render.scene.shapes import Command, Point

Polyline = tuple[list[Point], bool]
"""Points, and whether the last is joined to the first."""

_MAX_PARTS = 64


def polylines(commands: tuple[Command, ...], scale: float = 1.0) -> list[Polyline]:
    """Return the pieces of a path as points; curves become lines that look smooth at `scale`."""
    pieces: list[Polyline] = []
    for letter, numbers in commands:
        if letter == "M":
            pieces.append(([(numbers[0], numbers[1])], False))
        elif letter == "Z":
            pieces[-1] = pieces[-1][0], True
        elif letter == "L":
            pieces[-1][0].append((numbers[0], numbers[1]))
        else:
            points = pieces[-1][0]
            points += _cubic(points[-1], numbers, scale)
    return pieces


def _cubic(start: Point, numbers: tuple[float, ...], scale: float) -> Iterator[Point]:
    x1, y1, x2, y2, x3, y3 = numbers
    x0, y0 = start
    length = math.dist(start, (x1, y1)) + math.dist((x1, y1), (x2, y2))
    length += math.dist((x2, y2), (x3, y3))
    parts = min(_MAX_PARTS, 3 + int(math.sqrt(length * scale)))
    for part in range(1, parts + 1):
        t = part / parts
        u = 1 - t
        a, b, c, d = u * u * u, 3 * u * u * t, 3 * u * t * t, t * t * t
        yield a * x0 + b * x1 + c * x2 + d * x3, a * y0 + b * y1 + c * y2 + d * y3


def dashes(line: Polyline, dash: float, gap: float) -> Iterator[Polyline]:
    """Yield the dashes of a line; it begins with one."""
    points, closed = line
    points = [*points, points[0]] if closed else points
    drawing, left = True, dash
    current = [points[0]]
    for start, end in pairwise(points):
        length, done = math.dist(start, end), 0.0
        while length - done > left:
            done += left
            share = done / length
            cut = (
                start[0] + share * (end[0] - start[0]),
                start[1] + share * (end[1] - start[1]),
            )
            if drawing:
                yield [*current, cut], False
            current = [cut]
            drawing, left = not drawing, gap if drawing else dash
        left -= length - done
        current.append(end)
    if drawing and len(current) > 1:
        yield current, False
