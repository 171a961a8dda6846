"""Scales: numbers as colours that everybody can order and read."""

from __future__ import annotations

import math

import pytest

from babyrobot_levels.language.looks import BUILTIN_THEMES, Colors
from babyrobot_levels.render.colors import BLACK, contrast, rgba
from babyrobot_levels.render.scene.heat import STEPS, count_scale, scale_of

THEMES = sorted(BUILTIN_THEMES)


def colors_of(theme: str) -> Colors:
    return BUILTIN_THEMES[theme].colors


def lightness(color: str) -> float:
    return contrast(color, BLACK)


@pytest.mark.parametrize("theme", THEMES)
def test_lightness_orders_numbers_of_one_sign(theme: str) -> None:
    for low, high in ((0.0, 1.0), (-40.0, 0.0), (3.0, 5.0)):
        scale = scale_of([high, None, low, math.inf], colors_of(theme))
        ramp = [lightness(scale.color(low + (high - low) * step / 16)) for step in range(17)]
        assert ramp in (sorted(ramp), sorted(ramp, reverse=True))
        assert max(ramp) / min(ramp) > 2.5
        assert not scale.is_diverging


@pytest.mark.parametrize("theme", THEMES)
def test_numbers_of_both_signs_diverge_from_zero(theme: str) -> None:
    scale = scale_of([-5.0, 20.0], colors_of(theme))
    assert scale.is_diverging
    assert scale.color(0.0) == scale.colors[STEPS // 2]
    assert scale.color(20.0) == scale.colors[-1]
    assert scale.color(-20.0) == scale.colors[0]
    red, _, blue, _ = rgba(scale.color(-20.0))
    if theme != "print":
        # Orange and blue: nobody takes one for the other.
        assert red > blue + 100
        red, _, blue, _ = rgba(scale.color(20.0))
        assert blue > red + 100


def test_a_sign_that_is_rounding_is_none() -> None:
    assert not scale_of([-36.0, 1e-12], colors_of("default")).is_diverging
    assert scale_of([-36.0, 1e-3], colors_of("default")).is_diverging


@pytest.mark.parametrize("theme", THEMES)
def test_infinite_values_have_colours_of_their_own(theme: str) -> None:
    for values in ([0.0, 1.0], [-1.0, 1.0]):
        scale = scale_of([*values, math.inf, -math.inf], colors_of(theme))
        ends = {scale.color(math.inf), scale.color(-math.inf)}
        assert len(ends) == 2
        assert not ends & {*scale.colors}


def test_equal_numbers_have_a_colour_too() -> None:
    for value in (-3.0, 0.0, 7.0):
        scale = scale_of([value, value], colors_of("default"))
        assert scale.color(value) == scale.colors[STEPS // 2]
    assert scale_of([None, math.inf], colors_of("default")).low == 0


def test_counts_grow_with_their_logarithm() -> None:
    scale = count_scale([0, 1, 10, 10_000, None], colors_of("default"))
    places = [scale.colors.index(scale.color(count)) for count in (0, 1, 10, 100, 10_000)]
    assert places == sorted(places)
    assert (places[0], places[-1]) == (0, STEPS)
    # A hundredth of the largest count is about half as strong.
    assert STEPS / 3 < places[3] < 2 * STEPS / 3
    assert count_scale([0, None], colors_of("default")).color(0) == scale.colors[0]
