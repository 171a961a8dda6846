"""Episodes with a time limit: optimal policies by step, and the worth of any policy, exactly.

What is optimal then depends on the time: with few steps left, it can be better to take a small
reward than to begin a way to a large one. Backward induction gives all of it exactly: the values
with k + 1 steps left follow from those with k. Nothing is infinite.
"""

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.bounds import ROUNDINGS, UNIT
from babyrobot_levels.analysis.solver.horizon import EXACT, FIRST_LOOK, after, induction
from babyrobot_levels.analysis.solver.model import Model
from babyrobot_levels.analysis.solver.policies import StateSpace, read_policy
from babyrobot_levels.analysis.solver.results import (
    EpisodeTooLongError,
    Evaluation,
    Solution,
    probability,
)
from babyrobot_levels.mdp.tables import Flags, Floats
from babyrobot_levels.text import budget

MAX_POLICY_SIZE = 200_000_000
"""The most actions of a policy by step: states times steps, a byte each."""

TOLERANCE = 1e-9
"""By which share of a reward what counts as equally good may differ, in all steps together."""

MOST_COMPILED = 100_000
"""The most outcomes of levels that are solved in one call of machine code, which nothing ends."""

_ROUNDING = 4 * np.finfo(np.float64).eps

_EQUAL = 1e-12
"""Probabilities and numbers of steps that differ by no more are equal."""


def _by_action(model: Model, ahead: Floats, discount: float) -> tuple[Floats, Floats, Floats]:
    """Return values, success and steps if an action is taken first, `[n, actions]` each.

    Args:
        model: the states.
        ahead: values, success and steps that are expected after that, `[n, 3]`.
        discount: the discount factor.
    """
    following = np.append(ahead[:, 1:].T, np.zeros((2, 1)), axis=1)
    success, steps = np.einsum("sao,ksao->ksa", model.probability, following[:, model.next_state])
    return model.action_values(ahead[:, 0], discount), model.success + success, 1.0 + steps


def solve_within(space: StateSpace, discount: float, steps: int) -> Solution:
    """Return the optimum of episodes that are truncated after a number of steps.

    Among equally good actions, the policy takes one that is most likely to reach an exit, and of
    these the fastest.

    Raises:
        EpisodeTooLongError: there are too many states and steps for a policy by step, or to be
            computed.
    """
    model, mdp = space.model(), space.mdp
    if mdp.num_states * steps > MAX_POLICY_SIZE:
        raise EpisodeTooLongError(
            f"an optimal policy of {mdp.num_states:,} states within {steps:,} steps is too large; "
            f"the limit is {MAX_POLICY_SIZE:,} actions; give a smaller limit of steps"
        )
    policies = np.full((steps, mdp.num_states), -1, np.int8)
    rows, rounds = np.arange(model.size), 0
    values, action = np.zeros((model.size, 0)), rows
    greedy = fastest = np.zeros((model.size, 0), bool)
    slack = _slack(model, steps)

    def step(ahead: Floats) -> Floats:
        nonlocal values, greedy, fastest, action
        values, success, lengths = _by_action(model, ahead, discount)
        greedy = _greedy(values, slack)
        fastest = _fastest(greedy, success, lengths)
        action = fastest.argmax(axis=1)
        return np.stack([values.max(axis=1), success[rows, action], lengths[rows, action]], axis=1)

    now = nothing = np.zeros((model.size, 3))
    for left, ahead, period, repeats in induction(step, nothing, steps, 3 * model.probability.size):
        now = ahead
        first = steps - left - period * repeats
        policies[first : steps - left + 1 : period or 1, model.states] = action
        rounds += 1
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
        residual=float(np.abs(now[:, 0] - values.max(axis=1)).max(initial=0.0)),
        margin=space.spread(
            model, _margins(model, now[:, 0], (steps, rounds), space.largest_reward)
        ),
    )


def optimum_within(space: StateSpace, discount: float, steps: int) -> tuple[float, float, float]:
    """Return what `solve_within` finds of the start, with machine code: for very many levels.

    It is the expected return, the probability of reaching an exit and the expected number of steps,
    but for rounding errors. Large levels and many steps are left to `solve_within`.
    """
    model = space.model()
    if steps >= FIRST_LOOK or model.probability.size > MOST_COMPILED:
        found = solve_within(space, discount, steps)
        return found.expected_return, found.exit_probability, found.expected_steps
    from babyrobot_levels.analysis.solver.compiled.horizon import optimum

    budget.spend(steps * model.probability.size)
    now = optimum(
        model.probability, model.next_state, model.reward, model.success, discount,
        _slack(model, steps), steps,
    )  # fmt: skip
    earned, success, lengths = (space.at_start(model, now[:, column]) for column in range(3))
    return earned, probability(success), lengths


def _slack(model: Model, steps: int) -> float:
    """Return how much may be lost in a step by what is taken for equally good.

    In all steps together it is a share of a reward.
    """
    return TOLERANCE * float(np.abs(model.reward).max(initial=0.0)) / steps


def _margins(model: Model, values: Floats, steps: tuple[int, int], largest: float) -> Floats:
    """Return by how much values may be wrong at most, `[n]`.

    Args:
        model: the states and actions.
        values: the values, `[n]`.
        steps: how many there are, and how many were computed, not repeated.
        largest: the largest reward of a step, or cost.
    """
    size = largest + float(np.abs(values).max(initial=0.0))
    rounding = (model.probability.shape[2] + ROUNDINGS) * UNIT * steps[0]
    repeating = EXACT if steps[1] < steps[0] else 0.0
    return np.full(values.size, (rounding + repeating) * size)


def _greedy(values: Floats, slack: float) -> Flags:
    """Return the actions whose values are those of the best one, `[n, actions]`."""
    best = values.max(axis=1, keepdims=True)
    greedy: Flags = values >= best - np.maximum(_ROUNDING * np.abs(best), slack)
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
    """Return the values of a policy, which may depend on the step, in truncated episodes.

    Raises:
        ValueError: it does not fit, or was made for another limit.
        EpisodeTooLongError: there are so many steps that this takes too long.
    """
    model, weights = space.model(), weights_by_step(policy, space, steps)
    ahead = before = np.zeros((model.size, 3))
    for same in reversed(weights.runs):
        chain = model.mixed(weights(same.start)[model.states])

        def step(ahead: Floats, chain: Model = chain) -> Floats:
            return np.concatenate(_by_action(chain, ahead, discount), axis=1)

        before = after(step, ahead, len(same) - 1, 3 * chain.probability.size)
        ahead = step(before)
    values, *_ = _by_action(model, before, discount)
    return Evaluation(**_facts(space, model, ahead, values), discount=discount, within=steps)


def _facts(space: StateSpace, model: Model, now: Floats, values: Floats) -> dict[str, Any]:
    """Return what the results of solving and of evaluating have in common.

    Args:
        space: the states.
        model: their model.
        now: values, success and steps that are expected with all steps left, `[n, 3]`.
        values: the same values if an action is taken first, `[n, actions]`.
    """
    return {
        "values": space.spread(model, now[:, 0]),
        "action_values": space.spread(model, values),
        "expected_return": space.at_start(model, now[:, 0]),
        "expected_steps": space.at_start(model, now[:, 2]),
        "exit_probability": probability(space.at_start(model, now[:, 1])),
        "actions": space.actions,
        "level": space.level,
    }


@dataclass(frozen=True, eq=False)
class ByStep:
    """A policy that may depend on the step; called with a step, 0 the first, it is a table.

    Attributes:
        space: the states.
        policy: as `read_policy` takes it, or an array of policies with an axis of steps first.
        runs: the steps in which it is the same.
    """

    space: StateSpace
    policy: Any
    runs: Sequence[range]

    def __call__(self, step: int) -> Floats:
        """Return the probability of each action in a step, `[states, actions]`.

        It is the same array for all steps of a run, while few others are asked for.
        """
        return self._of_run(bisect_right(self.runs, step, key=lambda run: run.start) - 1)

    @cached_property
    def _of_run(self) -> Callable[[int], Floats]:
        @lru_cache(256)
        def read(run: int) -> Floats:
            policy = self.policy if len(self.runs) == 1 else self.policy[self.runs[run].start]
            return read_policy(policy, self.space)

        return read


def weights_by_step(
    policy: Any, space: StateSpace, steps: int | None, option: str = "within"
) -> ByStep:
    """Return a policy as one that may depend on the step.

    Args:
        policy: as `read_policy` takes it; or a `Solution` within a limit, its `policies`, or
            another array with an axis of `steps` before the others.
        space: the states.
        steps: the limit of steps; None for none.
        option: the argument that sets this limit, for messages.

    Raises:
        ValueError: it is none of these, or was made for another limit.
    """
    if isinstance(policy, ByStep):
        return policy
    table = getattr(policy, "policies", None)
    shape = getattr(policy, "shape", ())
    shapes = (space.mdp.shape, (*space.mdp.shape, space.num_actions))
    if table is None and shape[1:] in shapes and shape not in shapes:
        table = policy
    if table is None:
        found = ByStep(space, policy, [range(steps or 1)])
    else:
        if len(table) != steps:
            raise ValueError(
                f"the policy is one for episodes of {len(table)} steps; give {option}={len(table)}"
            )
        changes = (table[1:] != table[:-1]).any(axis=tuple(range(1, table.ndim)))
        borders = [0, *(np.flatnonzero(changes) + 1).tolist(), steps]
        runs = [range(*border) for border in pairwise(borders)]
        found = ByStep(space, table[0] if len(runs) == 1 else table, runs)
    found(0)
    return found
