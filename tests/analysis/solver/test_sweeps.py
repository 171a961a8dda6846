"""Compiled sweeps find what elimination finds, wherever they say that they have found it."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles.random_things import random_level

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver import compiled, linear, model, sweeps
from babyrobot_levels.analysis.solver.policies import space_of

OPEN: dict[str, Any] = {"version": 1, "size": [58, 58], "skid": 0.4}
WALKER = {"within": {"at": [0, 0], "size": [5, 5]}}
THINGS = {**OPEN, "size": [14, 14], "skid": 0.2, "movers": [WALKER]}


@pytest.fixture
def everywhere() -> Iterator[None]:
    """Have levels of all sizes and shapes solved by sweeps."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiled, "MANY_STATES", 1)
        patch.setattr(sweeps, "FEW_NEIGHBOURS", 0)
        yield


def swept(level: dict[str, Any], discount: float) -> object:
    model = space_of(brl.load(level), "all").model()
    return sweeps.swept(model, np.zeros(model.size, np.intp), discount)


def solved_by_elimination(level: Any, discount: float) -> brl.Solution:
    with pytest.MonkeyPatch.context() as patch:
        for module in (model, sweeps):
            patch.setattr(module, "kernel_for", lambda _: None)
        return brl.solve(level, discount)


def assert_same(found: brl.Solution, expected: brl.Solution) -> None:
    size = np.abs(expected.values[np.isfinite(expected.values)]).max(initial=1.0)
    np.testing.assert_allclose(found.values, expected.values, rtol=0, atol=1e-9 * size)
    assert found.expected_return == pytest.approx(expected.expected_return, rel=1e-9, abs=1e-9)
    assert found.expected_steps == pytest.approx(expected.expected_steps, rel=1e-7)
    assert found.exit_probability == pytest.approx(expected.exit_probability, abs=1e-7, nan_ok=True)
    np.testing.assert_array_equal(found.greedy, expected.greedy)
    assert found.residual <= 1e-9 * size


@pytest.mark.slow
@pytest.mark.parametrize("discount", [1.0, 0.99])
@pytest.mark.parametrize("level", [OPEN, THINGS], ids=["open", "things"])
def test_large_levels_are_solved_by_sweeps(level: dict[str, Any], discount: float) -> None:
    assert swept(level, discount) is not None
    assert_same(brl.solve(level, discount), solved_by_elimination(level, discount))


@pytest.mark.sweep
def test_the_policy_found_has_the_values_found() -> None:
    found = brl.solve(OPEN)
    followed = brl.evaluate(OPEN, found)
    np.testing.assert_allclose(followed.values, found.values, rtol=1e-10)
    assert followed.expected_steps == pytest.approx(found.expected_steps, rel=1e-10)
    assert found.exit_probability == 1.0


@settings(max_examples=25)
@given(seed=st.integers(0, 100_000), discount=st.sampled_from([1.0, 0.95, 0.5]))
def test_random_levels_are_solved_alike(seed: int, discount: float) -> None:
    level = brl.load(random_level(Random(seed)))
    try:
        expected = solved_by_elimination(level, discount)
    except (brl.UndefinedReturnError, brl.EpisodeTooLongError):
        return
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiled, "MANY_STATES", 1)
        patch.setattr(sweeps, "FEW_NEIGHBOURS", 0)
        found = brl.solve(level, discount)
    assert_same(found, expected)


@pytest.mark.usefixtures("everywhere")
def test_values_of_loops_that_cost_nothing_are_left_to_elimination() -> None:
    """There, any value above the right one solves the equations too."""
    free = {"version": 1, "size": [8, 8], "skid": 0.4, "rewards": {"step": 0, "exit": 1}}
    assert swept(free, 1.0) is None
    assert swept(free, 0.9) is not None
    assert brl.solve(free, 1.0).expected_return == 1.0


@pytest.mark.usefixtures("everywhere")
def test_a_last_step_of_another_reward_does_not_change_the_steps_that_values_tell() -> None:
    plain = {"version": 1, "size": [6, 6], "skid": 0.4}
    paid = {**plain, "rewards": {"step": -2, "exit": 20}}
    assert brl.solve(paid).expected_steps == pytest.approx(brl.solve(plain).expected_steps)
    assert brl.solve(paid).expected_return == pytest.approx(
        22 - 2 * brl.solve(plain).expected_steps
    )


@pytest.mark.usefixtures("everywhere")
def test_where_holes_end_episodes_too_the_chances_of_an_exit_are_told() -> None:
    level = {"version": 1, "size": [6, 6], "skid": 0.4, "areas": [{"at": [2, 2], "ends": True}]}
    found, expected = brl.solve(level), solved_by_elimination(level, 1.0)
    assert 0 < expected.exit_probability < 1
    assert_same(found, expected)


def test_sweeps_that_do_not_settle_are_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweeps, "MOST_SWEEPS", 3)
    assert swept(OPEN, 1.0) is None
    assert brl.solve(OPEN).residual < 1e-9 * 300


def test_mazes_are_left_to_elimination() -> None:
    maze = {**OPEN, "maze": {"seed": 1}}
    assert swept(maze, 1.0) is None
    assert linear.DENSE_STATES < 58 * 58
