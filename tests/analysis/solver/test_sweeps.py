"""Large levels are solved by machine code as they are without it."""

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
from babyrobot_levels.analysis.solver import compiled, model, sweeps

OPEN: dict[str, Any] = {"version": 1, "size": [58, 58], "skid": 0.4}
WALKER = {"within": {"at": [0, 0], "size": [5, 5]}}
THINGS = {**OPEN, "size": [14, 14], "skid": 0.2, "movers": [WALKER]}


MAZE: dict[str, Any] = {"version": 1, "size": [58, 58], "skid": 0.2, "maze": {"seed": 1}}
DRY = {**MAZE, "skid": 0}
WINDY = {**OPEN, "wind": {"north": [0, 1] * 29}}
FREE = {"version": 1, "size": [8, 8], "skid": 0.4, "rewards": {"step": 0, "exit": 1}}
ENDLESS = {**OPEN, "exit": "none"}
PAID = {**OPEN, "size": [9, 9], "areas": [{"at": [3, 3], "ends": True, "reward": 20}]}


# What is tested is compiled first, which takes half a minute.
pytestmark = pytest.mark.slow


@pytest.fixture
def everywhere() -> Iterator[None]:
    """Have levels of all sizes solved by machine code."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiled, "MANY_STATES", 1)
        yield


def solved_by_elimination(level: Any, discount: float) -> brl.Solution:
    with pytest.MonkeyPatch.context() as patch:
        for module in (model, sweeps):
            patch.setattr(module, "is_compiled", lambda _: False)
        solution = brl.solve(level, discount)
        assert solution.policy is not None  # It is found when it is asked for.
        return solution


def assert_same(found: brl.Solution, expected: brl.Solution) -> None:
    size = np.abs(expected.values[np.isfinite(expected.values)]).max(initial=1.0)
    np.testing.assert_allclose(found.values, expected.values, rtol=0, atol=1e-9 * size)
    assert found.expected_return == pytest.approx(expected.expected_return, rel=1e-9, abs=1e-9)
    assert found.expected_steps == pytest.approx(expected.expected_steps, rel=1e-7)
    assert found.exit_probability == pytest.approx(expected.exit_probability, abs=1e-7, nan_ok=True)
    np.testing.assert_array_equal(found.greedy, expected.greedy)
    assert found.residual <= 1e-9 * size


@pytest.mark.parametrize("discount", [1.0, 0.99])
@pytest.mark.parametrize(
    "level", [OPEN, THINGS, MAZE, DRY, WINDY], ids=["open", "things", "maze", "dry", "windy"]
)
def test_large_levels_are_solved_alike(level: dict[str, Any], discount: float) -> None:
    found = brl.solve(level, discount)
    assert found.method.startswith("sweeps")
    assert_same(found, solved_by_elimination(level, discount))


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
        found = brl.solve(level, discount)
    assert_same(found, expected)


@pytest.mark.usefixtures("everywhere")
@pytest.mark.parametrize("discount", [1.0, 0.9])
@pytest.mark.parametrize("level", [FREE, PAID], ids=["free", "paid"])
def test_values_begin_with_those_of_a_policy_where_steps_cost_nothing(
    level: dict[str, Any], discount: float
) -> None:
    """There, any value above the right one solves the equations too."""
    assert_same(brl.solve(level, discount), solved_by_elimination(level, discount))


@pytest.mark.usefixtures("everywhere")
def test_levels_without_an_end_are_solved_alike() -> None:
    assert_same(brl.solve(ENDLESS, 0.99), solved_by_elimination(ENDLESS, 0.99))


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


def test_what_is_not_found_is_left_to_elimination(monkeypatch: pytest.MonkeyPatch) -> None:
    from babyrobot_levels.analysis.solver.compiled import iteration

    monkeypatch.setattr(iteration, "MOST_ROUNDS", 0)
    monkeypatch.setattr(iteration, "FAST", 0)
    found = brl.solve({**OPEN, "skid": {"probability": 0.8, "to": "open"}})
    assert found.method == "policy iteration"
    assert found.residual < 1e-9 * 300
