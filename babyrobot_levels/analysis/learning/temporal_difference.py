"""Temporal-difference control: learning from each step in the environment, without its tables.

After Sutton and Barto, Reinforcement Learning: An Introduction (2nd edition), sections 6.4 and 6.5.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from babyrobot_levels.analysis.learning.results import (
    Problem,
    Trials,
    check_counts,
    largest_change,
    read_problem,
)
from babyrobot_levels.analysis.solver.results import check_seed, num_actions


def q_learning(
    level: Any,
    episodes: int,
    *,
    step_size: float = 0.1,
    epsilon: float = 0.1,
    discount: float | None = None,
    actions: str = "moves",
    seed: int = 0,
    every: int = 10,
) -> Iterator[Trials]:
    """Yield what Q-learning knows: off-policy control, which learns the values of the best actions.

    The robot acts epsilon-greedily in the level's Gymnasium environment; of equally good actions,
    its generator draws one. Action values begin at 0. Each `Trials` is numbered by the episodes
    so far. Episodes are cut off after the level's `max_steps`, or 10,000 where it has none; the
    values of their last cells then still count what may follow.

    Args:
        level: a name, a path, a mapping or a `Level`.
        episodes: how many are played, at least 1.
        step_size: how far an estimate moves towards what a step says, above 0 and at most 1.
        epsilon: the probability of an action that is drawn evenly from all of them, 0 to 1.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"moves"`, or `"all"` with stay. Actions that a wall refuses can be taken too.
        seed: what all chance is drawn from. The same arguments give the same trials.
        every: the number of episodes from one `Trials` to the next; the last may come sooner.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has a value that it cannot have.
    """
    problem = read_problem(level, discount, actions)
    robot = _Robot(problem, step_size, epsilon, seed)
    return _trials(robot, robot.q_learning_episode, episodes, every)


def sarsa(
    level: Any,
    episodes: int,
    *,
    step_size: float = 0.1,
    epsilon: float = 0.1,
    discount: float | None = None,
    actions: str = "moves",
    seed: int = 0,
    every: int = 10,
) -> Iterator[Trials]:
    """Yield what Sarsa knows: on-policy control, which learns the values of what the robot does.

    All is as in `q_learning`, but that an action is worth what the robot takes next, and not the
    best that it could: it learns to keep clear of what a random step would cost.

    Args:
        level: a name, a path, a mapping or a `Level`.
        episodes: how many are played, at least 1.
        step_size: how far an estimate moves towards what a step says, above 0 and at most 1.
        epsilon: the probability of an action that is drawn evenly from all of them, 0 to 1.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"moves"`, or `"all"` with stay. Actions that a wall refuses can be taken too.
        seed: what all chance is drawn from. The same arguments give the same trials.
        every: the number of episodes from one `Trials` to the next; the last may come sooner.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has a value that it cannot have.
    """
    problem = read_problem(level, discount, actions)
    robot = _Robot(problem, step_size, epsilon, seed)
    return _trials(robot, robot.sarsa_episode, episodes, every)


def _trials(
    robot: _Robot, episode: Callable[[], float], episodes: int, every: int
) -> Iterator[Trials]:
    check_counts(episodes=episodes, every=every)

    def trials() -> Iterator[Trials]:
        states, returns = robot.problem.model.states, []
        before = robot.values.copy()
        for number in range(1, episodes + 1):
            returns.append(episode())
            if number % every == 0 or number == episodes:
                delta = largest_change(robot.values, before)
                yield robot.problem.trials(number, robot.values[states], delta, returns)
                before = robot.values.copy()

    return trials()


class _Robot:
    """Acts in a level's environment and learns action values, `[states, actions]`.

    Where the episode is over, values stay 0.
    """

    def __init__(self, problem: Problem, step_size: float, epsilon: float, seed: int):
        if not 0 < step_size <= 1:
            raise ValueError(f"step_size must be above 0 and at most 1, not {step_size!r}")
        if not 0 <= epsilon <= 1:
            raise ValueError(f"epsilon must be from 0 to 1, not {epsilon!r}")
        self.problem, self._step_size, self._epsilon = problem, step_size, epsilon
        width, height = problem.level.size
        self.values = np.zeros((width * height, num_actions(problem.actions)))
        self._rng = np.random.default_rng(check_seed(seed))
        made = problem.level.make(observation="index", actions=problem.actions)
        self._env = made.unwrapped
        self._env.reset(seed=int(self._rng.integers(2**31)))

    def q_learning_episode(self) -> float:
        """Play an episode of Q-learning and return what it returned."""
        state, _ = self._env.reset()
        total, factor = 0.0, 1.0
        for _ in range(self.problem.max_steps):
            action = self._choose(state)
            following, reward, over, _, _ = self._env.step(action)
            self._learn(state, action, float(reward), self.values[following].max())
            total, factor = total + factor * float(reward), factor * self.problem.discount
            if over:
                break
            state = following
        return total

    def sarsa_episode(self) -> float:
        """Play an episode of Sarsa and return what it returned."""
        state, _ = self._env.reset()
        action = self._choose(state)
        total, factor = 0.0, 1.0
        for _ in range(self.problem.max_steps):
            following, reward, over, _, _ = self._env.step(action)
            next_action = self._choose(following)
            self._learn(state, action, float(reward), self.values[following, next_action])
            total, factor = total + factor * float(reward), factor * self.problem.discount
            if over:
                break
            state, action = following, next_action
        return total

    def _choose(self, state: int) -> int:
        """Return an action, epsilon-greedily."""
        row = self.values[state]
        if self._rng.random() < self._epsilon:
            return int(self._rng.integers(row.size))
        best = np.flatnonzero(row == row.max())
        return int(best[self._rng.integers(best.size)])

    def _learn(self, state: int, action: int, reward: float, ahead: float) -> None:
        """Move an action's value towards what a step says."""
        target = reward + self.problem.discount * ahead
        self.values[state, action] += self._step_size * (target - self.values[state, action])
