"""Bounds of optimal values that floating point has found, rounding included.

A function u with `T u <= u`, where T is the Bellman operator, is an upper bound of the optimal
values, and one with `T l >= l` a lower bound, as iterating T from them shows: what interval
iteration and optimistic value iteration rely on (S. Haddad and B. Monmege, 2018; A. Hartmanns and
B. L. Kaminski, 2020). Here both are the values found, moved by as much as they violate the Bellman
equation, once for each step that may be left: `v + d h` and `v - d h`. With a discount g, h is
1 / (1 - g). Without one, if each step costs at least c and the last one brings at most m more,
h = (m - v) / c: a step whose value falls short by e lowers h by 1 + e / c or more.
"""

from __future__ import annotations

import numpy as np

from babyrobot_levels.analysis.solver.compiled import is_compiled
from babyrobot_levels.analysis.solver.model import Model, kernel_arrays
from babyrobot_levels.mdp.tables import Floats

UNIT = 2.0**-53
"""The largest rounding of a number, as a share of it."""

ROUNDINGS = 8
"""So often, and once for each outcome, numbers are rounded on the way from a file to a value."""


def margins(model: Model, values: Floats, discount: float, largest: float) -> Floats:
    """Return by how much values may be wrong at most, `[n]`.

    Args:
        model: the states and actions.
        values: their optimal values, as found, `[n]`.
        discount: the discount.
        largest: the largest reward of a step, or cost.

    Returns:
        The margins; 0 where values are infinite. Without a discount, inf where steps that cost
        nothing leave room for other solutions of the Bellman equation.
    """
    is_finite, rows = np.isfinite(values), model.allowed
    if not is_finite.all():
        rows = rows & is_finite[:, None] & ~model.leads_to(np.append(~is_finite, False))
    if not rows.any():
        return np.zeros(model.size)
    excess = 2 * _violation(model, np.where(is_finite, values, 0.0), rows, discount, largest)
    if discount < 1:
        return np.where(is_finite, excess / (1.0 - discount), 0.0)
    steps, cost = _most_steps(model, np.where(is_finite, values, 0.0), rows)
    # The argument needs that what is violated is less than what a step costs.
    return np.where(is_finite, excess * steps if 2 * excess < cost else np.inf, 0.0)


def _violation(
    model: Model, values: Floats, rows: np.ndarray, discount: float, largest: float
) -> float:
    """Return by how much values violate the Bellman equation at most, in whatever rounding."""
    rounding = (model.probability.shape[2] + ROUNDINGS) * UNIT
    if is_compiled(model.size):
        from babyrobot_levels.analysis.solver.compiled.tables import violation

        sizes = largest + (float(np.abs(values).max()) if discount < 1 else 0.0)
        reward = model.reward if rows is model.allowed else np.where(rows, model.reward, -np.inf)
        known = np.append(values, 0.0)
        return violation(*kernel_arrays(model), reward, known, discount, rounding, sizes)
    # By differences between neighbours: these are small, however large the values are.
    change = np.append(values, 0.0)[model.next_state] - values[:, None, None]
    gain = discount * np.einsum("sao,sao->sa", model.probability, change)
    gain += model.reward - (1.0 - discount) * values[:, None]
    size = np.einsum("sao,sao->sa", model.probability, np.abs(change)) + largest
    if discount < 1:
        # The discount itself is rounded.
        size += np.abs(values).max()
    unsure = rounding * size
    above = np.where(rows, gain + unsure, -np.inf).max()
    below = np.where(rows, gain - unsure, -np.inf).max(axis=1)
    return float(max(above, -below[rows.any(axis=1)].min()))


def _most_steps(model: Model, values: Floats, rows: np.ndarray) -> tuple[Floats, float]:
    """Return how many steps may be left, `[n]`, and what each costs at least."""
    ends = model.ending
    inner, last = rows & (ends == 0), rows & (ends > 0)
    cost = float(-model.reward[inner].max(initial=-1.0 if not inner.any() else -np.inf))
    if not last.any() or cost <= 0:
        return values, 0.0
    most = float(((model.reward[last] + cost) / ends[last]).max())
    return (most - values) / cost, cost
