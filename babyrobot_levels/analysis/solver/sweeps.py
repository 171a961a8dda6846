"""Solving large levels with machine code, where Numba is installed."""

from __future__ import annotations

import numpy as np

from babyrobot_levels.analysis.solver.compiled import is_compiled
from babyrobot_levels.analysis.solver.model import Model, kernel_arrays
from babyrobot_levels.mdp.tables import Floats, Ints

ROUNDING = 1e-14
"""Actions whose values differ by no more than this share of the largest one are equal."""

Found = tuple[Floats, Ints, int]
"""Optimal values, `[n]`, a policy that attains them, `[n]`, and the number of sweeps it took."""


def settled(model: Model, policy: Ints, discount: float) -> Found | None:
    """Return the optimum of a large model by values that may begin anywhere.

    Args:
        model: the states and actions.
        policy: the actions to prefer among equal ones, `[n]`.
        discount: the discount.

    Returns:
        None where there is no Numba, or values do not settle, or where the Bellman equation has
        other solutions, too: without a discount, where steps cost nothing.
    """
    if not is_compiled(model.size):
        return None
    cheapest = np.inf
    if discount == 1:
        cheapest = np.where(model.inner, -model.reward, np.inf).min(initial=np.inf)
        if cheapest <= 0:
            return None
    from babyrobot_levels.analysis.solver.compiled import iteration, rows, tables

    order, borders = rows.ordered(*model.order)
    reward = np.ascontiguousarray(model.reward)
    search = iteration.Search(rows.rows_of(order, *kernel_arrays(model), reward, discount))
    if not search.begin(borders) or not search.run():
        return None
    values, margin = np.empty(model.size), ROUNDING * search.scale
    if discount == 1 and cheapest <= margin:
        return None
    values[order] = search.values
    policy = policy.copy()
    for part in rows.parts(model.size):
        tables.keep_best(*kernel_arrays(model), reward, values, discount, margin, policy, *part)
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
    from babyrobot_levels.analysis.solver.compiled import iteration, rows

    order, _ = rows.ordered(*model.order)
    reward = np.ascontiguousarray(model.reward)
    search = iteration.Search(rows.rows_of(order, *kernel_arrays(model), reward, discount))
    if not search.climb(search.rows.row_of(policy[order], reward.shape[1]), slack):
        return None
    values, chosen = np.empty(model.size), np.empty(model.size, np.int64)
    values[order], chosen[order] = search.values, search.rows.action[search.chosen]
    return values, chosen, search.rounds
