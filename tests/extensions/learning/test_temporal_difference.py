"""Q-learning and Sarsa on the cliff of Example 6.6, and what holds of both."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from babyrobot_levels.analysis.solver.evaluation import evaluate
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.results import Evaluation
from babyrobot_levels.extensions.learning.algorithms import q_learning, sarsa
from babyrobot_levels.extensions.learning.results import Trials

Learn = Callable[..., Iterator[Trials]]

each_way = pytest.mark.parametrize("learn", [q_learning, sarsa])


def last(trials: Iterator[Trials]) -> Trials:
    *_, found = trials
    return found


def following(found: Trials, level: Any) -> Evaluation:
    return evaluate(level, found.policy, actions="moves")


def along_the_edge(found: Trials) -> int:
    """Return how many cells right above the cliff the greedy way over the cliff visits."""
    x, y, visited = 0, 3, set()
    for _ in range(48):
        if found.policy[y, x] < 0:
            break
        dx, dy = [(0, -1), (1, 0), (0, 1), (-1, 0)][found.policy[y, x]]
        x, y = min(max(x + dx, 0), 11), min(max(y + dy, 0), 3)
        visited.add((x, y))
    return sum((x, 2) in visited for x in range(1, 11))


@pytest.mark.slow
def test_on_the_cliff_q_learning_walks_the_edge_and_sarsa_keeps_away() -> None:
    best = last(q_learning("cliff-walking", 500, seed=0))
    safe = last(sarsa("cliff-walking", 500, seed=0))
    assert following(best, "cliff-walking").expected_return == -13
    assert along_the_edge(best) == 10
    assert following(safe, "cliff-walking").exit_probability == 1
    assert following(safe, "cliff-walking").expected_return < -13
    assert along_the_edge(safe) < 5
    # While they learn, Sarsa falls less often.
    assert safe.returns[-200:].mean() > best.returns[-200:].mean() + 10


def test_q_learning_comes_to_the_optimal_action_values() -> None:
    level = {"version": 1, "size": [3, 2], "exit": [2, 1], "puddles": [{"at": [1, 0]}]}
    level |= {"puddle_types": {"small": {"skid": 0}}, "blocked": [{"at": [2, 0]}]}
    found = last(q_learning(level, 500, step_size=0.5, epsilon=0.5))
    exact = solve(level, actions="moves")
    np.testing.assert_allclose(found.values, exact.values, atol=1e-6)
    np.testing.assert_allclose(found.action_values, exact.action_values, atol=1e-6)
    assert np.isnan(found.values[0, 2])


@pytest.mark.slow
def test_sarsa_without_learning_the_best_is_worth_what_its_policy_is() -> None:
    """With epsilon 1, Sarsa evaluates going in all directions evenly."""
    found = last(sarsa("gridworld-4-1", 2000, step_size=0.05, epsilon=1, discount=0.9))
    exact = evaluate("gridworld-4-1", "uniform", 0.9, actions="moves")
    np.testing.assert_allclose(found.action_values, exact.action_values, atol=0.6)


@each_way
def test_trials_are_numbered_by_episodes_and_keep_all_returns(learn: Learn) -> None:
    trials = list(learn("cliff-walking", 25, every=10, actions="all"))
    assert [each.number for each in trials] == [10, 20, 25]
    assert [each.returns.size for each in trials] == [10, 20, 25]
    np.testing.assert_array_equal(trials[2].returns[:10], trials[0].returns)
    for before, after in pairwise(trials):
        assert after.delta == np.abs(after.action_values - before.action_values).max()
    assert trials[0].action_values.shape == (4, 12, 5)
    np.testing.assert_array_equal(trials[0].values, trials[0].action_values.max(axis=2))
    assert trials[0].policy[3, 11] == -1
    with pytest.raises(ValueError, match="read-only"):
        trials[0].action_values[0, 0, 0] = 1


@pytest.mark.slow
@each_way
def test_the_seed_decides_and_global_chance_is_left_alone(learn: Learn) -> None:
    before = random.getstate(), np.random.get_state()[1].tolist()  # type: ignore[index]
    one, same, other = (
        last(learn("frozen-lake", 60, seed=seed, every=every))
        for seed, every in ((0, 10), (0, 7), (1, 10))
    )
    np.testing.assert_array_equal(one.action_values, same.action_values)
    np.testing.assert_array_equal(one.returns, same.returns)
    slow = last(learn("cliff-walking", 5, seed=1))
    assert (slow.returns != last(learn("cliff-walking", 5, seed=0)).returns).any()
    assert other.returns.size == 60
    assert before == (random.getstate(), np.random.get_state()[1].tolist())  # type: ignore[index]


@each_way
def test_ties_are_broken_by_chance(learn: Learn) -> None:
    """Without exploring, from values that are all equal: not always the same way first."""
    level = {"version": 1, "size": [3, 3], "start": [1, 1], "max_steps": 1}
    level |= {"rewards": {"step": -1}, "exit": "none"}
    taken = {
        int(last(learn(level, 1, epsilon=0, seed=seed)).action_values[1, 1].argmin())
        for seed in range(40)
    }
    assert taken == {0, 1, 2, 3}


@pytest.mark.slow
@each_way
def test_episodes_without_end_are_cut_off(learn: Learn) -> None:
    level = {"version": 1, "size": [2, 1], "exit": "none", "max_steps": 9}
    assert last(learn(level, 3)).returns.tolist() == [-9, -9, -9]
    found = last(learn({**level, "max_steps": None}, 1))
    assert found.returns.tolist() == [-10_000]
    halved = last(learn(level, 1, discount=0.5)).returns
    assert halved.tolist() == [-(2 - 0.5**8)]


@each_way
@pytest.mark.parametrize(
    "wrong",
    [
        {"episodes": 0},
        {"every": 0},
        {"step_size": 1.1},
        {"epsilon": float("nan")},
        {"discount": "x"},
        {"seed": 1.5},
        {"actions": "valid"},
    ],
    ids=str,
)
def test_wrong_arguments_are_told_at_once(learn: Learn, wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong))):
        learn("cliff-walking", **{"episodes": 5, **wrong})


# -- Dyna-Q, n-step Sarsa, and where episodes begin ----------------------------------------------


@pytest.mark.slow
def test_planning_finds_the_way_in_fewer_episodes() -> None:
    few, many = (
        last(q_learning("dyna-maze", 6, planning_steps=planning, discount=0.95, seed=1))
        for planning in (0, 50)
    )
    # Only what lies before the goal is known without planning.
    assert (few.values > 0).sum() < 10 < 30 < (many.values > 0).sum()
    best = solve("dyna-maze", 0.95, actions="moves").expected_return
    assert many.returns[-1] > 0.5 * best


def test_one_step_of_planning_learns_again_from_the_only_step() -> None:
    level = {"version": 1, "size": [2, 1], "exit": [1, 0], "max_steps": 1}
    alone, planned = (
        last(q_learning(level, 1, planning_steps=planning, step_size=0.5, seed=3))
        for planning in (0, 1)
    )
    (action,) = np.flatnonzero(alone.action_values[0, 0])
    target = 2 * alone.action_values[0, 0, action]
    # The end follows, or the values of the same cell, which are 0 at first.
    assert planned.action_values[0, 0, action] == pytest.approx(0.75 * target)


def test_returns_of_n_steps_reach_back_at_once() -> None:
    level = {"version": 1, "size": [6, 1], "rewards": {"step": 0, "exit": 1}}
    one, many = (
        last(sarsa(level, 1, n_steps=n_steps, step_size=1.0, seed=2)) for n_steps in (1, 100)
    )
    assert (one.values != 0).sum() == 1
    assert (many.values != 0).sum() == 5
    assert one.returns.tolist() == many.returns.tolist()


@pytest.mark.slow
def test_exploring_starts_come_everywhere_but_where_no_robot_can_stand() -> None:
    found = last(q_learning("cliff-walking", 200, exploring_starts=True, seed=4))
    visited = (found.action_values != 0).any(axis=-1)
    assert visited[:3].all()
    assert not visited[3, 1:].any()


@pytest.mark.parametrize("learn", [q_learning, sarsa])
def test_action_values_begin_as_one_says(learn: Learn) -> None:
    found = last(learn("cliff-walking", 1, initial=5.0))
    assert found.action_values.max() == 5.0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: q_learning("first-key", 1, exploring_starts=True), "levels without things"),
        (
            lambda: q_learning("maze", 1, planning_steps=-1),
            "planning_steps must be a whole number, at least 0",
        ),
        (lambda: q_learning("maze", 1, initial=float("nan")), "initial must be a finite number"),
        (lambda: sarsa("maze", 1, n_steps=0), "n_steps must be a whole number, at least 1"),
    ],
)
def test_what_does_not_fit_is_told(call: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()
