"""Metrics are facts of a level: its mirror images and turns have the same ones."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.random_things import random_level
from support.images import images

import babyrobot_levels as brl


@pytest.mark.slow
@given(st.integers(0, 10**6), st.booleans(), st.sampled_from([1, 0.9]), st.integers(0, 6))
def test_an_image_has_the_metrics_of_the_level(
    seed: int, things: bool, discount: float, number: int
) -> None:
    world = random_level(Random(seed), things) | {"discount": discount}
    image = [*images(world)][number]
    expected, found = brl.metrics(world).to_dict(), brl.metrics(image).to_dict()
    for name, value in expected.items():
        is_number = isinstance(value, float) and found[name] is not None
        same = pytest.approx(value, rel=1e-7, abs=1e-8) if is_number else value
        assert found[name] == same, name


def test_eight_images_are_those_of_a_level_without_any_symmetry() -> None:
    world = {"version": 1, "size": [3, 4], "start": [1, 0], "exit": [0, 3]}
    found = [brl.load(each).digest for each in (world, *images(world))]
    assert len({*found}) == 8
