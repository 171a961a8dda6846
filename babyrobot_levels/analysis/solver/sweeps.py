"""Solving large levels with machine code, where Numba is installed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.compiled import is_compiled
from babyrobot_levels.analysis.solver.model import Model, kernel_arrays
from babyrobot_levels.mdp.tables import Floats, Ints

ROUNDING = 1e-14
"""Actions whose values differ by no more than this share of the largest one are equal."""

Found = tuple[Floats, Callable[[], Ints], int]
"""Optimal values, `[n]`, what finds a policy that attains them, and how many sweeps it took."""


def settled(model: Model, prefer: Callable[[], Ints], discount: float) -> Found | None:
    """Return the optimum of a large model by values that may begin anywhere.

    Args:
        model: the states and actions.
        prefer: returns the actions to prefer among equal ones, `[n]`.
        discount: the discount.

    Returns:
        None where there is no Numba, or values do not settle, or where the Bellman equation has
        other solutions, too: without a discount, where steps cost nothing.
    """
    if not is_compiled(model.size):
        return None
    cheapest = np.inf
    if discount == 1:
        cheapest = -model.reward[model.inner].max(initial=-np.inf)
        if cheapest <= 0:
            return None
    search, order, borders = _search(model, discount)
    if not search.begin(borders) or not search.run():
        return None
    values, margin = np.empty(model.size), ROUNDING * search.scale
    if discount == 1 and cheapest <= margin:
        return None
    values[order] = search.values[:-1]

    def policy() -> Ints:
        ahead, preferred = model.action_values(values, discount), prefer()
        least = ahead.max(axis=1) - margin
        best = (ahead >= least[:, None]).argmax(axis=1)
        return np.where(ahead[np.arange(model.size), preferred] >= least, preferred, best)

    return values, policy, search.rounds


def raised(model: Model, policy: Ints, discount: float, slack: float) -> Found | None:
    """Return the optimum of a large model by values that rise from those of a policy.

    Args:
        model: the states and actions.
        policy: the policy, `[n]`; without a discount, one that ends with probability one.
        discount: the discount.
        slack: what is better by no more than this share of the largest value does not count.

    Returns:
        None where there is no Numba, or the end is too far away for floating point.
    """
    if not is_compiled(model.size):
        return None
    search, order, _ = _search(model, discount)
    if not search.climb(policy[order], slack):
        return None
    values, chosen = np.empty(model.size), np.empty(model.size, np.int64)
    values[order], chosen[order] = search.values[:-1], search.chosen
    return values, lambda: chosen, search.rounds


def _search(model: Model, discount: float) -> Any:
    """Return a search in a model, the order of its states there, and the borders of distances."""
    from babyrobot_levels.analysis.solver.compiled import iteration, rows

    distance, nodes, neighbours = model.order
    order, borders = rows.ordered(distance, nodes)
    reward = np.ascontiguousarray(model.reward)
    _, actions, outcomes = model.probability.shape
    shape = rows.shape_of(actions, outcomes, neighbours)
    made = rows.rows_of(order, *kernel_arrays(model), reward, discount, *shape)
    return iteration.Search(made), order, borders
