"""What is known of the value of a belief without looking ahead: bounds from above and below.

From above: an agent that will see everything from the next step on (QMDP: Littman, Cassandra and
Kaelbling 1995), and better, one that will know from the next step on in which state it was before
(the fast informed bound: Hauskrecht 2000). Every round of its iteration is a bound, also without a
discount. From below: agents without memory, which take actions by chance that depend on what they
observe; what they are worth in each hidden state is exact. Taking all actions evenly ends each
episode that can end, so that this bound is finite where a discount, or a way to the end from
everywhere, makes it so.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.evaluation import action_values, chain_values
from babyrobot_levels.analysis.solver.optimum import undiscounted
from babyrobot_levels.analysis.solver.results import EpisodeTooLongError, UndefinedReturnError
from babyrobot_levels.extensions.sight.model import PartialModel
from babyrobot_levels.mdp.tables import Floats, Ints

MAX_NUMBERS = 60_000_000
"""The most numbers in the bounds of all steps up to a limit."""

_SHARES = (0.0, 0.01, 0.1, 0.3)
"""How often memoryless agents take any action."""

_ROUNDS = 100
"""The most rounds of iteration; others improve the bound by next to nothing."""

_SMALL = 1e-9
"""Improvements by no more than this share of the largest value end the iteration."""


@dataclass(frozen=True, eq=False)
class Bounds:
    """Bounds of the values of beliefs, linear in the belief: the best of their columns counts.

    Attributes:
        upper: `[times, n, actions]`, a column for each first action. Without a limit of steps,
            there is a single time; else time t has t steps left.
        lower: `[times, n, agents]`, a column for each memoryless agent.
        agents: the probabilities with which each takes actions, `[agents, n, actions]`.
        guess: what is best in each hidden state, `[n]`.
    """

    upper: Floats
    lower: Floats
    agents: Floats
    guess: Ints


def bounds_of(model: PartialModel, within: int | None) -> Bounds:
    """Return bounds.

    Args:
        model: the POMDP.
        within: the number of steps after which an episode is truncated; None for no limit.

    Raises:
        EpisodeTooLongError: there are too many states and steps.
        UndefinedReturnError: rewards cancel out in a loop without end.
    """
    informed = _Informed(model)
    if within is None:
        return _unlimited(model, informed)
    numbers = (within + 1) * model.size * (model.num_actions + len(_SHARES) + 1)
    if numbers > MAX_NUMBERS:
        raise EpisodeTooLongError(
            f"{model.size:,} states and {within:,} steps are too many; give a smaller limit"
        )
    return _limited(model, informed, within)


class _Informed:
    """A round of the fast informed bound.

    Args:
        model: the POMDP.
    """

    def __init__(self, model: PartialModel) -> None:
        row = np.repeat(np.arange(model.size * model.num_actions), np.diff(model.rows))
        observed = model.observation[model.target]
        order = np.lexsort((observed, row))
        self._reward, self._target = model.reward, model.target[order]
        self._weight = model.weight[order][:, None]
        row, observed = row[order], observed[order]
        self._first = np.flatnonzero(np.diff(row, prepend=-1) | np.diff(observed, prepend=-1))
        self._row = row[self._first]

    def step(self, values: Floats) -> Floats:
        """Return action values, `[n, actions]`, from those with a step less."""
        if not self._first.size:
            return self._reward
        sums = np.add.reduceat(self._weight * values[self._target], self._first, axis=0)
        ahead = np.bincount(self._row, sums.max(axis=1), self._reward.size)
        stepped: Floats = self._reward + ahead.reshape(self._reward.shape)
        return stepped


def _unlimited(model: PartialModel, informed: _Informed) -> Bounds:
    space, revealed = model.spaces[0], model.revealed
    optimum = undiscounted(revealed, space)
    values, policy = action_values(revealed, optimum.found.values, 1.0), optimum.ending.policy
    for _ in range(_ROUNDS if np.isfinite(values).all() else 0):
        better = np.minimum(values, informed.step(values))
        change, values = np.abs(values - better).max(initial=0.0), better
        if change <= _SMALL * np.abs(values).max():
            break
    agents = _agents(model, policy)
    worth = [_worth(model, weights) for weights in agents]
    return Bounds(values[None], np.stack(worth, axis=1)[None], agents, policy)


def _worth(model: PartialModel, weights: Floats) -> Floats:
    """Return what a memoryless agent is worth in each hidden state, `[n]`; -inf if unknown."""
    try:
        return chain_values(model.revealed.mixed(weights), 1.0, model.spaces[0])
    except (UndefinedReturnError, EpisodeTooLongError):
        return np.full(model.size, -np.inf)


def _agents(model: PartialModel, policy: Ints) -> Floats:
    """Return memoryless agents: all do what is best in most states that look like the present one.

    The first one does so always, others mostly, and the last one takes all actions evenly.
    """
    count = model.num_actions
    cells = model.observation * count + policy
    votes = np.bincount(cells, minlength=(int(model.observation[-1]) + 1) * count)
    table = votes.reshape(-1, count) / votes.reshape(-1, count).sum(axis=1, keepdims=True)
    mixed = [table[model.observation] * (1 - share) + share / count for share in _SHARES]
    return np.stack([*mixed, np.full(model.reward.shape, 1 / count)])


def _limited(model: PartialModel, informed: _Informed, within: int) -> Bounds:
    upper = np.zeros((within + 1, *model.reward.shape))
    for step in range(within):
        upper[step + 1] = informed.step(upper[step])
    guess = upper[-1].argmax(axis=1)
    agents = _agents(model, guess)
    lower = np.zeros((within + 1, model.size, len(agents)))
    earned = np.einsum("ksa,sa->sk", agents, model.reward)
    moves = _moves(model)
    for step in range(within):
        ahead = (moves @ lower[step]).reshape(*model.reward.shape, -1)
        lower[step + 1] = earned + np.einsum("ksa,sak->sk", agents, ahead)
    return Bounds(upper, lower, agents, guess)


def _moves(model: PartialModel) -> Any:
    """Return the weights of next states as a sparse matrix, `[n * actions, n]`."""
    from scipy.sparse import csr_array  # type: ignore[import-untyped]

    shape = model.size * model.num_actions, model.size
    return csr_array((model.weight, model.target, model.rows), shape=shape)
