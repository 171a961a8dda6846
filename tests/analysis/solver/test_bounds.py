"""True values lie between the bounds, which are close."""

from __future__ import annotations

from fractions import Fraction
from random import Random
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles.random_things import random_level
from support.combinations import swept

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver.bounds import margins
from babyrobot_levels.analysis.solver.policies import space_of

HOLE = {"at": [2, 1], "ends": True, "reward": -30}
BONUS = {"at": [0, 3], "ends": True, "reward": 7}
LEVELS: dict[str, dict[str, Any]] = {
    "skid": {"skid": {"probability": 0.3, "to": "others"}},
    "ends of both signs": {"skid": 0.4, "areas": [HOLE, BONUS], "rewards": {"exit": 5}},
    "maze": {"maze": {"seed": 2}, "skid": {"probability": 0.7, "to": "open"}},
    "no end for sure": {"blocked": [{"at": [3, 2]}, {"at": [2, 3]}]},
}


def level_of(name: str) -> brl.Level:
    return brl.load({"version": 1, "size": [4, 4], **LEVELS[name]})


def assert_between(level: Any, discount: float) -> None:
    found, true = brl.solve(level, discount), brl.solve(level, discount, exact=True)
    lower, upper = found.bounds
    for value, low, high in zip(true.values.flat, lower.flat, upper.flat, strict=True):
        if isinstance(value, Fraction) and np.isfinite(low):
            assert Fraction(low) <= value <= Fraction(high)
        elif isinstance(value, float):
            np.testing.assert_array_equal([low, high], [value, value])


@pytest.mark.parametrize("discount", [1.0, 0.9])
@pytest.mark.parametrize("name", LEVELS)
def test_bounds_are_close_and_hold(name: str, discount: float) -> None:
    level = level_of(name)
    assert_between(level, discount)
    found = brl.solve(level, discount)
    finite = np.isfinite(found.values)
    size = np.abs(found.values[finite]).max(initial=0.0)
    assert (found.margin[finite] <= 1e-11 * size).all()
    assert (found.margin[finite & (found.values != 0)] > 0).all()


@pytest.mark.slow
@settings(max_examples=10)
@given(seed=st.integers(0, 100_000), discount=st.sampled_from([1.0, 0.95]))
def test_bounds_of_random_levels_hold(seed: int, discount: float) -> None:
    try:
        assert_between(brl.load(random_level(Random(seed))), discount)
    except (brl.UndefinedReturnError, brl.EpisodeTooLongError, brl.NotExactError):
        return


@pytest.mark.parametrize("discount", [1.0, 0.9])
@pytest.mark.parametrize("error", swept([1e-6, -1e-6], [1e-3, 1e-6, -1e-6, -1e-3]))
def test_wrong_values_have_wide_bounds_that_hold(error: float, discount: float) -> None:
    """In one state only, and in all of them."""
    space = space_of(level_of("skid"), "all")
    model, found = space.model(), brl.solve(level_of("skid"), discount)
    true = found.values.ravel()[model.states]
    for which in (np.arange(model.size) == 3, np.ones(model.size, bool)):
        wrong = true + error * which
        margin = margins(model, wrong, discount, 1.0)
        assert (np.abs(wrong - true) <= margin).all()
        assert np.isfinite(margin).all()


def test_where_steps_cost_nothing_values_have_no_bounds_without_a_discount() -> None:
    free = {"version": 1, "size": [3, 3], "skid": 0.4, "rewards": {"step": 0, "exit": 1}}
    assert np.isinf(brl.solve(free).margin).any()
    nothing = {"version": 1, "size": [3, 3], "exit": "none", "rewards": {"step": 0}}
    assert np.isinf(brl.solve(nothing).margin).any()
    assert_between(free, 0.9)
    assert (brl.solve(free, 0.9).margin < 1e-13).all()


def test_within_a_limit_bounds_are_those_of_rounding() -> None:
    level = level_of("skid")
    assert (brl.solve(level, within=20).margin < 1e-12).all()
    lower, upper = brl.solve(level, within=5000).bounds
    value = brl.solve(level).values
    # After so many steps no episode is left.
    assert ((lower <= value + 1e-12) & (value - 1e-12 <= upper)).all()


def test_the_bounds_of_a_part_are_those_of_the_whole() -> None:
    whole = brl.solve("first-key")
    assert whole.at(1).margin.shape == whole.at(1).values.shape
    np.testing.assert_array_equal(whole.at(1).bounds[0], whole.bounds[0][1])
