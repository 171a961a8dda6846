"""Optimal values of every state by the steps that are left: what single moves are graded by.

`render/static/regret.js` computes the same numbers for pages.
"""

from functools import cached_property

import numpy as np

from babyrobot_levels.analysis.solver.evaluation import random_return
from babyrobot_levels.analysis.solver.optimum import optimum_of
from babyrobot_levels.analysis.solver.policies import StateSpace
from babyrobot_levels.analysis.solver.results import EpisodeTooLongError
from babyrobot_levels.mdp.tables import Floats
from babyrobot_levels.text import budget

MAX_SIZE = 25_000_000
"""The most values: states times steps after which they still change."""

_EQUAL = 1e-9
"""Actions are equally good if their values differ by no more than this share."""

MAX_WORK = 500_000_000
"""The most outcomes that are looked at to find the largest regret; else it is bounded."""


class ValuesByStep:
    """The optimal values of a level's states for each number of steps that are left.

    Args:
        space: the states.
        limit: after how many steps episodes are truncated; None for values that do not depend on
            the steps that are left, which are -inf where no return is finite.
        discount: the factor by which each further reward counts less.

    Raises:
        EpisodeTooLongError: there are too many states and steps.
        OverBudgetError: that takes more work than is left.
        UndefinedReturnError: without a limit, there is no solution.
    """

    def __init__(self, space: StateSpace, limit: int | None, discount: float) -> None:
        self.space, self.limit, self.discount = space, limit, discount
        self._model = model = space.model()
        self._row = np.full(space.mdp.num_states, model.size)
        self._row[model.states] = np.arange(model.size)
        # The last entry of each is the end, which has no value.
        self._values = [np.zeros(model.size + 1)]
        if limit is None:
            self._values[0][:-1] = optimum_of(model, space, discount).found.values
        while limit is not None and len(self._values) <= limit:
            before = self._values[-1]
            budget.spend(2 * model.probability.size)
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

    def graded(
        self, state: int, action: int, reward: float, after: int | None, left: int
    ) -> tuple[float, float]:
        """Return what an action loses against the best one, and what chance adds in its step.

        Args:
            state: the state before.
            action: the action.
            reward: the reward.
            after: the state after; None if the step ends the episode.
            left: how many steps are left before it, at least 1; any number without a limit.
        """
        found = self.action_values(state, left)
        best, own = float(found.max()), float(found[action])
        lost = best - own
        # Where all is lost, nothing more can be.
        if best == -np.inf or lost <= _EQUAL * np.abs(found[np.isfinite(found)]).max():
            lost = 0.0
        ahead = 0.0 if after is None else self.value(after, left - 1)
        return lost, reward + self.discount * ahead - own

    @cached_property
    def optimum(self) -> float:
        """The optimal expected return from the starts of the level."""
        return self.space.at_start(self._model, self._at(self.limit or 0)[:-1])

    @cached_property
    def random(self) -> float:
        """The expected return of the random policy."""
        return random_return(self.space, self.limit, self.discount, model=self._model)

    @cached_property
    def largest_regret(self) -> float:
        """A bound of what an episode can lose by its actions, discounted: the largest regret."""
        assert self.limit is not None
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
        return self._values[min(max(left, 0), len(self._values) - 1)]
