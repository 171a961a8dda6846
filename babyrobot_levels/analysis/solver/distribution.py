"""How likely each return of a policy is: its exact distribution where that is small enough."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.evaluation import (
    MAX_STEPS,
    Chain,
    chain_of,
    chains,
    limit_of,
    simulated_episodes,
)
from babyrobot_levels.analysis.solver.policies import Policy, StateSpace, space_of
from babyrobot_levels.analysis.solver.results import Result, check_discount, check_share
from babyrobot_levels.analysis.solver.within import weights_by_step
from babyrobot_levels.mdp.gridworld import world_of
from babyrobot_levels.mdp.tables import Floats

MAX_OUTCOMES = 4_000_000
"""The most outcomes that are followed, over all steps: about a second."""

_STEP = 400
"""As how many outcomes a step counts, however few there are."""

MAX_PRODUCTS = 400_000_000
"""The most products of probabilities that are added up, over all steps: about a second."""

MAX_SIMULATED = 150_000_000
"""The most steps that simulated episodes take together."""

EPISODES = 10_000
"""The number of simulated episodes where there are more."""

_EQUAL = 1e-9
"""Returns that differ by less, as a share of the largest reward, count as equal."""

MAX_AT_ONCE = 50_000_000
"""The most probabilities that a step makes at once: 400 MB."""

_GRID = 1e9
"""Rewards without a discount are counted in units of 1 / 10^9: whole numbers add up exactly."""

_MAX_TOTAL = 2.0**62 / _GRID
"""The largest return that can be counted like this."""

_REST = 1e-12
"""Episodes are followed until less than this probability of going on is left."""


@dataclass(frozen=True, eq=False)
class ReturnDistribution(Result, public=True):
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

    def __repr__(self) -> str:
        """Return the distribution in short."""
        return (
            f"<ReturnDistribution of {self.values.size:,} returns: mean={self.mean:.6g} "
            f"standard_deviation={self.standard_deviation:.6g}>"
        )

    @property
    def mean(self) -> float:
        """The expected return."""
        return float(self.values @ self.probabilities)

    @property
    def standard_deviation(self) -> float:
        """By how much returns differ from the expected one, as a root mean square."""
        return float(np.sqrt((self.values - self.mean) ** 2 @ self.probabilities))

    def cvar(self, share: float) -> float:
        """Return the mean of the lowest returns: of those of such a share of all episodes.

        It is the conditional value at risk (CVaR), also called expected shortfall, after R. T.
        Rockafellar and S. Uryasev: Conditional value-at-risk for general loss distributions (2002),
        who divide a return at the border between what counts and what does not.

        Args:
            share: above 0 and at most 1, such as 0.1; of 1, it is the mean.

        Raises:
            ValueError: it is not in this range.
        """
        check_share("share", share, is_above_0=True)
        weights = np.diff(np.minimum(np.cumsum(self.probabilities), share), prepend=0.0)
        return float(self.values @ weights / weights.sum())

    def quantiles(self, shares: Floats) -> Floats:
        """Return the smallest return that at least such a share of episodes does not exceed.

        Raises:
            ValueError: a share is not from 0 to 1.
        """
        for share in np.ravel(shares).tolist():
            check_share("each share", share)
        reached = np.searchsorted(np.cumsum(self.probabilities), np.asarray(shares) - _REST)
        return np.asarray(self.values[np.minimum(reached, self.values.size - 1)])


def return_distribution(
    level: Any,
    policy: Policy,
    within: int | str | None = None,
    *,
    discount: float | None = None,
    actions: str = "all",
) -> ReturnDistribution:
    """Return the distribution of the return of a policy.

    States and returns so far are followed step by step, with equal ones merged, so that it is
    exact where returns are few: where rewards are multiples of one number and there is no discount,
    or chance is rare. Where that would take much more than a second, it is that of 10,000 simulated
    episodes (of seed 0).

    Args:
        level: a name, a path, a mapping or a `Level`.
        policy: as `evaluate` takes it.
        within: the number of steps after which episodes are truncated, or `"max_steps"`. By
            default that of the policy, if it is a `Solution` within one, else the level's
            `max_steps`, or 10,000 where it has none.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"all"`, `"moves"` without stay, or `"turns"`: turn left, turn right, forward.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has an invalid value.
        EpisodeTooLongError: episodes take so many steps that simulating them takes too long.
    """
    level = world_of(level)
    discount = check_discount(discount, level.discount)
    limit = limit_of(within, policy, level) or level.max_steps or MAX_STEPS
    return distribution_of(space_of(level, actions, discount), policy, discount, limit)


def distribution_of(
    space: StateSpace, policy: Policy, discount: float, limit: int
) -> ReturnDistribution:
    """Do what `return_distribution` does.

    Args:
        space: the states of the level.
        policy: the policy.
        discount: the discount factor.
        limit: the number of steps after which episodes are truncated.

    Raises:
        EpisodeTooLongError: they would take longer.
    """
    chain_at = chains(space, weights_by_step(policy, space, limit))
    largest = float(np.abs(space.mdp.reward).max(initial=0.0))
    followed = None
    if discount == 1 and largest * limit < _MAX_TOTAL:
        followed = _counted(chain_at, space.mdp.start, limit)
    if followed is None:
        followed = _followed(chain_at, space.mdp.start, discount, limit, largest)
    if followed is not None:
        values, probabilities = followed
        return ReturnDistribution(values, probabilities, 0, discount, limit)
    simulated = simulated_episodes(
        space, policy, EPISODES, 0, discount=discount, limit=limit, most=MAX_SIMULATED
    )
    values, counts = np.unique(simulated.returns, return_counts=True)
    return ReturnDistribution(values, counts / EPISODES, EPISODES, discount, limit)


def open_loop_distribution(
    space: StateSpace, start: int, taken: Sequence[int], discount: float
) -> ReturnDistribution | None:
    """Return the distribution of the return if given actions are taken, whatever comes of them.

    An episode that ends before the last action keeps the return that it has then.

    Args:
        space: the states of the level.
        start: the state in which the episode starts.
        taken: the actions, in their order, numbered from 0 as the set of `space` has them.
        discount: the factor by which each further reward counts less.

    Returns:
        The exact distribution; None where too many outcomes would have to be followed.
    """
    mdp, first = space.mdp, space.first_action
    rows = np.eye(mdp.num_actions - first)

    @cache
    def chain_of_action(action: int) -> Chain:
        return chain_of(space, np.tile(rows[action], (mdp.num_states, 1)))

    largest = float(np.abs(mdp.reward).max(initial=0.0))
    begin = np.zeros(mdp.num_states)
    begin[start] = 1.0
    steps = len(taken)
    found = _followed(lambda step: chain_of_action(taken[step]), begin, discount, steps, largest)
    return None if found is None else ReturnDistribution(*found, 0, discount, steps)


def _counted(
    chain_at: Callable[[int], Chain], start: Floats, limit: int
) -> tuple[Floats, Floats] | None:
    """Return what `_followed` does, without a discount: faster where many states share returns.

    The probabilities of all states for each return so far, `[returns, states]`, are multiplied by
    those of a step, once for all returns.
    """
    from scipy.sparse import csr_array  # type: ignore[import-untyped]

    total, mass = np.zeros(1, np.int64), start[None, :]
    totals, masses, products = [], [], 0
    last: Chain | None = None
    for step in range(limit):
        chain = chain_at(step)
        if chain is not last:
            last = chain
            state, which = np.nonzero(chain.probability)
            chance, ends = chain.probability[state, which], chain.terminal[state, which]
            counted = np.rint(_GRID * chain.reward[state, which]).astype(np.int64)
            reward, column = np.unique(counted, return_inverse=True)
            shape = len(reward), start.size
            # What ends stands behind what goes on.
            column = column * start.size + chain.next_state[state, which]
            column += ends * len(reward) * start.size
            ahead = csr_array((chance, (state, column)), (start.size, 2 * shape[0] * shape[1]))
        made = len(total) * ahead.shape[1]
        products += len(total) * ahead.nnz + made
        if products > MAX_PRODUCTS or made > MAX_AT_ONCE:
            return None
        moved, over = np.split((mass @ ahead).reshape(len(total), -1, start.size), 2, axis=1)
        after = total[:, None] + reward
        totals.append(after.ravel())
        masses.append(over.sum(axis=2).ravel())
        total, row = np.unique(after, return_inverse=True)
        mass, row = np.zeros((len(total), start.size)), row.reshape(after.shape)
        for number in range(len(reward)):
            mass[row[:, number]] += moved[:, number]
        is_there = mass.any(axis=1)
        total, mass = total[is_there], mass[is_there]
        if mass.sum() < _REST:
            break
    totals.append(total)
    masses.append(mass.sum(axis=1))
    values, which = np.unique(np.concatenate(totals), return_inverse=True)
    probabilities = np.bincount(which, np.concatenate(masses))
    is_there = probabilities > 0
    return values[is_there] / _GRID, (probabilities / probabilities.sum())[is_there]


def _followed(
    chain_at: Callable[[int], Chain],
    start: Floats,
    discount: float,
    limit: int,
    largest_reward: float,
) -> tuple[Floats, Floats] | None:
    """Return the possible returns and their probabilities; None if there are too many."""
    unit = _EQUAL * max(1.0, largest_reward)
    state = np.flatnonzero(start)
    mass, total = start[state], np.zeros(state.size)
    ended = np.empty(0), np.empty(0)
    factor, outcomes = 1.0, 0
    for step in range(limit):
        chain = chain_at(step)
        outcomes += state.size * chain.probability.shape[1] + ended[0].size + _STEP
        if outcomes > MAX_OUTCOMES:
            return None
        ahead = mass[:, None] * chain.probability[state]
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
