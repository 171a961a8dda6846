"""Policy iteration: from a policy that ends, or has a discount, to one that nothing improves."""

from __future__ import annotations

import numpy as np

from babyrobot_levels.analysis.solver.linear import expected_sums
from babyrobot_levels.analysis.solver.model import Floats, Ints, Model, surely_ending
from babyrobot_levels.analysis.solver.results import EpisodeTooLongError

SLACK = 1e-14
"""Improvements by no more than this share of the largest value are rounding errors."""

TIE = 1e-13
"""Actions that differ by no more than this share of the largest value are equally good."""

MAX_SWEEPS = 30
"""Sweeps between two exact evaluations. They only save time."""

IMPATIENCE = 1e-5
"""The chance to give up at each step, in the search for a policy that ends soon."""


def iterate_policies(model: Model, policy: Ints, discount: float) -> tuple[Floats, Ints, int]:
    """Return optimal values, `[n]`, a policy that attains them, `[n]`, and the rounds it took.

    Without a discount, `policy` must lead to the end with probability one, and so does the
    result: an action is replaced only by one that is strictly better, which creates no loop unless
    its rewards are positive.

    Each round evaluates the policy exactly and then improves it by sweeps of value iteration, so
    that a change spreads over the whole level and not by one cell. The last round raises no value
    by more than rounding; values cannot rise for ever, so there is one.
    """
    values = expected_sums(model.under(policy), _rewards(model, policy), discount)
    rounds = 1
    while True:
        improved = _sweep(model, values, policy, discount)
        if (improved == policy).all():
            return values, policy, rounds
        risen = expected_sums(model.under(improved), _rewards(model, improved), discount)
        rounds += 1
        if not (risen > values + SLACK / 2 * scale_of(model, values)).any():
            return values, policy, rounds
        values, policy = risen, improved


def _rewards(model: Model, policy: Ints) -> Floats:
    rewards: Floats = model.reward[np.arange(model.size), policy]
    return rewards


def scale_of(model: Model, values: Floats) -> float:
    """Return the largest size of a value or a reward."""
    rewards = np.abs(model.reward[model.allowed])
    return float(max(np.abs(values).max(initial=0), rewards.max(initial=0)))


def _sweep(model: Model, values: Floats, policy: Ints, discount: float) -> Ints:
    """Return the policy after sweeps of value iteration, as long as they change it."""
    rows = np.arange(model.size)
    slack = SLACK * scale_of(model, values)
    for _ in range(MAX_SWEEPS):
        ahead = model.action_values(values, discount)
        own, best = ahead[rows, policy], ahead.argmax(axis=1)
        better = ahead[rows, best] > own + slack
        if not better.any():
            break
        policy = np.where(better, best, policy)
        values = np.where(better, ahead[rows, best], own)
    return policy


def in_good_time(model: Model, policy: Ints) -> Ints:
    """Return a policy that ends with probability one, and does so in good time.

    Args:
        model: the states and actions, of which every state can surely end.
        policy: a policy that ends with probability one, but perhaps only after more steps than
            floating point can count.
    """
    chain = model.under(policy)
    if np.isin(chain.probability, (0.0, 1.0)).all():
        return policy
    # With a chance to give up at each step, any policy will do to start from. And a policy that
    # maximizes its chance to end never settles in a loop: there, it would have none.
    ends = np.where(model.next_state == model.size, model.probability, 0.0).sum(axis=2)
    chances = model.with_rewards(np.where(model.allowed, ends, -np.inf))
    own = expected_sums(chain, _rewards(chances, policy), 1.0 - IMPATIENCE)
    if own.min(initial=1.0) > 0.5:
        return policy
    return iterate_policies(chances, policy, 1.0 - IMPATIENCE)[1]


def prefer_ending(model: Model, values: Floats, policy: Ints, discount: float) -> Ints:
    """Return an optimal policy that ends as soon as can be expected, where it can surely end.

    Where even that takes too long for floating point, the policy stays as it is.

    Args:
        model: the states and actions.
        values: their optimal values, `[n]`.
        policy: an optimal policy, which stays where the end cannot be reached for sure.
        discount: the discount.
    """
    ahead = model.action_values(values, discount)
    tie = TIE * scale_of(model, values)
    sure, action, rows = surely_ending(model, ahead >= ahead.max(axis=1, keepdims=True) - tie)
    if not sure.any():
        return policy
    ending = model.restrict(sure, rows)
    counting = ending.with_rewards(np.where(ending.allowed, -1.0, -np.inf))
    try:
        _, quickest, _ = iterate_policies(counting, in_good_time(ending, action[sure]), 1.0)
    except EpisodeTooLongError:
        return policy
    policy = policy.copy()
    policy[sure] = quickest
    return policy
