"""Dynamic programming, sweep by sweep: against the exact solver and the book's own numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.worlds import World, level_of, worlds

from babyrobot_levels.analysis.solver.evaluation import evaluate, evaluation_of
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.extensions.learning.algorithms import (
    policy_evaluation,
    policy_iteration,
    value_iteration,
)
from babyrobot_levels.extensions.learning.results import Sweep

# Holes; glass; a discount; ends that are no exits; warps.
LEVELS = ["frozen-lake", "glasshouse", "gridworld-3-5", "russell-norvig-4x3", "teleport-pads"]

# Figure 4.1: the upper half of each table; the lower one is the same turned round.
FIGURE = {
    0: [[0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0]],
    1: [[0.0, -1.0, -1.0, -1.0], [-1.0, -1.0, -1.0, -1.0]],
    2: [[0.0, -1.7, -2.0, -2.0], [-1.7, -2.0, -2.0, -2.0]],
    3: [[0.0, -2.4, -2.9, -3.0], [-2.4, -2.9, -3.0, -2.9]],
    10: [[0.0, -6.1, -8.4, -9.0], [-6.1, -7.7, -8.4, -8.4]],
}
IN_THE_END = [[0.0, -14.0, -20.0, -22.0], [-14.0, -18.0, -20.0, -20.0]]

PAYS_FOR_EVER: World = {"version": 1, "size": [2, 1], "exit": "none", "rewards": {"step": 1}}

# Nobody comes out of the cell below the start, and the glass may keep the robot where it is.
BESIDE_A_TRAP: World = {
    "version": 1,
    "size": [2, 2],
    "start": [0, 0],
    "exit": [1, 0],
    "blocked": [{"at": [1, 1]}],
    "walls": [{"at": [0, 0], "side": "E", "pass": 0.5}],
    "warps": [{"at": [0, 1], "to": [0, 1], "when": "leave"}],
}


def whole(upper: list[list[float]]) -> list[list[float]]:
    return upper + [row[::-1] for row in upper[::-1]]


def rounded(values: Any) -> Any:
    """Round to one decimal as the book does: what lies halfway goes up, -1.75 to -1.7."""
    return np.floor(values * 10 + 0.5 + 1e-9) / 10


def last(sweeps: Iterator[Sweep]) -> Sweep:
    *_, sweep = sweeps
    return sweep


@pytest.mark.parametrize("name", LEVELS)
def test_value_iteration_converges_to_the_optimum(name: str) -> None:
    sweeps = list(value_iteration(name))
    solution = solve(name)
    assert sweeps[-1].delta <= 1e-10
    assert [sweep.number for sweep in sweeps] == list(range(len(sweeps)))
    np.testing.assert_allclose(sweeps[-1].values, solution.values, rtol=0, atol=1e-8)


def test_with_a_discount_the_changes_become_ever_smaller() -> None:
    deltas = [sweep.delta for sweep in value_iteration("glasshouse", 0.9)]
    assert deltas[0] == np.inf
    for before, after in pairwise(deltas[1:]):
        assert after <= 0.9 * before + 1e-12


def test_evaluating_the_random_policy_is_as_in_the_book() -> None:
    sweeps = {
        sweep.number: sweep
        for sweep in policy_evaluation("gridworld-4-1", "uniform", actions="moves")
    }
    for number, upper in FIGURE.items():
        assert rounded(sweeps[number].values).tolist() == whole(upper), number
    assert rounded(sweeps[max(sweeps)].values).tolist() == whole(IN_THE_END)


def test_the_greedy_policy_is_optimal_after_three_sweeps_as_in_the_book() -> None:
    sweeps = policy_evaluation("gridworld-4-1", "uniform", actions="moves")
    third = [next(sweeps) for _ in range(4)][3]
    values = evaluate("gridworld-4-1", third.policy, actions="moves").values
    assert values[0].tolist() == [0, -1, -2, -3]
    assert third.policy[0, 0] == third.policy[3, 3] == -1


@pytest.mark.parametrize("policy", ["random", "uniform", lambda seen: 2 if seen[0] < 3 else 3])
def test_evaluation_converges_to_what_the_policy_is_worth(policy: Any) -> None:
    sweep = last(policy_evaluation("frozen-lake", policy, 0.95))
    np.testing.assert_allclose(
        sweep.values, evaluate("frozen-lake", policy, 0.95).values, atol=1e-8
    )


@pytest.mark.parametrize("name", LEVELS)
def test_policy_iteration_ends_at_the_optimum_in_few_rounds(name: str) -> None:
    rounds = list(policy_iteration(name))
    solution = solve(name)
    assert [each.number for each in rounds] == list(range(1, len(rounds) + 1))
    assert 2 <= len(rounds) <= 10
    np.testing.assert_allclose(rounds[0].values, evaluate(name, "random").values)
    np.testing.assert_allclose(rounds[-1].values, solution.values, rtol=0, atol=1e-8)
    np.testing.assert_allclose(evaluate(name, rounds[-1].policy).values, solution.values, atol=1e-8)
    for before, after in pairwise(rounds):
        assert (np.nan_to_num(after.values - before.values) > -1e-9).all()
        np.testing.assert_allclose(after.values, evaluate(name, before.policy).values, atol=1e-8)


@pytest.mark.slow
@given(worlds(3), st.sampled_from(["all", "moves"]))
def test_with_a_discount_policy_iteration_is_right_everywhere(world: World, actions: str) -> None:
    level = level_of(world)
    found = last(policy_iteration(level, 0.9, actions=actions))
    solution = solve(level, 0.9, actions=actions)
    np.testing.assert_allclose(found.values, solution.values, rtol=1e-8, atol=1e-8)


def test_policy_iteration_finds_its_way_past_a_trap() -> None:
    level = level_of(BESIDE_A_TRAP)
    assert np.isneginf(evaluation_of(level, "random").values).any()
    found, solution = last(policy_iteration(level)), solve(level)
    assert np.isfinite(solution.values[0, 0])
    np.testing.assert_allclose(found.values, solution.values)


@pytest.mark.parametrize("learn", [value_iteration, policy_iteration])
def test_what_has_no_bound_comes_to_an_end(learn: Callable[..., Iterator[Sweep]]) -> None:
    sweeps = list(learn(PAYS_FOR_EVER, max_sweeps=7))
    assert sweeps[-1].number <= 7
    assert (sweeps[-1].values >= 7).all()


def test_it_has_the_attributes_of_its_latest_result() -> None:
    whole = list(value_iteration("maze"))
    sweeps = value_iteration("maze")
    np.testing.assert_array_equal(sweeps.policy, whole[-1].policy)
    assert (sweeps.number, next(sweeps, None)) == (len(whole) - 1, None)
    some = value_iteration("maze")
    next(some)
    assert (some.number, next(some).number, some.number) == (0, 1, 1)
    assert {"policy", "values", "at"} <= {*dir(some)}
    untouched = value_iteration("maze")
    with pytest.raises(AttributeError, match=r"'Learning' object .* 'V'; did you mean `values`"):
        untouched.V  # noqa: B018
    assert next(untouched).number == 0
    assert evaluate("maze", value_iteration("maze")).expected_return == -32


def test_it_can_be_stopped_early_and_leaves_nothing_to_change() -> None:
    sweeps = value_iteration("final-maze")
    first, second = next(sweeps), next(sweeps)
    kept = second.values.copy()
    next(sweeps)
    assert (first.number, second.number) == (0, 1)
    np.testing.assert_array_equal(second.values, kept)
    for array in (second.values, second.policy):
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 5
    with pytest.raises(AttributeError):
        second.delta = 0.0  # type: ignore[misc]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: value_iteration("maze", 1.5), "discount"),
        (lambda: value_iteration("maze", actions="some"), "actions"),
        (lambda: value_iteration("maze", tolerance=-1), "tolerance"),
        (lambda: value_iteration("maze", tolerance=float("nan")), "tolerance"),
        (lambda: value_iteration("maze", max_sweeps=0), "max_sweeps"),
        (lambda: policy_iteration("maze", max_sweeps=0), "max_sweeps"),
        (lambda: policy_evaluation("maze", "rando"), "random"),
    ],
)
def test_wrong_arguments_are_told_at_once(call: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()
