"""Solving large levels with compiled sweeps, where Numba is installed."""

import numpy as np

from babyrobot_levels.analysis.solver.compiled import kernel_for
from babyrobot_levels.analysis.solver.model import Model, kernel_arrays
from babyrobot_levels.mdp.tables import Floats, Ints
from babyrobot_levels.text import budget

FEW_NEIGHBOURS = 2.5
"""Where states lead to fewer others than this on average, as in mazes, elimination is faster."""

MOST_SWEEPS = 200
"""After so many sweeps over all states, elimination does it."""

ROUNDING = 1e-14
"""Actions whose values differ by no more than this share of the largest one are equal."""


def swept(model: Model, policy: Ints, discount: float) -> tuple[Floats, Ints, int] | None:
    """Return optimal values, `[n]`, a policy that attains them, `[n]`, and the rounds it took.

    Args:
        model: the states and actions.
        policy: the actions to prefer among equal ones, `[n]`.
        discount: the discount.

    Returns:
        None where there is no Numba, or another way is faster, or sweeps do not find them: where
        loops cost nothing, other values solve the equations too.
    """
    kernel = kernel_for(model.size)
    if kernel is None:
        return None
    rows = model.allowed
    inner = rows & ~model.leads_to(model.end)
    cheapest = np.where(inner, -model.reward, np.inf).min()
    if discount == 1 and cheapest <= 0:
        return None
    following, probability = kernel_arrays(model)
    begin, states = kernel.before(following, probability, rows, model.size)
    if states.size < FEW_NEIGHBOURS * model.size:
        return None
    distance, order = kernel.distances(begin, states, model.end)
    order = order[1:]
    if order.size < model.size:
        return None
    first = np.searchsorted(distance[order], np.arange(1, distance.max() + 2))
    reward = np.ascontiguousarray(model.reward)
    cost = 2 * probability.size
    most = min(MOST_SWEEPS, budget.left() / cost)
    values, rounds, left = kernel.solve(
        order, first, following, probability, reward, discount, most
    )
    budget.spend(cost * (most - left))
    values = values[:-1]
    margin = ROUNDING * np.abs(values).max()
    if not rounds or (discount == 1 and cheapest <= margin):
        return None
    ahead = model.action_values(values, discount)
    equal = ahead >= ahead.max(axis=1, keepdims=True) - margin
    kept = equal[np.arange(model.size), policy]
    return values, np.where(kept, policy, equal.argmax(axis=1)), rounds
