"""Levels as partially observable Markov decision processes (POMDPs).

The hidden state is a state of a level's tables, with the number of the level if there are several,
and the signal of the step that led there. So what is observed is a function of the hidden state,
and all states of a belief look the same.
"""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.analysis.solver.model import Model
from babyrobot_levels.analysis.solver.policies import StateSpace
from babyrobot_levels.analysis.solver.results import TooLargeError
from babyrobot_levels.extensions.sight.sights import Sight
from babyrobot_levels.mdp.tables import Floats, Ints, Mdp

MAX_OUTCOMES = 5_000_000
"""The most outcomes of all actions in all states."""


@dataclass(frozen=True, eq=False)
class PartialModel:
    """A POMDP of one level or several; `n` hidden states are sorted by what is observed there.

    The end of an episode is no state: outcomes that lead there are left out, so that the
    probabilities of an action may add up to less than 1. An agent notices the end.

    Attributes:
        spaces: the states of each level.
        sight: what is observed.
        level: the number of the level of each state, `[n]`.
        state: the state in the level's tables, `[n]`.
        observation: the number of what is observed in each state, `[n]`, rising.
        keys: the number of what is observed, by the key of what is shown and the signal.
        start: the probability of each state at reset, `[n]`.
        rows: where the outcomes of each state and action begin, `[n * actions + 1]`.
        target: int32: the next state of each outcome.
        probability: the probability of each outcome.
        reward: the expected reward, `[n, actions]`.
        discount: the discount of each state's level, `[n]`.
    """

    spaces: tuple[StateSpace, ...]
    sight: Sight
    level: Ints
    state: Ints
    observation: Ints
    keys: dict[Hashable, int]
    start: Floats
    rows: Ints
    target: NDArray[np.int32]
    probability: Floats
    reward: Floats
    discount: Floats

    @property
    def size(self) -> int:
        """The number of hidden states."""
        return self.observation.size

    @property
    def num_actions(self) -> int:
        """The number of actions."""
        return int(self.reward.shape[1])

    @cached_property
    def weight(self) -> Floats:
        """The probability of each outcome times the discount of what follows.

        With these, there is no discount: an episode ends with the probability that is missing.
        """
        source = np.repeat(np.arange(self.size), np.diff(self.rows[:: self.num_actions]))
        weights: Floats = self.probability * self.discount[source]
        return weights

    @cached_property
    def revealed(self) -> Model:
        """The model of an agent that sees the hidden state."""
        return as_model(self.rows, self.target, self.weight, self.reward, self.state)

    def initial(self) -> list[tuple[float, Ints, Floats]]:
        """Return the beliefs after the first observation: probability, states, probabilities."""
        states = np.flatnonzero(self.start)
        return self._split(states, self.start[states])

    def after(self, states: Ints, chances: Floats, action: int) -> list[tuple[float, Ints, Floats]]:
        """Return the beliefs after an action and each possible observation, as `initial`.

        Args:
            states: the states of a belief, rising.
            chances: their probabilities.
            action: the action.
        """
        _, target, weight = self.spread(states, chances, np.zeros(states.size, np.intp), [action])
        return self._split(target, weight)

    def _split(self, states: Ints, weights: Floats) -> list[tuple[float, Ints, Floats]]:
        bounds = np.flatnonzero(np.diff(self.observation[states], prepend=-1))
        parts = zip(np.split(states, bounds[1:]), np.split(weights, bounds[1:]), strict=True)
        return [(float(w.sum()), s, w / w.sum()) for s, w in parts if s.size]

    def spread(
        self, states: Ints, chances: Floats, owner: Ints, actions: Sequence[int]
    ) -> tuple[Ints, Ints, Floats]:
        """Return where the actions lead from the states of several beliefs.

        Args:
            states: the states of all beliefs.
            chances: their probabilities.
            owner: the number of the belief of each.
            actions: the actions.

        Returns:
            For each belief and action (`belief * len(actions) + index`) the next states, both
            rising, and the weight of each.
        """
        size = len(actions)
        rows = states[:, None] * self.num_actions + np.array(actions)
        counts = (self.rows[rows + 1] - self.rows[rows]).ravel()
        flat = ranges(self.rows[rows].ravel(), counts)
        weights = np.repeat(np.repeat(chances, size), counts) * self.weight[flat]
        number = np.repeat((owner[:, None] * size + np.arange(size)).ravel(), counts)
        keys, which = np.unique(number * self.size + self.target[flat], return_inverse=True)
        row, target = np.divmod(keys, self.size)
        sums: Floats = np.bincount(which, weights, keys.size).astype(np.float64)
        return row, target, sums


def ranges(begin: Ints, counts: Ints) -> Ints:
    """Return the numbers from each beginning on, so many of each, one after the other."""
    ends = np.cumsum(counts)
    numbers: Ints = np.repeat(begin - ends + counts, counts) + np.arange(
        ends[-1] if len(ends) else 0
    )
    return numbers


def as_model(rows: Ints, target: Ints, weight: Floats, reward: Floats, states: Ints) -> Model:
    """Return a model of sparse outcomes; what is missing of their weights leads to the end.

    Args:
        rows: where the outcomes of each state and action begin, `[n * actions + 1]`.
        target: the next state of each outcome.
        weight: the weight of each outcome.
        reward: the expected reward, `[n, actions]`; -inf for actions that may not be taken.
        states: what errors name of each state, `[n]`.
    """
    size, actions = reward.shape
    counts = np.diff(rows)
    width = int(counts.max(initial=0)) + 1
    place = np.repeat(np.arange(size * actions) * width - rows[:-1], counts) + np.arange(rows[-1])
    probability = np.zeros((size * actions, width))
    following = np.full((size * actions, width), size, np.int32)
    probability.ravel()[place], following.ravel()[place] = weight, target
    ends = 1.0 - probability.sum(axis=1)
    probability[:, -1] = np.where(ends > _ROUNDING, ends, 0.0)
    shape = size, actions, width
    return Model(
        states, probability.reshape(shape), following.reshape(shape), reward, np.zeros(reward.shape)
    )


_ROUNDING = 1e-12
"""Probabilities that add up to 1 but for this add up to 1."""


def build_model(
    spaces: Sequence[StateSpace], sight: Sight, weights: Sequence[float], discounts: Sequence[float]
) -> PartialModel:
    """Return the model of levels.

    Args:
        spaces: the states of each level, with the same actions.
        sight: what is observed.
        weights: how likely each level is.
        discounts: the discount of each level.

    Raises:
        TooLargeError: there are too many outcomes.
    """
    keys: dict[Hashable, int] = {}
    parts: list[_Part] = []
    size = outcomes = 0
    for number, (space, weight) in enumerate(zip(spaces, weights, strict=True)):
        part = _part(space, sight, keys)
        part.level[:], part.target[:] = number, part.target + size
        part.start[:], part.discount[:] = weight * part.start, discounts[number]
        size, outcomes = size + part.level.size, outcomes + part.target.size
        if outcomes > MAX_OUTCOMES:
            raise TooLargeError(
                f"the levels have more than {MAX_OUTCOMES:,} outcomes: too many to solve what can "
                "be known of them; take a part of the suite, or a smaller level"
            )
        parts.append(part)
    return _sorted(tuple(spaces), sight, keys, parts)


@dataclass(frozen=True, eq=False)
class _Part:
    """One level of a model, with the attributes of `PartialModel`.

    Of rows, it has the number of outcomes of each state and action, `[n, actions]`.
    """

    state: Ints
    observation: Ints
    start: Floats
    counts: Ints
    target: Ints
    probability: Floats
    reward: Floats
    level: Ints
    discount: Floats


def _part(space: StateSpace, sight: Sight, numbers: dict[Hashable, int]) -> _Part:
    """Return the part of a model that is one level, and number what is observed there."""
    mdp, first = space.mdp, space.first_action
    states = _reachable(mdp, first)
    probability = mdp.probability[states, first:]
    goes_on = (probability > 0) & ~mdp.terminal[states, first:]
    signal, names = sight.signals(space, states)
    # A hidden state is `index of the state * signals + signal`.
    index = np.zeros(mdp.num_states, np.intp)
    index[states] = np.arange(states.size)
    following = index[mdp.next_state[states, first:]] * len(names) + signal
    starts = np.flatnonzero(mdp.start)
    hidden = np.unique(np.concatenate([following[goes_on], index[starts] * len(names)]))
    own, heard = np.divmod(hidden, len(names))
    shown = sight.shown(space, states)
    pairs = zip(own.tolist(), heard.tolist(), strict=True)
    observed = [numbers.setdefault((shown[at], names[by]), len(numbers)) for at, by in pairs]
    start = np.zeros(hidden.size)
    start[np.searchsorted(hidden, index[starts] * len(names))] = mdp.start[starts]
    kept = goes_on[own]
    return _Part(
        state=states[own],
        observation=np.array(observed, np.intp),
        start=start,
        counts=kept.sum(axis=2),
        target=np.searchsorted(hidden, following[own][kept]),
        probability=probability[own][kept],
        reward=np.einsum("sao,sao->sa", probability, mdp.reward[states, first:])[own],
        level=np.zeros_like(hidden),
        discount=np.ones(hidden.size),
    )


def _reachable(mdp: Mdp, first: int) -> Ints:
    """Return the states that go on and that an episode can come to."""
    reached = mdp.start > 0
    front: Ints = np.flatnonzero(reached)
    while front.size:
        rows = front, slice(first, None)
        goes_on = (mdp.probability[rows] > 0) & ~mdp.terminal[rows]
        after = np.unique(mdp.next_state[rows][goes_on])
        front = after[~reached[after]]
        reached[front] = True
    return np.flatnonzero(reached)


def _sorted(
    spaces: tuple[StateSpace, ...], sight: Sight, keys: dict[Hashable, int], parts: list[_Part]
) -> PartialModel:
    """Return the model of all parts, sorted by what is observed."""

    def joined(name: str) -> NDArray[Any]:
        return np.concatenate([getattr(part, name) for part in parts])

    observation, counts, reward = joined("observation"), joined("counts"), joined("reward")
    order = np.argsort(observation, kind="stable")
    place = np.empty_like(order)
    place[order] = np.arange(order.size)
    actions = reward.shape[1]
    before = np.cumsum(counts.ravel()) - counts.ravel()
    rows = (order[:, None] * actions + np.arange(actions)).ravel()
    flat = ranges(before[rows], counts.ravel()[rows])
    return PartialModel(
        spaces=spaces,
        sight=sight,
        level=joined("level")[order],
        state=joined("state")[order],
        observation=observation[order],
        keys=keys,
        start=joined("start")[order],
        rows=np.append(0, np.cumsum(counts.ravel()[rows])),
        target=place[joined("target")[flat]].astype(np.int32),
        probability=joined("probability")[flat],
        reward=reward[order],
        discount=joined("discount")[order],
    )
