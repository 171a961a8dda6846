"""Optima of partial observation beside those of a slow solver that was written apart."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest
from extensions.sight.by_fractions import Beliefs
from extensions.sight.cases import levels_of, sight_of, slow_solver

from babyrobot_levels.extensions.sight.solve import SightSolution, solve_sight

STEPS = 3


def check(seed: int) -> None:
    """Compare the optima of a case: within a limit of steps, and without one."""
    levels, options = levels_of(seed), sight_of(seed)
    steps = Random(seed).choice((1, 2, 3, 4))
    slow = slow_solver(levels, options, Fraction(1, 2))
    found = solve_sight(levels, discount=0.5, within=steps, **options)
    assert found.is_exact
    assert found.upper == pytest.approx(float(slow.within(steps)), abs=1e-9)
    check_sides(solve_sight(levels, discount=0.5, within=steps, beliefs=2, **options), found.upper)
    found = solve_sight(levels, discount=0.5, beliefs=300, **options)
    check_bounds(found, slow)
    if found.is_exact:
        check_sides(solve_sight(levels, discount=0.5, beliefs=2, **options), found.upper)


def check_sides(few: SightSolution, optimum: float) -> None:
    """Check that bounds of few beliefs are on their sides, also where they are cut off later."""
    found = few._search.found
    assert found.lower - 1e-9 <= few.lower <= optimum + 1e-9
    assert found.lower <= optimum + 1e-9
    assert found.upper >= few.upper >= optimum - 1e-9


def check_bounds(found: SightSolution, slow: Beliefs) -> None:
    """Compare bounds with the optimum, or with what is left to it after some steps."""
    assert found.lower <= found.upper <= found.full + 1e-9
    beliefs = slow.reachable(120)
    if beliefs is not None:
        assert found.is_exact
        assert found.upper == pytest.approx(slow.without_limit(beliefs), abs=1e-9)
        return
    # What is over gives nothing.
    rewards = [0.0, *slow.rewards()]
    earned, rest = float(slow.within(STEPS)), 0.5**STEPS / (1 - 0.5)
    assert found.lower <= earned + rest * max(rewards) + 1e-9
    assert found.upper >= earned + rest * min(rewards) - 1e-9


@pytest.mark.sweep
@pytest.mark.parametrize("part", range(28))
def test_optima_are_those_of_the_slow_solver(part: int) -> None:
    for seed in range(11 * part, 11 * part + 11):
        check(seed)


def check_undiscounted(seed: int) -> bool:
    """Compare optima without a discount, where all rewards are costs, or none is one."""
    levels, options = levels_of(seed), sight_of(seed)
    sign = -1 if seed % 2 else 1
    for fields in levels:
        fields["rewards"] = {"step": -1} if seed % 2 else {"step": 0, "exit": 1}
    slow = slow_solver(levels, options)
    beliefs = slow.reachable(60)
    if beliefs is None or min(sign * reward for reward in slow.rewards()) < 0:
        return False
    optimum = slow.without_limit(beliefs)
    found = solve_sight(levels, **options)
    assert found.is_exact
    check_sides(solve_sight(levels, beliefs=2, **options), found.upper)
    if optimum is None:
        assert found.upper in (float("inf"), -float("inf"))
    else:
        assert found.upper == pytest.approx(optimum, abs=1e-9)
    return True


@pytest.mark.slow
def test_undiscounted_optima_are_those_of_the_slow_solver() -> None:
    assert sum(check_undiscounted(seed) for seed in range(22)) >= 5


@pytest.mark.sweep
def test_more_undiscounted_optima_are_those_of_the_slow_solver() -> None:
    assert sum(check_undiscounted(seed) for seed in range(22, 300)) >= 60
