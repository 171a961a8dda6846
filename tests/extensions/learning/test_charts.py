"""Curves: what they show, where, and that it can be seen."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET

import pytest

from babyrobot_levels.extensions.learning import charts
from babyrobot_levels.extensions.learning.charts import Curve, curves_svg
from babyrobot_levels.render.colors import contrast

SVG = "{http://www.w3.org/2000/svg}"


def drawn(*shown: Curve, goal: tuple[str, float] | None = None) -> ET.Element:
    return ET.fromstring(curves_svg(shown, goal=goal, x_title="sweep", y_title="return"))


def lines(root: ET.Element) -> list[list[tuple[float, float]]]:
    found = (element.attrib["points"].split() for element in root.iter(f"{SVG}polyline"))
    return [[(float(x), float(y)) for x, y in (p.split(",") for p in points)] for points in found]


def texts(root: ET.Element) -> list[str]:
    return [element.text or "" for element in root.iter(f"{SVG}text")]


def test_a_curve_rises_towards_the_dashed_line_that_it_should_reach() -> None:
    root = drawn(Curve("estimate", [(0, -10), (5, -4), (10, -2)]), goal=("optimum", -1))
    ((first, second, third),) = lines(root)
    assert first[0] < second[0] < third[0]
    assert second[0] - first[0] == pytest.approx(third[0] - second[0], abs=0.02)
    assert first[1] > second[1] > third[1]
    dashed = [e.attrib["d"] for e in root.iter(f"{SVG}path") if "stroke-dasharray" in e.attrib]
    (goal,) = (route for route in dashed if "H" in route)
    y = float(goal.split("H")[0].split()[1])
    assert first[1] - y == pytest.approx(9 * (third[1] - y), rel=0.01)
    assert {"estimate", "optimum", "sweep", "return", "-10", "0", "10"} <= {*texts(root)}


def test_curves_of_large_values_fill_the_height() -> None:
    (line,) = lines(drawn(Curve("a", [(0, 100.0), (1, 103.0), (2, 101.0)])))
    heights = [y for _, y in line]
    assert max(heights) - min(heights) > 0.5 * charts.HEIGHT


def test_what_is_infinite_is_left_out() -> None:
    points = [(0, -math.inf), (1, math.nan), (2, 3.0), (3, 4.0)]
    assert len(lines(drawn(Curve("a", points), goal=("b", math.inf)))[0]) == 2
    assert "b" not in texts(drawn(Curve("a", points), goal=("b", math.inf)))
    assert curves_svg([Curve("a", points[:2])], goal=None, x_title="x", y_title="y") == ""
    assert curves_svg([], goal=None, x_title="x", y_title="y") == ""


def test_a_single_point_is_a_dot() -> None:
    root = drawn(Curve("a", [(1, 7.0)]), goal=("b", 7.0))
    assert lines(root) == []
    (dot,) = root.iter(f"{SVG}circle")
    assert 0 < float(dot.attrib["cx"]) < charts.WIDTH
    assert 0 < float(dot.attrib["cy"]) < charts.HEIGHT


def test_a_long_curve_is_thinned_out_and_keeps_its_end() -> None:
    (line,) = lines(drawn(Curve("a", [(x, float(x)) for x in range(10_007)])))
    assert len(line) <= charts.MAX_POINTS + 1
    assert line[-1][0] == charts.WIDTH - 16


def test_names_are_escaped() -> None:
    assert "a & <b>" in texts(drawn(Curve("a & <b>", [(0, 1.0), (1, 2.0)])))


def test_lines_and_texts_stand_out_from_the_ground() -> None:
    for color, least in (
        (charts.STRONG, 4.5),
        (charts.FAINT, 3),
        (charts._GOAL, 4.5),
        (charts._INK, 4.5),
    ):
        assert contrast(color, charts._GROUND) >= least, color
