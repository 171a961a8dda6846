"""How likely each return of a policy is: its exact distribution where that is small enough."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.chain import Chain, chain_of
from babyrobot_levels.analysis.solver.evaluation import MAX_STEPS, simulate
from babyrobot_levels.analysis.solver.model import Floats
from babyrobot_levels.analysis.solver.policies import Policy
from babyrobot_levels.analysis.solver.results import Result, check_discount
from babyrobot_levels.analysis.solver.space import space_of
from babyrobot_levels.library.catalogue import load

MAX_OUTCOMES = 4_000_000
"""The most outcomes that are followed, over all steps: about a second."""

EPISODES = 10_000
"""The number of simulated episodes where there are more."""

_EQUAL = 1e-9
"""Returns that differ by less, as a share of the largest reward, count as equal."""

_REST = 1e-12
"""Episodes are followed until less than this probability of going on is left."""


@dataclass(frozen=True, eq=False)
class ReturnDistribution(Result):
    """The distribution of the return of an episode. All arrays are read-only.

    Attributes:
        values: the returns that are possible, ascending, float64 `[n]`.
        probabilities: how likely each of them is, float64 `[n]`; they add up to 1.
        episodes: 0 for an exact distribution; else the number of simulated episodes.
        discount: the factor by which each further reward counts less.
        max_steps: the number of steps after which episodes are truncated.
    """

    values: Floats
    probabilities: Floats
    episodes: int
    discount: float
    max_steps: int

    @property
    def mean(self) -> float:
        """The expected return."""
        return float(self.values @ self.probabilities)

    def quantiles(self, shares: Floats) -> Floats:
        """Return the smallest return that at least such a share of episodes does not exceed."""
        reached = np.searchsorted(np.cumsum(self.probabilities), np.asarray(shares) - _REST)
        return np.asarray(self.values[np.minimum(reached, self.values.size - 1)])


def return_distribution(
    level: Any,
    policy: Policy,
    within: int | None = None,
    *,
    discount: float | None = None,
    actions: str = "all",
) -> ReturnDistribution:
    """Return the distribution of the return of a policy.

    States and returns so far are followed step by step, with equal ones merged, so that it is
    exact where returns are few: where rewards are multiples of one number, or chance is rare.
    Where more than 4 million outcomes would have to be followed, it is that of 10,000 simulated
    episodes (of seed 0).

    Args:
        level: a name, a path, a mapping or a `Level`.
        policy: as `evaluate` takes it.
        within: the number of steps after which episodes are truncated. By default, the level's
            `max_steps`, or 10,000 where it has none.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"all"`, `"moves"` without stay, or `"turns"`: turn left, turn right, forward.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has an invalid value.
    """
    level = load(level)
    discount = check_discount(discount, level.discount)
    limit = within if within is not None else level.max_steps or MAX_STEPS
    if limit < 1:
        raise ValueError(f"within must be at least 1, not {limit}")
    space = space_of(level, actions)
    followed = _followed(chain_of(space, policy), space.mdp.start, discount, limit)
    if followed is not None:
        values, probabilities = followed
        return ReturnDistribution(values, probabilities, 0, discount, limit)
    simulated = simulate(
        level, policy, EPISODES, discount=discount, max_steps=limit, actions=actions
    )
    values, counts = np.unique(simulated.returns, return_counts=True)
    return ReturnDistribution(values, counts / EPISODES, EPISODES, discount, limit)


def _followed(
    chain: Chain, start: Floats, discount: float, limit: int
) -> tuple[Floats, Floats] | None:
    """Return the possible returns and their probabilities; None if there are too many."""
    probability = np.diff(chain.cumulated, axis=1, prepend=0.0)
    unit = _EQUAL * max(1.0, float(np.abs(chain.reward[probability > 0]).max(initial=0.0)))
    state = np.flatnonzero(start)
    mass, total = start[state], np.zeros(state.size)
    ended = np.empty(0), np.empty(0)
    factor, outcomes = 1.0, 0
    for _ in range(limit):
        outcomes += state.size * probability.shape[1] + ended[0].size
        if outcomes > MAX_OUTCOMES:
            return None
        ahead = mass[:, None] * probability[state]
        row, which = np.nonzero(ahead)
        mass, here = ahead[row, which], state[row]
        total = total[row] + factor * chain.reward[here, which]
        state, is_over = chain.next_state[here, which], chain.terminal[here, which]
        over, over_mass = (
            np.concatenate([past, new[is_over]])
            for past, new in zip(ended, (total, mass), strict=True)
        )
        _, over, over_mass = _merged(np.zeros(over.size, np.intp), over, over_mass, unit)
        ended = over, over_mass
        state, total, mass = _merged(state[~is_over], total[~is_over], mass[~is_over], unit)
        if mass.sum() < _REST:
            break
        factor *= discount
    values, probabilities = (
        np.concatenate([past, rest]) for past, rest in zip(ended, (total, mass), strict=True)
    )
    _, values, probabilities = _merged(np.zeros(values.size, np.intp), values, probabilities, unit)
    return values, probabilities / probabilities.sum()


def _merged(state: Any, total: Floats, mass: Floats, unit: float) -> tuple[Any, Floats, Floats]:
    """Return states and returns with their probabilities, equal ones as one, ascending."""
    if not state.size:
        return state, total, mass
    key = np.rint(total / unit)
    order = np.lexsort((key, state))
    state, total, mass, key = state[order], total[order], mass[order], key[order]
    first = np.flatnonzero(np.append(True, (np.diff(state) != 0) | (np.diff(key) != 0)))
    return state[first], total[first], np.add.reduceat(mass, first)
