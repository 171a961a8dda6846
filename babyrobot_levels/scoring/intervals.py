"""Confidence intervals of mean returns from few episodes, by the extremes that returns can have.

What a few episodes did not show can still happen: an agent that reaches the exit in one episode of
a hundred mostly fails thirty times in a row. So an interval has to know the range of returns. This
is the bound of Gaffke (2005); see Learned-Miller and Thomas, A new confidence interval for the mean
of a bounded random variable (2019), who conjecture that it always holds. Of returns with two
values, the lowest and the highest, it is the interval of Clopper and Pearson.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.analysis.solver.policies import StateSpace
from babyrobot_levels.mdp.tables import Floats

_TAIL = 0.025
"""The chance that an interval of 95 % lies below what it is of, and that it lies above."""

_DRAWS = 4000
"""How often weights are drawn: the ends vary by about 2 % of the width of the interval."""

_APART = 500
"""So many of the lowest and of the highest values are weighted alone; if there are more, those
between them are in twice as many groups."""

_MOST_SWEEPS, _MOST_WORK = 10_000, 500_000_000
"""After so many sweeps, or outcomes of all sweeps, extremes are bounded by those of rewards."""


@dataclass(frozen=True, eq=False, slots=True)
class Played:
    """The episodes of an agent in a level.

    Attributes:
        returns: `[episodes]`.
        lowest: the lowest return that there can be.
        highest: the highest.
    """

    returns: Floats
    lowest: float
    highest: float

    def interval(self) -> tuple[float, float]:
        """Return a 95 % confidence interval of the expected return."""
        return interval(self.returns, self.lowest, self.highest)


def interval(values: Floats, low: float, high: float) -> tuple[float, float]:
    """Return a 95 % confidence interval of the mean that values are drawn from.

    Args:
        values: `[n]`, independent of each other.
        low: the lowest value that there can be.
        high: the highest.
    """
    distinct, counts = _grouped(*np.unique(values, return_counts=True))
    random = np.random.default_rng(0)
    weights = random.standard_gamma([*counts, 1.0], (_DRAWS, len(counts) + 1))
    weights /= weights.sum(axis=1, keepdims=True)
    known, unknown, mean = weights[:, :-1] @ distinct, weights[:, -1], float(values.mean())
    least = float(np.quantile(known + unknown * low, _TAIL))
    most = float(np.quantile(known + unknown * high, 1 - _TAIL))
    return min(least, mean), max(most, mean)


def _grouped(values: Floats, counts: NDArray[Any]) -> tuple[Floats, NDArray[Any]]:
    """Return sorted values and how often they are there, with their means if they are many."""
    if len(values) <= 4 * _APART:
        return values, counts
    inner = np.linspace(_APART, len(values) - _APART, 2 * _APART, endpoint=False).astype(int)
    starts = np.concatenate([np.arange(_APART), inner, np.arange(-_APART, 0) + len(values)])
    sizes = np.add.reduceat(counts, starts)
    return np.add.reduceat(values * counts, starts) / sizes, sizes


def extremes(space: StateSpace, limit: int, discount: float) -> tuple[float, float]:
    """Return bounds of the return of an episode, whatever is done and whatever comes of it.

    They are the lowest and the highest return there can be, unless it would take long to find them.

    Args:
        space: the level.
        limit: the number of steps after which episodes are truncated.
        discount: the factor by which each further reward counts less.
    """
    return _least(space, limit, discount, 1.0), -_least(space, limit, discount, -1.0)


def _least(space: StateSpace, limit: int, discount: float, sign: float) -> float:
    """Return the lowest return there can be, of rewards with a sign."""
    mdp, actions = space.mdp, slice(space.first_action, None)
    is_possible = mdp.probability[:, actions] > 0
    reward = np.where(is_possible, sign * mdp.reward[:, actions], np.inf)
    goes_on = np.where(mdp.terminal[:, actions], 0.0, discount)
    following, is_over = mdp.next_state[:, actions], mdp.is_terminal
    is_start = mdp.start > 0
    values = np.zeros(mdp.num_states)
    most = min(limit, _MOST_SWEEPS, max(1, _MOST_WORK // reward.size))
    for sweep in range(1, most + 1):
        found = (reward + goes_on * values[following]).min(axis=(1, 2))
        found[is_over] = 0.0
        change, values = (found - values)[~is_over], found
        # What falls as much everywhere, by going on, goes on to fall like this.
        if sweep > 1 and change.max() == change.min() <= 0 and (discount == 1 or not change.max()):
            return float(values[is_start].min() + (limit - sweep) * change.min())
    # The steps before the last `most` ones have at least the lowest reward, or none.
    ahead = (limit - most) * min(0.0, float(reward.min()))
    return ahead + float(values[is_start].min() if most == limit else min(0.0, values.min()))
