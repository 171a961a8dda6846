"""The beliefs that an agent can come to, and the steps between them, as far as they are explored.

Two beliefs that differ by rounding alone are one: which they are, numbers rounded to a part in
10^12 tell. The largest difference is kept, since values are right up to a multiple of it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.extensions.sight.model import PartialModel
from babyrobot_levels.mdp.tables import Flags, Floats, Ints

_SCALE = 1e12 / 1.618033988749895
"""Probabilities are rounded to a part of this: halves, thirds, fifths are nowhere near a border."""


Outcomes = tuple[Ints, Ints, Floats]
"""Actions, the beliefs after them, and weights."""


@dataclass(frozen=True, eq=False)
class Steps:
    """The explored part of a graph of beliefs.

    Attributes:
        rows: where the outcomes of each belief and action begin, `[beliefs * actions + 1]`.
        target: int32: the belief after each outcome.
        weight: the weight of each outcome.
        reward: the expected reward, `[beliefs, actions]`; 0 where nothing is explored.
        is_leaf: which beliefs are not explored, `[beliefs]`.
    """

    rows: Ints
    target: NDArray[np.int32]
    weight: Floats
    reward: Floats
    is_leaf: Flags


class BeliefGraph:
    """Beliefs, numbered in the order in which they are found, and where actions lead.

    Args:
        model: the POMDP.

    Attributes:
        states: the hidden states of each belief.
        chances: their probabilities.
        roots: the beliefs after the first observation.
        outcomes: of each belief that is explored, the actions, rising, with the belief after each
            outcome and its weight; None of the others.
        root_chances: how likely the first observation leads to each of the roots.
        rounding: the largest difference between beliefs that are taken to be one.
        explored: how many beliefs are explored.
        numbers: how many probabilities there are in all beliefs.
        widest: the most beliefs after an action.
    """

    def __init__(self, model: PartialModel) -> None:
        self.model = model
        self.states: list[Ints] = []
        self.chances: list[Floats] = []
        self.outcomes: list[Outcomes | None] = []
        self.rounding = 0.0
        self.explored = self.numbers = self.widest = 0
        self._numbers: dict[bytes, int] = {}
        found = model.initial()
        self.roots = [self._number(states, chances) for _, states, chances in found]
        self.root_chances = np.array([chance for chance, _, _ in found])

    def __len__(self) -> int:
        return len(self.states)

    def _number(self, states: Ints, chances: Floats) -> int:
        """Return the number of a belief."""
        key = states.astype(np.int32).tobytes() + np.rint(chances * _SCALE).astype("<i8").tobytes()
        number = self._numbers.setdefault(key, len(self.states))
        if number == len(self.states):
            self.states.append(states)
            self.chances.append(chances)
            self.outcomes.append(None)
            self.numbers += states.size
        else:
            self.rounding = max(self.rounding, float(np.abs(chances - self.chances[number]).sum()))
        return number

    def explore(self, beliefs: Sequence[int]) -> None:
        """Find where all actions lead from some beliefs that are not explored."""
        model, count = self.model, self.model.num_actions
        row, target, weight = model.spread(*self.joined(beliefs), range(count))
        begins = np.diff(row, prepend=-1) | np.diff(model.observation[target], prepend=-1)
        first = np.flatnonzero(begins)
        last = np.append(first[1:], row.size)[: first.size]
        totals = np.add.reduceat(weight, first) if first.size else np.zeros(0)
        shares = weight / np.repeat(totals, last - first)
        bounds = zip(first.tolist(), last.tolist(), strict=True)
        after = np.array([self._number(target[a:b], shares[a:b]) for a, b in bounds], np.intp)
        actions = row[first] % count
        self.widest = max(self.widest, int(np.bincount(row[first]).max(initial=0)))
        places = np.searchsorted(row[first], np.arange(len(beliefs) + 1) * count).tolist()
        self.explored += len(beliefs)
        for belief, a, b in zip(beliefs, places, places[1:], strict=False):
            self.outcomes[belief] = actions[a:b], after[a:b], totals[a:b]

    def after(self, belief: int, action: int) -> tuple[Ints, Floats]:
        """Return the beliefs after an action in an explored belief, and the weight of each."""
        outcomes = self.outcomes[belief]
        assert outcomes is not None
        actions, after, weights = outcomes
        part = slice(*np.searchsorted(actions, [action, action + 1]).tolist())
        return after[part], weights[part]

    def joined(self, beliefs: Sequence[int]) -> tuple[Ints, Floats, Ints]:
        """Return states and probabilities of some beliefs, and the index of the belief of each."""
        states = [self.states[belief] for belief in beliefs]
        owner = np.repeat(np.arange(len(states)), [each.size for each in states])
        chances = [self.chances[belief] for belief in beliefs]
        return np.concatenate(states), np.concatenate(chances), owner

    def expected(self, beliefs: Sequence[int], table: Floats) -> Floats:
        """Return what is expected of a table over hidden states, `[beliefs, columns]`.

        Where it has infinities, -inf yields to inf.
        """
        if not len(beliefs):
            return np.zeros((0, table.shape[1]))
        states, chances, owner = self.joined(beliefs)
        first = np.flatnonzero(np.diff(owner, prepend=-1))
        with np.errstate(invalid="ignore"):
            sums: Floats = np.add.reduceat(chances[:, None] * table[states], first, axis=0)
        sums[np.isnan(sums)] = np.inf
        return sums

    def steps(self) -> Steps:
        """Return what is explored."""
        count, size = self.model.num_actions, len(self)
        none = np.zeros(0, np.intp), np.zeros(0, np.intp), np.zeros(0)
        parts = [outcomes or none for outcomes in self.outcomes]
        owner = np.repeat(np.arange(size), [part[0].size for part in parts])
        actions, target, weight = (np.concatenate(column) for column in zip(*parts, strict=True))
        counts = np.bincount(owner * count + actions, minlength=size * count)
        is_leaf = np.array([outcomes is None for outcomes in self.outcomes])
        reward = np.zeros((size, count))
        inner = np.flatnonzero(~is_leaf)
        reward[inner] = self.expected(inner.tolist(), self.model.reward)
        return Steps(
            rows=np.append(0, np.cumsum(counts)),
            target=target.astype(np.int32),
            weight=weight,
            reward=reward,
            is_leaf=is_leaf,
        )
