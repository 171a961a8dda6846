"""The linear systems of chains, solved directly: dense where small, sparse where large."""

from __future__ import annotations

import numpy as np

from babyrobot_levels.solver.graphs import closed_classes
from babyrobot_levels.solver.model import Floats, Ints, Model

DENSE_STATES = 150
"""Up to so many states, dense elimination is faster than sparse, and needs no SciPy."""


def expected_sums(chain: Model, rewards: Floats, discount: float) -> Floats:
    """Return the expected discounted sum of what each step gives, until the end.

    Args:
        chain: a model with one action. Without a discount, each state must lead to the end with
            probability one.
        rewards: what a step from each state gives, `[n]`, or several such columns, `[n, columns]`.
        discount: the factor by which each further step counts less.

    Returns:
        The sums, shaped as `rewards`.
    """
    size = chain.size
    if size == 0:
        return rewards.copy()
    weights = discount * chain.probability[:, 0]
    if size <= DENSE_STATES:
        cells = np.arange(size)[:, None] * (size + 1) + chain.next_state[:, 0]
        flat = np.bincount(cells.ravel(), weights.ravel(), size * (size + 1))
        solved: Floats = np.linalg.solve(
            np.eye(size) - flat.reshape(size, size + 1)[:, :size], rewards
        )
        return solved
    from scipy.sparse import csc_array, eye_array  # type: ignore[import-untyped]
    from scipy.sparse.linalg import splu  # type: ignore[import-untyped]

    source, outcome = np.nonzero((weights > 0) & (chain.next_state[:, 0] < size))
    target = chain.next_state[source, 0, outcome]
    steps = csc_array((weights[source, outcome], (source, target)), shape=(size, size))
    matrix = (eye_array(size, format="csc") - steps).tocsc()
    factors = splu(matrix)
    sums: Floats = factors.solve(rewards)
    # One step of refinement takes away most of the elimination's rounding.
    return sums + factors.solve(rewards - matrix @ sums)


def averages(chain: Model, rewards: Floats, label: Ints) -> tuple[Floats, Floats]:
    """Return what a chain gives on average, per step, in the long run.

    Args:
        chain: a model with one action, of which no state ever ends.
        rewards: what a step from each state gives, `[n]`.
        label: as `closed_classes` returns it.

    Returns:
        The average of each state's class, `[n]`, nan for states of no class; and the bias: how
        much more than the average a state gets before the chain is at the first state of its
        class, `[n]`, which means something only if there is a single class.
    """
    _, first, inverse = np.unique(label, return_index=True, return_inverse=True)
    home = first[inverse]
    is_first = np.zeros(chain.size, bool)
    is_first[first] = True
    is_first &= label >= 0
    others = ~is_first
    columns = np.stack([rewards, np.ones(chain.size)], axis=1)
    until_home = np.zeros((chain.size + 1, 2))
    until_home[:-1][others] = expected_sums(chain.restrict(others), columns[others], 1.0)
    following = until_home[chain.next_state[:, 0]]
    gained, time = (columns + np.einsum("so,soc->sc", chain.probability[:, 0], following)).T
    average = np.where(label >= 0, (gained / time)[home], np.nan)
    bias = until_home[:-1, 0] - np.nan_to_num(average) * until_home[:-1, 1]
    return average, bias


def class_averages(chain: Model) -> Floats:
    """Return the average reward of each closed class, `[n]`; nan for states of none."""
    label = closed_classes(chain)
    found = np.full(chain.size, np.nan)
    kept = label >= 0
    found[kept] = averages(chain.restrict(kept), chain.reward[kept, 0], label[kept])[0]
    return found
