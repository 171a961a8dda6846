"""Learning levels with things, and robots that turn."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver.evaluation import evaluate
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.extensions.learning.algorithms import (
    monte_carlo,
    policy_evaluation,
    policy_iteration,
    q_learning,
    sarsa,
    value_iteration,
)
from babyrobot_levels.extensions.learning.results import Sweep, Trials

each_set = pytest.mark.parametrize("actions", ["all", "moves", "turns"])

# A guard walks to and fro in a corridor with a niche; to be hit ends the episode.
GUARD: dict[str, Any] = {
    "version": 1,
    "size": [5, 2],
    "exit": [4, 0],
    "blocked": [{"at": [x, 1]} for x in (0, 1, 3, 4)],
    "movers": [{"name": "guard", "path": [[1, 0], [2, 0], [3, 0]], "back": True}],
    "hit": {"reward": -10},
}


def last(sweeps: Iterator[Any]) -> Any:
    *_, found = sweeps
    return found


@each_set
@pytest.mark.parametrize("level", ["first-key", GUARD])
def test_sweeps_come_to_the_exact_values(level: Any, actions: str) -> None:
    solution = solve(level, actions=actions)
    for sweeps in (
        value_iteration(level, actions=actions),
        policy_iteration(level, actions=actions),
        policy_evaluation(level, solution, actions=actions),
    ):
        found: Sweep = last(sweeps)
        assert found.values.shape == found.policy.shape == solution.values.shape
        np.testing.assert_allclose(found.values, solution.values, atol=1e-8)
        np.testing.assert_array_equal(found.policy < 0, solution.policy < 0)
        part = found.at(solution.values.shape[0] - 1)
        np.testing.assert_array_equal(part.values, found.values[-1])


def test_monte_carlo_estimates_the_values_of_a_policy() -> None:
    expected = evaluate(GUARD, "random", 0.9)
    found: Sweep = last(monte_carlo(GUARD, "random", 3000, discount=0.9, seed=1))
    # Where episodes begin, every episode counts.
    assert found.values[0, 0, 0] == pytest.approx(expected.expected_return, abs=0.2)


@pytest.mark.slow
@each_set
@pytest.mark.parametrize("learn", [q_learning, sarsa])
def test_action_values_have_the_shape_of_the_tables(
    learn: Callable[..., Iterator[Trials]], actions: str
) -> None:
    found = last(learn("first-key", 300, actions=actions, epsilon=0.2))
    solution = solve("first-key", actions=actions)
    assert found.action_values.shape == solution.action_values.shape
    assert found.policy.shape == solution.policy.shape
    assert evaluate("first-key", found, 0.9, actions).exit_probability == 1


@pytest.mark.slow
def test_nothing_follows_a_hit_that_ends_the_episode() -> None:
    # With steps of size 1, all that happens is that exact values spread.
    found = last(q_learning(GUARD, 3000, step_size=1, epsilon=1, actions="all"))
    solution = solve(GUARD)
    tried = found.action_values < 0
    assert (solution.action_values[tried] == -10).sum() > 5
    np.testing.assert_array_equal(found.action_values[tried], solution.action_values[tried])


@pytest.mark.parametrize("learn", [q_learning, sarsa])
def test_only_sweeps_learn_several_robots(learn: Callable[..., Any]) -> None:
    robots = [{"name": "a", "start": [0, 0]}, {"name": "b", "start": [1, 0]}]
    level = {"version": 1, "size": [3, 1], "robots": robots}
    for actions in ("moves", "all"):
        with pytest.raises(brl.LevelError, match="learn from episodes are only for levels"):
            learn(level, actions=actions)
    *_, last = value_iteration(level, actions="all")
    np.testing.assert_array_equal(last.values, solve(level).values)
