"""Metrics beside those that are computed a second time, by their definitions."""

from __future__ import annotations

import itertools
import math
import warnings
from random import Random
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn
from oracles.metrics_reference import SlowMetrics
from oracles.random_things import random_level
from support.worlds import World

import babyrobot_levels as brl

MOST_POLICIES = 64
"""The most policies of levels of which all optimal ones are evaluated."""

MOST = 60
"""The most states of levels that are solved slowly."""


@st.composite
def small_worlds(draw: DrawFn) -> World:
    """Random small levels with a discount, half of them with things."""
    world = random_level(Random(draw(st.integers(0, 10**6))), draw(st.booleans()))
    return {**world, "discount": 0.7}


@pytest.mark.slow
@given(small_worlds())
def test_paths_and_needs_are_what_they_are_defined_to_be(world: World) -> None:
    found, slow = brl.metrics(world), SlowMetrics(world)
    assert (found.path_length, found.detour) == (slow.path_length(), slow.detour())
    assert found.reachable == pytest.approx(slow.reachable())
    assert found.states == len(slow.occurring())
    assert found.needs == slow.needs()
    assert found.dependencies == slow.dependencies()


@pytest.mark.slow
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
    assert found.fragility == pytest.approx(slow.fragility(), abs=1e-9)
    one = {pair: [0] for pair in slow.level.results}
    assert found.random_return == pytest.approx(slow.expected_return(one, 1.0), abs=1e-9)
    if found.success is not None:
        least, perhaps = slow.success(policy, steps=200)
        assert least - 1e-9 <= found.success <= least + perhaps + 1e-9


@pytest.mark.slow
@given(st.integers(0, 10**6), st.booleans(), st.sampled_from([1, 0.7]))
def test_of_all_optimal_policies_the_metrics_take_the_one_that_they_say(
    seed: int, things: bool, discount: float
) -> None:
    level = brl.load({**random_level(Random(seed), things), "discount": discount})
    found = brl.metrics(level)
    assume(found.best_return is not None and math.isfinite(found.best_return))
    assert found.solution is not None
    assert found.best_return is not None
    greedy, shape = found.solution.greedy, found.solution.policy.shape
    ties = [np.flatnonzero(each) for each in greedy.reshape(-1, 5) if each.any()]
    assume(1 < math.prod(map(len, ties)) <= MOST_POLICIES)
    evaluated, losses = [], []
    for actions in itertools.product(*ties):
        policy = np.full(greedy.any(axis=-1).size, 0)
        policy[greedy.any(axis=-1).ravel()] = actions
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)
            one = brl.evaluate(level, policy.reshape(shape))
            weights = 0.9 * np.eye(5)[policy] + 0.1 * random_of(level)
            losses.append(found.best_return - brl.evaluate(level, weights).expected_return)
        if one.expected_return >= found.best_return - 1e-7:
            evaluated.append((one.expected_steps, -one.exit_probability))
    steps = min(evaluated)[0]
    assert found.best_steps == pytest.approx(steps)
    if found.success is not None:
        fastest = (each[1] for each in evaluated if each[0] <= steps + 1e-7)
        assert found.success == pytest.approx(-min(fastest))
    assert found.fragility == pytest.approx(min(losses), abs=1e-9)


def random_of(level: brl.Level) -> Any:
    """Return the probabilities of the policy `random`, `[states, actions]`."""
    mask = level.compile().action_mask.astype(float)
    return mask / mask.sum(axis=1, keepdims=True).clip(1)
