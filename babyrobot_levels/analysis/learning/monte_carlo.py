"""Monte Carlo prediction: a policy's values as the mean of what episodes returned.

After Sutton and Barto, Reinforcement Learning: An Introduction (2nd edition), section 5.1.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from babyrobot_levels.analysis.learning.results import (
    Problem,
    Sweep,
    check_counts,
    largest_change,
    read_problem,
)
from babyrobot_levels.analysis.solver.model import Floats
from babyrobot_levels.analysis.solver.policies import Policy
from babyrobot_levels.analysis.solver.results import check_seed


def monte_carlo(
    level: Any,
    policy: Policy = "random",
    episodes: int = 1000,
    *,
    discount: float | None = None,
    actions: str = "all",
    seed: int = 0,
    first_visit: bool = True,
    every: int = 100,
) -> Iterator[Sweep]:
    """Yield the values of a policy as they are estimated from episodes, cell by cell.

    A cell's value is the mean of the returns that followed visits to it; 0 as long as no episode
    came there. Each `Sweep` is numbered by the episodes so far, and its `policy` is the greedy
    one for its values, not the one that is followed. Episodes are cut off after the level's
    `max_steps`, or 10,000 where it has none; what they would have returned later is missing from
    the means.

    Args:
        level: a name, a path, a mapping or a `Level`.
        policy: as `evaluate` takes it.
        episodes: how many are played, at least 1.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"all"`, or `"moves"` without stay.
        seed: what all chance is drawn from. The same arguments give the same sweeps.
        first_visit: whether only an episode's first visit to a cell counts, or every one.
        every: the number of episodes from one `Sweep` to the next; the last may come sooner.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has a value that it cannot have.
    """
    check_counts(episodes=episodes, every=every)
    problem = read_problem(level, discount, actions)
    player = _Player(problem, problem.weights(policy), np.random.default_rng(check_seed(seed)))
    return _estimates(problem, player, episodes, first_visit, every)


def _estimates(
    problem: Problem, player: _Player, episodes: int, first_visit: bool, every: int
) -> Iterator[Sweep]:
    values = np.zeros(problem.model.size)
    visits = np.zeros(problem.model.size, np.int64)
    before = values.copy()
    for number in range(1, episodes + 1):
        states, rewards = player.episode()
        first = {state: time for time, state in reversed(list(enumerate(states)))}
        total = 0.0
        for time in reversed(range(len(states))):
            state = states[time]
            total = rewards[time] + problem.discount * total
            if not first_visit or first[state] == time:
                visits[state] += 1
                values[state] += (total - values[state]) / visits[state]
        if number % every == 0 or number == episodes:
            yield problem.sweep(number, values, largest_change(values, before))
            before = values.copy()


class _Player:
    """Plays episodes on a level's exact tables."""

    def __init__(self, problem: Problem, weights: Floats, rng: np.random.Generator):
        """Make ready to follow a policy, `[n, actions]`."""
        model, mdp = problem.model, problem.level.compile()
        self._rng = rng
        self._max_steps = problem.max_steps
        self._end = model.size
        self._start = _cumulated(mdp.start[model.states])
        self._action = _cumulated(weights)
        self._outcome = _cumulated(model.probability)
        self._next_state = model.next_state
        self._reward = mdp.reward[model.states, -weights.shape[1] :]

    def episode(self) -> tuple[list[int], list[float]]:
        """Return the states of an episode, without its end, and the reward that followed each."""
        states: list[int] = []
        rewards: list[float] = []
        state = self._draw(self._start)
        while state != self._end and len(states) < self._max_steps:
            action = self._draw(self._action[state])
            outcome = self._draw(self._outcome[state, action])
            states.append(state)
            rewards.append(float(self._reward[state, action, outcome]))
            state = int(self._next_state[state, action, outcome])
        return states, rewards

    def _draw(self, cumulated: Floats) -> int:
        return int(cumulated.searchsorted(self._rng.random(), side="right"))


def _cumulated(chances: Floats) -> Floats:
    """Return the chances added up along the last axis, to exactly 1 in spite of rounding."""
    sums = np.cumsum(chances, axis=-1)
    total: Floats = sums / sums[..., -1:]
    return total
