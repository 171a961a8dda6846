"""The average reward in the long run, against a linear program and against powers of matrices."""

from __future__ import annotations

from random import Random
from typing import Any

import numpy as np
import pytest
from oracles.random_things import random_level
from scipy.optimize import linprog  # type: ignore[import-untyped]
from support.each import for_each

import babyrobot_levels as brl


def matrices(level: brl.Level) -> tuple[Any, Any, Any]:
    """Return the states that go on, `[n]`, their chances `[n, actions, n + 1]`, and rewards."""
    mdp = level.compile()
    states = np.flatnonzero(~mdp.is_terminal)
    number = np.full(mdp.num_states, states.size)
    number[states] = np.arange(states.size)
    chances = np.zeros((states.size, mdp.num_actions, states.size + 1))
    rewards = np.zeros(chances.shape[:2])
    for row, state in enumerate(states.tolist()):
        for action in range(mdp.num_actions):
            for chance, following, reward, over in mdp.outcomes(state, action):
                chances[row, action, states.size if over else number[following]] += chance
                rewards[row, action] += chance * reward
    return states, chances, rewards


def best_gains(chances: Any, rewards: Any) -> Any:
    """Return the greatest gain of each state, by a linear program (Puterman, section 9.3)."""
    count, actions, _ = chances.shape
    rows, bounds = [], []
    for state in range(count):
        for action in range(actions):
            leads = chances[state, action, :count]
            one = np.eye(count)[state]
            rows += [np.concatenate([leads - one, np.zeros(count)])]
            rows += [np.concatenate([-one, leads - one])]
            bounds += [0.0, -rewards[state, action]]
    costs = np.concatenate([np.ones(count), np.zeros(count)])
    found = linprog(costs, np.array(rows), bounds, bounds=(None, None), method="highs")
    assert found.status == 0, found.message
    return found.x[:count]


def long_run(chances: Any) -> Any:
    """Return the average of all powers of a matrix: a chain that often stays is no circle."""
    power = (np.eye(len(chances)) + chances) / 2
    for _ in range(50):
        power = power @ power
        power /= power.sum(axis=1, keepdims=True)
    return power


def continuing(seed: int) -> brl.Level:
    fields = random_level(Random(seed), things=seed % 3 == 0)
    return brl.Level.from_fields(fields)


@pytest.mark.slow
@for_each("seed", range(40))
def test_gains_are_those_of_a_linear_program(seed: int) -> None:
    level = continuing(seed)
    states, chances, rewards = matrices(level)
    if not 0 < states.size <= 80:
        return
    found = brl.solve(level, criterion="average")
    gains = best_gains(chances, rewards)
    assert found.gain.ravel()[states] == pytest.approx(gains, abs=1e-6)
    assert found.residual < 1e-8


@pytest.mark.slow
@for_each("seed", range(40))
def test_gain_and_bias_of_a_policy_are_those_of_powers_of_its_matrix(seed: int) -> None:
    level = continuing(seed)
    states, chances, rewards = matrices(level)
    if not 0 < states.size <= 80:
        return
    found = brl.evaluate(level, "uniform", criterion="average")
    mixed, reward = np.zeros((states.size + 1,) * 2), np.append(rewards.mean(axis=1), 0.0)
    mixed[:-1], mixed[-1, -1] = chances.mean(axis=1), 1.0
    limit = long_run(mixed)
    gain, bias = (np.append(table.ravel()[states], 0.0) for table in (found.gain, found.bias))
    assert gain == pytest.approx(limit @ reward, abs=1e-9)
    scale = max(1.0, float(np.abs(bias).max()))
    assert gain + bias == pytest.approx(reward + mixed @ bias, abs=1e-9 * scale)
    assert limit @ bias == pytest.approx(np.zeros(states.size + 1), abs=1e-7 * scale)


def test_the_gridworld_of_the_book_gains_10_in_five_steps() -> None:
    found = brl.solve("gridworld-3-5", criterion="average")
    assert found.expected_gain == pytest.approx(2, abs=1e-12)
    assert not found.multichain
    assert found.explanation is None
    # A is left for A', which is four steps below, and pays 10: five steps at 2 each.
    assert found.bias[0, 1] - found.bias[4, 1] == pytest.approx(8)
    again = brl.evaluate("gridworld-3-5", found, criterion="average")
    assert again.expected_gain == pytest.approx(2, abs=1e-12)
    assert np.array_equal(again.bias, found.bias)


def test_several_classes_are_told() -> None:
    walls = [{"at": [1, 0], "side": "E"}]
    areas = [{"at": [0, 0], "reward": 3}, {"at": [4, 0], "reward": 5}]
    level = brl.load({"version": 1, "size": [5, 1], "exit": "none", "walls": walls, "areas": areas})
    found = brl.solve(level, criterion="average")
    assert found.gain.tolist() == [[3, 3, 5, 5, 5]]
    assert found.bias.tolist() == [[0, 0, -6, 0, 0]]
    assert found.multichain
    assert found.explanation is not None
    assert "3 to 5" in found.explanation


def test_episodes_that_end_gain_nothing_and_their_bias_is_the_return() -> None:
    level = brl.load("final-maze")
    found, best = brl.solve(level, criterion="average"), brl.solve(level)
    assert found.expected_gain == 0
    assert found.bias == pytest.approx(best.values, nan_ok=True)


def test_what_is_for_returns_is_refused() -> None:
    with pytest.raises(ValueError, match="`discount` is for returns"):
        brl.solve("gridworld-3-5", 0.9, criterion="average")  # type: ignore[call-overload]
    with pytest.raises(ValueError, match="`within` is for returns"):
        brl.evaluate("gridworld-3-5", "random", within=3, criterion="average")  # type: ignore[call-overload]
    with pytest.raises(ValueError, match="criterion must be one of 'return', 'average'"):
        brl.solve("gridworld-3-5", criterion="mean")  # type: ignore[call-overload]


def test_states_that_are_no_part_of_it_have_no_gain() -> None:
    level = brl.load({"version": 1, "size": [3, 1], "start": [0, 0], "blocked": [{"at": [1, 0]}]})
    found = brl.solve(level, criterion="average")
    assert np.isnan(found.gain).tolist() == [[False, True, False]]
    assert found.gain[0, 0] == -1
