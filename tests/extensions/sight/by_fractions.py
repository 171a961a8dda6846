"""What can be reached with a sight, computed in the plainest way: beliefs as exact fractions.

Transitions come from the independent reading of levels in `oracles.things_reference`. Nothing is
merged but equal beliefs, and nothing is bounded but by steps.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Hashable, Sequence
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from oracles.things_reference import Reference, TurningReference

Place = tuple[int, int]
"""The number of a level, and a state of it."""

Belief = frozenset[tuple[Place, Fraction]]
Seen = Callable[[Place], Hashable]


@cache
def exact(number: float) -> Fraction:
    """Return the fraction with a small denominator that a float stands for."""
    near = Fraction(number).limit_denominator(1_000_000)
    assert abs(near - Fraction(number)) < Fraction(1, 10**12)
    return near


class Beliefs:
    """The beliefs of an agent with a sight, in one of several levels.

    Args:
        levels: the transitions of each level.
        actions: the actions, as levels number them.
        seen: what is seen in a place.
        discount: the discount.
        hears: whether rewards are told.
        shares: how likely each level is.
    """

    def __init__(
        self,
        levels: Sequence[Reference | TurningReference],
        actions: range,
        seen: Seen,
        discount: Fraction,
        hears: bool = False,
        shares: Sequence[Fraction] = (Fraction(1),),
    ) -> None:
        self.levels, self.actions, self.discount = levels, actions, discount
        self.seen, self.hears = cache(seen), hears
        weights: dict[tuple[Place, Any], Fraction] = {}
        for number, (level, share) in enumerate(zip(levels, shares, strict=True)):
            for state, chance in level.start.items():
                weights[(number, state), None] = share * exact(chance)
        self.start = self.split(weights)

    def split(self, weights: dict[tuple[Place, Any], Fraction]) -> list[tuple[Fraction, Belief]]:
        """Return a belief for each observation, with its probability."""
        parts: dict[Hashable, dict[Place, Fraction]] = defaultdict(lambda: defaultdict(Fraction))
        for (place, told), weight in weights.items():
            if weight:
                parts[self.seen(place), told][place] += weight
        found = []
        for part in parts.values():
            total = sum(part.values(), Fraction(0))
            found.append((total, frozenset((s, w / total) for s, w in part.items())))
        return found

    @cache  # noqa: B019  (a solver lives as long as its test)
    def step(self, belief: Belief, action: int) -> tuple[Fraction, list[tuple[Fraction, Belief]]]:
        """Return the expected reward of an action, and the beliefs after it."""
        paid = Fraction(0)
        weights: dict[tuple[Place, Any], Fraction] = defaultdict(Fraction)
        for (level, state), weight in belief:
            outcomes = self.levels[level].outcomes(state, action)
            chances = [exact(outcome[0]) for outcome in outcomes]
            assert sum(chances) == 1
            for chance, (_, after, reward, over) in zip(chances, outcomes, strict=True):
                paid += weight * chance * exact(reward)
                if not over:
                    told = reward if self.hears else None
                    weights[(level, after), told] += weight * chance
        return paid, self.split(weights)

    def within(self, steps: int) -> Fraction:
        """Return the best expected return of so many steps."""
        return sum((p * self.value(b, steps) for p, b in self.start), Fraction(0))

    @cache  # noqa: B019
    def value(self, belief: Belief, steps: int) -> Fraction:
        """Return the best expected return of so many steps from a belief."""
        if not steps:
            return Fraction(0)
        values = []
        for action in self.actions:
            paid, following = self.step(belief, action)
            ahead = sum((p * self.value(after, steps - 1) for p, after in following), Fraction(0))
            values.append(paid + self.discount * ahead)
        return max(values)

    def reachable(self, most: int) -> list[Belief] | None:
        """Return all beliefs that can be reached, None if there are more than so many."""
        known = dict.fromkeys(belief for _, belief in self.start)
        waiting = [*known]
        while waiting:
            belief = waiting.pop()
            for action in self.actions:
                for _, after in self.step(belief, action)[1]:
                    if after not in known:
                        known[after] = None
                        waiting.append(after)
            if len(known) > most:
                return None
        return [*known]

    def without_limit(self, beliefs: list[Belief]) -> float | None:
        """Return the best expected return without a limit, by value iteration on all beliefs.

        Without a discount, no rewards may have opposite signs. None if the sum does not converge:
        it is -inf, or inf.
        """
        number = {belief: index for index, belief in enumerate(beliefs)}
        size, count = len(beliefs), len(self.actions)
        rewards, moves = np.zeros((size, count)), np.zeros((size, count, size))
        for belief, index in number.items():
            for column, action in enumerate(self.actions):
                paid, after = self.step(belief, action)
                rewards[index, column] = paid
                for chance, each in after:
                    moves[index, column, number[each]] += float(self.discount * chance)
        assert self.discount < 1 or rewards.max() <= 0 or rewards.min() >= 0
        values, starts = np.zeros(size), [number[belief] for _, belief in self.start]
        chances = np.array([float(chance) for chance, _ in self.start])
        for _ in range(5_000):
            past, values = values, (rewards + moves @ values).max(axis=1)
            change = np.abs(values - past) / (1 + np.abs(values))
            # Other beliefs may well be worth -inf.
            if change[starts].max() < 1e-14 and (change < 1e-14)[np.abs(values) < 1000].all():
                return float(chances @ values[starts])
        return None

    def rewards(self) -> list[float]:
        """Return all rewards that there are while an episode goes on."""
        return [
            reward
            for level in self.levels
            for state in range(level.num_states)
            if not level.is_terminal(state)
            for action in self.actions
            for _, _, reward, _ in level.outcomes(state, action)
        ]
