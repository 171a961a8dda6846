"""Optimal values of levels with things beside those of value iteration over independent tables."""

from __future__ import annotations

from collections.abc import Callable
from random import Random

import numpy as np
import pytest
from hypothesis import settings
from numpy.typing import NDArray
from oracles.random_things import random_level
from oracles.things_reference import Outcome, Reference, TurningReference
from support.each import for_each
from support.playing import GALLERY

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver.evaluation import evaluation_of

ACTIONS = {"all": range(5), "moves": range(1, 5), "turns": range(3)}
WITH_THINGS = sorted(
    name
    for name, path in GALLERY.items()
    # Several robots have a reference of their own.
    if brl.load(path).has_things and path.parent.name != "robots"
)


def value_iteration(
    outcomes: Callable[[int, int], list[Outcome]],
    going_on: list[int],
    states: int,
    actions: range,
    discount: float,
) -> NDArray[np.float64]:
    """Return optimal values `[states]`, from outcomes one by one."""
    rows = [
        (number * len(actions) + action - actions[0], *outcome)
        for number, state in enumerate(going_on)
        for action in actions
        for outcome in outcomes(state, action)
    ]
    values = np.zeros(states)
    if not rows:
        return values
    row, chance, following, reward, over = map(np.array, zip(*rows, strict=True))
    for _ in range(100_000):
        ahead = chance * (reward + discount * np.where(over, 0.0, values[following]))
        best = np.bincount(row, ahead).reshape(len(going_on), -1).max(axis=1)
        change = np.abs(best - values[going_on]).max()
        values[going_on] = best
        if change <= 1e-13 * (1 + np.abs(best).max()):
            return values
    raise AssertionError("value iteration has not come to an end")


def compare_with_reference(seed: int, actions: str) -> None:
    fields = random_level(Random(seed))
    level = brl.load(fields)
    reference: Reference | TurningReference = Reference(fields)
    if actions == "turns":
        reference = TurningReference(Reference(fields), level.heading)
    size = reference.num_states
    going_on = [state for state in range(size) if not reference.is_terminal(state)]
    expected = value_iteration(reference.outcomes, going_on, size, ACTIONS[actions], 0.8)
    solution = brl.solve(level, 0.8, actions=actions)
    mdp = level.compile() if actions != "turns" else level.compile().turning(level.heading)
    assert solution.values.shape == solution.policy.shape == mdp.shape
    np.testing.assert_allclose(np.nan_to_num(solution.values).ravel(), expected, atol=1e-9)
    assert np.flatnonzero(solution.policy.ravel() >= 0).tolist() == going_on
    expected_return = sum(chance * expected[state] for state, chance in reference.start.items())
    assert solution.expected_return == pytest.approx(expected_return, abs=1e-9)
    found = evaluation_of(level, solution, 0.8, actions)
    np.testing.assert_allclose(found.values, solution.values, atol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("actions", ACTIONS)
def test_optimal_values_of_random_levels(actions: str) -> None:
    for seed in range(settings().max_examples // 2):
        compare_with_reference(seed, actions)


@pytest.mark.sweep
@pytest.mark.parametrize("actions", ACTIONS)
def test_optimal_values_of_many_random_levels(actions: str) -> None:
    for seed in range(1000, 1100):
        compare_with_reference(seed, actions)


@pytest.mark.slow
@for_each("name", WITH_THINGS)
def test_optimal_values_of_the_gallery(name: str) -> None:
    level = brl.load(GALLERY[name])
    mdp = level.compile()
    table = mdp.to_toy_text()
    going_on = np.flatnonzero(~mdp.is_terminal).tolist()
    # Without a discount, what a push has lost costs without end.
    discount = 0.9 if level.boxes else level.discount
    expected = value_iteration(
        lambda state, action: table[state][action],
        going_on,
        mdp.num_states,
        ACTIONS["all"],
        discount,
    )
    solution = brl.solve(level, discount)
    np.testing.assert_allclose(np.nan_to_num(solution.values).ravel(), expected, atol=1e-8)
    assert solution.expected_return == pytest.approx(float(mdp.start @ expected), abs=1e-8)
    # In no level of the gallery does an optimal robot go on for ever.
    assert np.isfinite(solution.expected_steps)
