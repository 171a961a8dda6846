"""What a level looks like: ends, rewards, slippery cells, glass, wind and warps."""

from __future__ import annotations

from typing import Any

import pytest

from babyrobot_levels.library.level import Level
from babyrobot_levels.render.scene.build import build_base
from babyrobot_levels.render.scene.layout import CELL
from babyrobot_levels.render.scene.shapes import Path, Shape, Text

MARGIN = 3
"""The default theme's free space: half of its outer wall, in whole pixels."""


def level(**fields: Any) -> Any:
    display = {"start_text": False, "exit_text": False}
    return Level.from_fields({"version": 1, "size": [5, 5], "display": display, **fields})


def texts(world: Any) -> dict[str, tuple[float, float]]:
    """Return the texts of a picture, and the cell coordinates where they are, with fractions."""
    return {
        shape.text: ((shape.x - MARGIN) / CELL, (shape.y - MARGIN) / CELL)
        for shape in build_base(world).shapes
        if isinstance(shape, Text)
    }


def added(world: Any, plain: Any) -> list[Shape]:
    """Return the shapes that only the first of two pictures has."""
    known = set(build_base(plain).shapes)
    return [shape for shape in build_base(world).shapes if shape not in known]


# -- glass ---------------------------------------------------------------------------------


def test_glass_says_how_often_it_lets_the_robot_through_once_for_each_stretch() -> None:
    walls = [
        {"at": [0, 0], "side": "E", "length": 3, "pass": 0.3},
        {"at": [0, 3], "side": "E", "pass": 0.8},
        {"at": [3, 2], "side": "S", "pass": 1},
    ]
    found = texts(level(walls=walls))
    assert set(found) == {"30%", "80%", "100%"}
    assert found["30%"] == (1, pytest.approx(1.5, abs=0.1))
    assert found["80%"] == (1, pytest.approx(3.5, abs=0.1))
    assert found["100%"] == (3.5, pytest.approx(3, abs=0.1))


@pytest.mark.parametrize(("chance", "text"), [(0.004, "<1%"), (0.996, ">99%"), (1 / 3, "33%")])
def test_rounded_chances_are_never_told_as_certain(chance: float, text: str) -> None:
    assert set(texts(level(walls=[{"at": [1, 1], "side": "S", "pass": chance}]))) == {text}


def test_glass_that_is_not_drawn_has_no_number() -> None:
    wall = {"at": [1, 1], "side": "S", "pass": 0.5, "width": 0}
    assert texts(level(walls=[wall])) == {}


def test_glass_has_more_gaps_the_more_often_it_lets_the_robot_through() -> None:
    def gap(chance: float) -> float:
        wall = {"at": [1, 1], "side": "S", "pass": chance}
        lines = (s for s in added(level(walls=[wall]), level()) if isinstance(s, Path))
        (share,) = {0.0 if s.dash is None else s.dash[1] / sum(s.dash) for s in lines}
        return share

    assert gap(0.1) < gap(0.5) < gap(0.99)
