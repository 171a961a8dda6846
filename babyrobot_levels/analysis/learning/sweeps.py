"""Dynamic programming: values from sweeps over all states of the known tables.

After Sutton and Barto, Reinforcement Learning: An Introduction (2nd edition), chapter 4.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from babyrobot_levels.analysis.learning.results import (
    Problem,
    Sweep,
    check_counts,
    largest_change,
    read_problem,
)
from babyrobot_levels.analysis.solver.evaluation import action_values, chain_values
from babyrobot_levels.analysis.solver.model import Floats, Model, surely_ending
from babyrobot_levels.analysis.solver.optimum import TOLERANCE
from babyrobot_levels.analysis.solver.policies import Policy

MAX_SWEEPS = 10_000


def value_iteration(
    level: Any,
    discount: float | None = None,
    *,
    actions: str = "all",
    tolerance: float = 1e-10,
    max_sweeps: int = MAX_SWEEPS,
) -> Iterator[Sweep]:
    """Yield the sweeps of value iteration, from values of 0 towards the optimal ones.

    A sweep gives each state the value of its greedy action, by the values of the sweep before
    (two arrays). Number 0 is before the first one. Without a discount, unbounded values grow or
    sink until `max_sweeps` ends it.

    Args:
        level: a name, a path, a mapping or a `Level`.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"all"`, `"moves"` without stay, or `"turns"`: turn left, turn right, forward.
            Actions that a wall refuses can be taken too.
        tolerance: the last sweep is the first one whose `delta` is not above this.
        max_sweeps: the number of sweeps after which it ends in any case, at least 1.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has an invalid value.
    """
    problem = read_problem(level, discount, actions, "sweep")
    return _sweeps(problem, problem.model, tolerance, max_sweeps)


def policy_evaluation(
    level: Any,
    policy: Policy,
    discount: float | None = None,
    *,
    actions: str = "all",
    tolerance: float = 1e-10,
    max_sweeps: int = MAX_SWEEPS,
) -> Iterator[Sweep]:
    """Yield the sweeps of iterative policy evaluation, from values of 0 towards the policy's.

    A sweep gives each state the value of the policy's next step, by the values of the sweep
    before (two arrays). Number 0 is before the first one. Each sweep's `policy` is the greedy one
    for its values, not the one that is evaluated.

    Args:
        level: a name, a path, a mapping or a `Level`.
        policy: as `evaluate` takes it; `"uniform"` is what the book calls equiprobable.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"all"`, `"moves"` without stay, or `"turns"`: turn left, turn right, forward.
        tolerance: the last sweep is the first one whose `delta` is not above this.
        max_sweeps: the number of sweeps after which it ends in any case, at least 1.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has an invalid value.
    """
    problem = read_problem(level, discount, actions, "sweep")
    chain = problem.model.mixed(problem.weights(policy))
    return _sweeps(problem, chain, tolerance, max_sweeps)


def policy_iteration(
    level: Any,
    discount: float | None = None,
    *,
    actions: str = "all",
    max_sweeps: int = 1000,
) -> Iterator[Sweep]:
    """Yield the rounds of policy iteration, from the random policy to an optimal one.

    A round evaluates a policy exactly (`values`) and improves it (`policy`); number 1 has the
    values of the random policy. An action is replaced only by a better one. The last round finds
    nothing to improve: its values are those of its policy.

    Without a discount, the random policy leaves out actions that may lead to inescapable states
    from where the episode can surely be ended. Where it is optimal to go on for ever, because the
    rewards are positive or zero, the rounds may stop below the optimum, or never; `solve` does not.

    Args:
        level: a name, a path, a mapping or a `Level`.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"all"`, `"moves"` without stay, or `"turns"`: turn left, turn right, forward.
        max_sweeps: the number of rounds after which it ends in any case, at least 1.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has an invalid value.
        UndefinedReturnError: while iterating: there is no discount, and an intermediate policy
            goes on for ever while rewards cancel out.
    """
    check_counts(max_sweeps=max_sweeps)
    return _rounds(read_problem(level, discount, actions, "round"), max_sweeps)


def _sweeps(problem: Problem, model: Model, tolerance: float, max_sweeps: int) -> Iterator[Sweep]:
    """Check the bounds and return the sweeps. The chain of a policy has a single action."""
    check_counts(max_sweeps=max_sweeps)
    if not tolerance >= 0:
        raise ValueError(f"tolerance must not be negative, not {tolerance!r}")

    def sweeps() -> Iterator[Sweep]:
        values = np.zeros(model.size)
        yield problem.sweep(0, values, np.inf)
        for number in range(1, max_sweeps + 1):
            before, values = values, model.action_values(values, problem.discount).max(axis=1)
            delta = largest_change(values, before)
            yield problem.sweep(number, values, delta)
            if delta <= tolerance:
                return

    return sweeps()


def _rounds(problem: Problem, max_sweeps: int) -> Iterator[Sweep]:
    model, discount = problem.model, problem.discount
    # States keep the random mixture until an action is better: without a discount, a policy that
    # commits itself without an improvement might go round in circles.
    weights = problem.weights("random")
    if discount == 1:
        weights = _without_risks(model, weights)
    values = np.zeros(model.size)
    for number in range(1, max_sweeps + 1):
        chain = model.mixed(weights)
        before, values = values, chain_values(chain, discount, problem.space)
        ahead = action_values(model, values, discount)
        size = np.where(np.isfinite(values), np.abs(values), 0.0)
        better = ahead.max(axis=1) > values + TOLERANCE * np.maximum(1.0, size)
        weights[better] = np.eye(ahead.shape[1])[problem.greedy(ahead)[better]]
        delta = largest_change(values, before)
        yield problem.sweep(number, values, delta, weights.argmax(axis=1))
        if not better.any():
            return


def _without_risks(model: Model, weights: Floats) -> Floats:
    """Return a policy without the actions that risk an endless episode, `[n, actions]`.

    From -inf no action looks better than another if each has a chance to lead to -inf again.
    """
    sure, action, rows = surely_ending(model, model.allowed)
    safe = np.where(sure[:, None], weights * rows, weights)
    none = safe.sum(axis=1) == 0
    safe[none] = np.eye(weights.shape[1])[action[none]]
    kept: Floats = safe / safe.sum(axis=1, keepdims=True)
    return kept
