"""Metrics beside those that are computed a second time, by their definitions."""

from __future__ import annotations

from random import Random

from hypothesis import given
from hypothesis import strategies as st
from oracles.metrics_reference import SlowMetrics
from oracles.random_things import random_level
from support.worlds import World

import babyrobot_levels as brl

small_worlds = st.builds(
    lambda seed, things: random_level(Random(seed), things), st.integers(0, 10**6), st.booleans()
)


@given(small_worlds)
def test_states_and_needs_are_what_they_are_defined_to_be(world: World) -> None:
    found, slow = brl.metrics(world), SlowMetrics(world)
    assert found.states == len(slow.occurring())
    assert found.needs == slow.needs()
    assert found.dependencies == slow.dependencies()
