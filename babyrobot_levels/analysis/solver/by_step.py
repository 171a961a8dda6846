"""Optimal values of every state by the steps that are left: what single moves are graded by."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from babyrobot_levels.analysis.solver.horizon import worth_within
from babyrobot_levels.analysis.solver.policies import StateSpace
from babyrobot_levels.analysis.solver.results import EpisodeTooLongError
from babyrobot_levels.analysis.solver.within import weights_by_step
from babyrobot_levels.mdp.tables import Floats

MAX_SIZE = 25_000_000
"""The most values: states times steps after which they still change."""

MAX_WORK = 500_000_000
"""The most outcomes that are looked at to find the largest regret; else it is bounded."""


class ValuesByStep:
    """The optimal values of a level's states for each number of steps that are left.

    Args:
        space: the states.
        limit: after how many steps episodes are truncated.
        discount: the factor by which each further reward counts less.

    Raises:
        EpisodeTooLongError: there are too many states and steps.
    """

    def __init__(self, space: StateSpace, limit: int, discount: float) -> None:
        self.space, self.limit, self.discount = space, limit, discount
        self._model = model = space.model()
        self._row = np.full(space.mdp.num_states, model.size)
        self._row[model.states] = np.arange(model.size)
        # The last entry of each is the end, which has no value.
        self._values = [np.zeros(model.size + 1)]
        while len(self._values) <= limit:
            before = self._values[-1]
            best = model.action_values(before[:-1], discount).max(axis=1)
            if np.array_equal(best, before[:-1]):
                # Further steps change nothing.
                break
            if model.size * len(self._values) > MAX_SIZE:
                raise EpisodeTooLongError(
                    f"the values of {model.size:,} states within {limit:,} steps are too many; "
                    "give a smaller limit of steps"
                )
            self._values.append(np.append(best, 0.0))

    def value(self, state: int, left: int) -> float:
        """Return the optimal expected return from a state; 0 in terminal ones."""
        return float(self._at(left)[self._row[state]])

    def action_values(self, state: int, left: int) -> Floats:
        """Return the optimal expected returns if an action is taken first, `[actions]`.

        Args:
            state: the state; in terminal ones, no action has a value.
            left: how many steps are left, at least 1.
        """
        row, model = self._row[state], self._model
        if row == model.size:
            return np.zeros(model.reward.shape[1])
        ahead = self._at(left - 1)[model.next_state[row]]
        found: Floats = model.reward[row] + self.discount * (model.probability[row] * ahead).sum(1)
        return found

    @cached_property
    def optimum(self) -> float:
        """The optimal expected return from the starts of the level."""
        return self.space.at_start(self._model, self._at(self.limit)[:-1])

    @cached_property
    def random(self) -> float:
        """The expected return of the random policy."""
        weights = weights_by_step("random", self.space, self.limit)(0)
        found = worth_within([self.space], [self.limit], [self.discount], [weights])
        return float(found.returns[0])

    @cached_property
    def largest_regret(self) -> float:
        """A bound of what an episode can lose by its actions, discounted: the largest regret."""
        model = self._model
        work, worst, most = model.probability.size * self.limit, np.zeros(model.size + 1), 0.0
        goes_on = model.probability > 0
        for left in range(1, self.limit + 1):
            best = self._at(left)[:-1, None]
            lost = best - model.action_values(self._at(left - 1)[:-1], self.discount)
            if work > MAX_WORK and left == len(self._values):
                # From here on, values do not change.
                return most + (self.limit - left + 1) * float(lost.max(initial=0.0))
            ahead = np.where(goes_on, worst[model.next_state], 0.0).max(axis=2)
            worst = np.append((lost + self.discount * ahead).max(axis=1), 0.0)
            most = float(worst.max())
        return float(worst[self._row[np.flatnonzero(self.space.mdp.start)]].max())

    def _at(self, left: int) -> Floats:
        return self._values[min(left, len(self._values) - 1)]
