"""Metrics beside those that are computed a second time, by their definitions."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn
from oracles.metrics_reference import SlowMetrics
from oracles.random_things import random_level
from support.worlds import World

import babyrobot_levels as brl

MOST = 60
"""The most states of levels that are solved slowly."""


@st.composite
def small_worlds(draw: DrawFn) -> World:
    """Random small levels with a discount, half of them with things."""
    world = random_level(Random(draw(st.integers(0, 10**6))), draw(st.booleans()))
    return {**world, "discount": 0.7}


@given(small_worlds())
def test_paths_and_needs_are_what_they_are_defined_to_be(world: World) -> None:
    found, slow = brl.metrics(world), SlowMetrics(world)
    assert (found.path_length, found.detour) == (slow.path_length(), slow.detour())
    assert found.reachable == pytest.approx(slow.reachable())
    assert found.states == len(slow.occurring())
    assert found.needs == slow.needs()
    assert found.dependencies == slow.dependencies()


@given(small_worlds())
def test_mistakes_and_distractors_are_what_they_are_defined_to_be(world: World) -> None:
    slow = SlowMetrics(world)
    assume(len(slow.level.results) <= MOST)
    found = brl.metrics(world)
    assert found.best_return == pytest.approx(slow.optimum(), abs=1e-9)
    assert found.irreversible == pytest.approx(slow.irreversible())
    assert found.decisions == slow.decisions()
    assert found.distractors == slow.distractors()
    solution = found.solution
    assert solution is not None
    policy = {
        slow.level.pair(state): action
        for state, action in enumerate(solution.policy.ravel().tolist())
        if action >= 0
    }
    assert found.fragility == pytest.approx(slow.fragility(policy), abs=1e-9)
    assert found.random_return == pytest.approx(slow.expected_return(policy, 1.0), abs=1e-9)
    if found.success is not None:
        least, perhaps = slow.success(policy, steps=200)
        assert least - 1e-9 <= found.success <= least + perhaps + 1e-9
