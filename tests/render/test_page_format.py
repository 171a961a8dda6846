"""Packed shapes: few characters, and still the same shapes."""

from __future__ import annotations

import math

from babyrobot_levels.render.page_format import AGAIN, ELLIPSE, PATH, RECT, TEXT, Palette, pack
from babyrobot_levels.render.scene.shapes import (
    Ellipse,
    Path,
    Rect,
    Shape,
    Text,
    polygon,
    polyline,
    smooth,
)


def packed(*shapes: Shape, margin: float = 0) -> list[list[object]]:
    """Return shapes of one cell, packed, without their group."""
    ((_, _, found),) = pack(shapes, Palette(), margin)
    return list(found)


def test_what_is_usual_is_left_out() -> None:
    rect, ellipse = Rect(1, 2, 3, 4, "red"), Ellipse(1, 2, 3, 4, "red")
    text = Text(1, 2, "hi", 9, "red")
    assert packed(rect, ellipse, text) == [
        [RECT, 0, 10, 20, 30, 40],
        [ELLIPSE, 0, 10, 20, 30, 40],
        [TEXT, 0, 10, 20, "hi", 90],
    ]
    assert packed(Rect(1, 2, 3, 4, "red", radius=2)) == [[RECT, 0, 10, 20, 30, 40, 100, 20]]
    assert packed(Rect(1, 2, 3, 4, "red", opacity=0.25)) == [[RECT, 0, 10, 20, 30, 40, 25]]
    assert packed(Text(1, 2, "hi", 9, "red", "end", True, 0.5)) == [
        [TEXT, 0, 10, 20, "hi", 90, 2, 1, 50]
    ]


def test_paths_are_told_step_by_step() -> None:
    line = polyline([(1, 1), (3, 0), (3, 5)])
    assert packed(Path(line, stroke="red", width=2, cap="round", dash=(4, 3))) == [
        [PATH, -1, "m10 10l20-10l0 50", 100, 0, 20, 1, 40, 30]
    ]
    triangle = polygon([(0, 0), (2, 0), (0, 2)])
    assert packed(Path(triangle, fill="red")) == [[PATH, 0, "m0 0l20 0l-20 20z"]]


def test_smooth_outlines_are_told_by_their_points() -> None:
    points = [(10.0, 5.0), (5.0, 10.0), (1.0, 5.0), (5.0, 0.0)]
    assert packed(Path(smooth(points), fill="red")) == [[PATH, 0, "s100 50-50 50-40-50 40-50"]]


def test_the_same_outline_in_another_size_is_not_told_twice() -> None:
    points = [(30 + 9 * math.cos(turn), 20 + 8 * math.sin(turn)) for turn in range(6)]
    larger = [(30 + 1.25 * (x - 30), 20 + 1.25 * (y - 20)) for x, y in points]
    other = [*larger[:-1], (31.0, 22.0)]
    first, second, third = (Path(smooth(each), fill="red") for each in (points, larger, other))
    assert packed(first, second)[1] == [AGAIN, 0, 1250, 300, 200]
    assert packed(first, third)[1][0] == PATH
    # Nor is one that has a line of its own, which could not be told then,
    drawn = Path(smooth(larger), fill="red", stroke="red")
    assert packed(first, drawn)[1][0] == PATH
    # nor a path that is moved without growing, which has no point that stays.
    moved = Path(smooth([(x + 1, y) for x, y in points]), fill="red")
    assert packed(first, moved)[1][0] == PATH


def test_all_sizes_of_an_outline_are_told_by_the_one_that_stands_there() -> None:
    # Whoever paints them has no other outline than that of the path.
    sizes = [
        [(30 + size * math.cos(turn), 20 + size * math.sin(turn)) for turn in range(6)]
        for size in (20, 16, 10)
    ]
    _, second, third = packed(*(Path(smooth(points), fill="red") for points in sizes))
    assert second == [AGAIN, 0, 800, 300, 200]
    assert third == [AGAIN, 0, 500, 300, 200]


def test_what_is_alike_in_two_cells_is_written_alike() -> None:
    shapes = [Rect(3 + 64 * x, 3 + 64, 10, 10, "red") for x in (0, 2)]
    first, second = pack(shapes, Palette(), 3)
    assert (first[:2], second[:2]) == ([30, 670], [1310, 670])
    assert first[2] == second[2]


def test_colors_are_told_once_and_in_one_way() -> None:
    palette = Palette(["robot"])
    places = [
        palette.place(color)
        for color in ("red", "#f00", None, "rgba(255, 0, 0, 0.5)", "transparent", "robot")
    ]
    assert places == [0, 0, -1, 1, 2, 3]
    assert palette.colors == ["#ff0000", "#ff000080", "#00000000", "robot"]
