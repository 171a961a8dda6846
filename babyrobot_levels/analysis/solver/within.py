"""Episodes with a time limit: optimal policies by step, and the worth of any policy, exactly.

What is optimal then depends on the time: with few steps left, it can be better to take a small
reward than to begin a way to a large one. Backward induction gives all of it exactly: the values
with k + 1 steps left follow from those with k. Nothing is infinite.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.model import Flags, Floats, Model
from babyrobot_levels.analysis.solver.policies import read_policy
from babyrobot_levels.analysis.solver.results import Evaluation, Solution, num_actions, probability
from babyrobot_levels.analysis.solver.space import StateSpace

MAX_POLICY_SIZE = 200_000_000
"""The most actions of a policy by step: states times steps, a byte each."""

TOLERANCE = 1e-9
"""Actions whose values differ by no more than this share of the best one are all greedy."""

_EQUAL = 1e-12
"""Probabilities and numbers of steps that differ by no more are equal."""


@dataclass(frozen=True, eq=False)
class _Ahead:
    """What is expected from each state with some steps left, `[n]` each."""

    values: Floats
    success: Floats
    steps: Floats

    def equals(self, other: _Ahead) -> bool:
        """Return whether one more step changed nothing."""
        return all(
            np.array_equal(mine, its)
            for mine, its in zip(vars(self).values(), vars(other).values(), strict=True)
        )


def _nothing(model: Model) -> _Ahead:
    zeros = np.zeros(model.size)
    return _Ahead(zeros, zeros, zeros)


def _by_action(model: Model, ahead: _Ahead, discount: float) -> tuple[Floats, Floats, Floats]:
    """Return values, success and steps if an action is taken first, `[n, actions]` each."""
    following = np.append(np.stack([ahead.success, ahead.steps]), np.zeros((2, 1)), axis=1)
    success, steps = np.einsum("sao,ksao->ksa", model.probability, following[:, model.next_state])
    return model.action_values(ahead.values, discount), model.success + success, 1.0 + steps


def solve_within(space: StateSpace, discount: float, steps: int) -> Solution:
    """Return the optimum of episodes that are truncated after a number of steps.

    Among equally good actions, the policy takes one that is most likely to reach an exit, and of
    these the fastest.

    Raises:
        ValueError: there are too many states and steps for a policy by step.
    """
    model, mdp = space.model(), space.mdp
    if mdp.num_states * steps > MAX_POLICY_SIZE:
        raise ValueError(
            f"an optimal policy of {mdp.num_states:,} states within {steps:,} steps is too large; "
            f"the limit is {MAX_POLICY_SIZE:,} actions"
        )
    policies = np.full((steps, mdp.num_states), -1, np.int8)
    rows, ahead, rounds = np.arange(model.size), _nothing(model), 0
    for step in reversed(range(steps)):
        values, success, lengths = _by_action(model, ahead, discount)
        greedy = _greedy(model, values)
        fastest = _fastest(greedy, success, lengths)
        action = fastest.argmax(axis=1)
        policies[step, model.states] = action
        now = _Ahead(values[rows, action], success[rows, action], lengths[rows, action])
        rounds += 1
        if now.equals(ahead):
            # More steps change nothing any more.
            policies[:step] = policies[step]
            break
        ahead = now
    tables = np.zeros((2, mdp.num_states, greedy.shape[1]), bool)
    tables[:, model.states] = greedy, fastest
    tables = tables.reshape(2, *mdp.shape, -1)
    return Solution(
        **_facts(space, model, now, values),
        discount=discount,
        within=steps,
        greedy=tables[0],
        fastest=tables[1],
        policy=policies[0].astype(np.int64).reshape(mdp.shape),
        policies=policies.reshape(steps, *mdp.shape),
        method="backward induction",
        iterations=rounds,
        residual=0.0,
    )


def _greedy(model: Model, values: Floats) -> Flags:
    """Return the actions whose values are those of the best one, `[n, actions]`."""
    best = values.max(axis=1, keepdims=True, initial=-np.inf)
    rewards = min(1.0, float(np.abs(model.reward).max(initial=0.0)))
    greedy: Flags = values >= best - TOLERANCE * np.maximum(np.abs(best), rewards)
    return greedy


def _fastest(greedy: Flags, success: Floats, lengths: Floats) -> Flags:
    """Return those of the greedy actions that most likely reach an exit, the fastest of these."""
    likely = np.where(greedy, success, -np.inf)
    likeliest = likely >= likely.max(axis=1, keepdims=True) - _EQUAL
    durations = np.where(likeliest, lengths, np.inf)
    shortest = durations.min(axis=1, keepdims=True)
    fastest: Flags = durations <= shortest + _EQUAL * np.maximum(1.0, shortest)
    return fastest


def evaluate_within(space: StateSpace, policy: Any, discount: float, steps: int) -> Evaluation:
    """Return the values of a policy, which may depend on the step, in truncated episodes."""
    model, weights = space.model(), weights_by_step(policy, space, steps)
    ahead, settled = _nothing(model), None
    for step in reversed(range(steps)):
        chosen = weights(step)
        if chosen is settled:
            # One more step of this policy changes nothing; an earlier step may have another one.
            continue
        values, success, lengths = _by_action(model, ahead, discount)
        # Actions that are not taken add nothing, even if they may not be taken.
        taken = chosen[model.states]
        now = _Ahead(
            *(
                np.where(taken > 0, taken * each, 0.0).sum(axis=1)
                for each in (values, success, lengths)
            )
        )
        settled = chosen if now.equals(ahead) else None
        ahead = now
    return Evaluation(**_facts(space, model, now, values), discount=discount, within=steps)


def _facts(space: StateSpace, model: Model, now: _Ahead, values: Floats) -> dict[str, Any]:
    """Return what the results of solving and of evaluating have in common.

    Args:
        space: the states.
        model: their model.
        now: what is expected with all steps left.
        values: the same values if an action is taken first, `[n, actions]`.
    """
    return {
        "values": space.spread(model, now.values),
        "action_values": space.spread(model, values),
        "expected_return": space.at_start(model, now.values),
        "expected_steps": space.at_start(model, now.steps),
        "exit_probability": probability(space.at_start(model, now.success)),
        "actions": space.actions,
        "level": space.level,
    }


def weights_by_step(policy: Any, space: StateSpace, steps: int) -> Callable[[int], Floats]:
    """Return a function from a step, 0 the first, to a policy's probabilities, `[states, actions]`.

    Of a policy that does not depend on the step, all are the same array.

    Args:
        policy: as `read_policy` takes it; or a `Solution` within a limit, its `policies`, or
            another array with an axis of `steps` before the others.
        space: the states.
        steps: the limit of steps.

    Raises:
        ValueError: it is none of these, or was made for another limit.
    """
    table = getattr(policy, "policies", None)
    shape = getattr(policy, "shape", ())
    shapes = (space.mdp.shape, (*space.mdp.shape, num_actions(space.actions)))
    if table is None and shape[1:] in shapes and shape not in shapes:
        table = policy
    things = space.level.things()
    if table is None:
        weights = read_policy(policy, space.mdp, space.actions, things)
        return lambda step: weights
    if len(table) != steps:
        raise ValueError(
            f"the policy is one for episodes of {len(table)} steps; give within={len(table)}"
        )
    last: tuple[int, Floats] | None = None

    def at(step: int) -> Floats:
        nonlocal last
        if last is None or not np.array_equal(table[last[0]], table[step]):
            last = step, read_policy(table[step], space.mdp, space.actions, things)
        return last[1]

    return at
