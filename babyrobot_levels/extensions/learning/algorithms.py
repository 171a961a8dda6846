"""Dynamic programming, in sweeps over all states, and learning from episodes.

After Sutton and Barto, Reinforcement Learning: An Introduction (2nd edition), chapter 4, and
sections 5.1 (Monte Carlo prediction), 6.4 (Sarsa), 6.5 (Q-learning), 7.2 (n-step Sarsa) and 8.2
(Dyna-Q). They return `Learning`: iterators over results, with the attributes of the latest one.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np

from babyrobot_levels.analysis.environments import make
from babyrobot_levels.analysis.solver.evaluation import action_values, chain_values
from babyrobot_levels.analysis.solver.model import Model, attractor, surely_ending
from babyrobot_levels.analysis.solver.optimum import TOLERANCE
from babyrobot_levels.analysis.solver.policies import Policy
from babyrobot_levels.analysis.solver.results import check_count, check_seed, check_share
from babyrobot_levels.extensions.learning.results import (
    Learning,
    Problem,
    Sweep,
    Trials,
    check_counts,
    largest_change,
    read_problem,
)
from babyrobot_levels.mdp.tables import Floats

MAX_SWEEPS = 10_000


def value_iteration(
    level: Any,
    discount: float | None = None,
    *,
    actions: str = "all",
    tolerance: float = 1e-10,
    max_sweeps: int = MAX_SWEEPS,
) -> Learning[Sweep]:
    """Yield the sweeps of value iteration, from values of 0 towards the optimal ones.

    A sweep gives each state the value of its greedy action, by the values of the sweep before
    (two arrays). Number 0 is before the first one. Without a discount, unbounded values grow or
    sink until `max_sweeps` ends it.

    Args:
        level: a name, a path, a mapping or a `Level`.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"all"`, `"moves"` without stay, or `"turns"`: turn left, turn right, forward.
            Actions that a wall refuses can be taken too.
        tolerance: the last sweep is the first one whose `delta` is not above this.
        max_sweeps: the number of sweeps after which it ends in any case, at least 1.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has an invalid value.
    """
    problem = read_problem(level, discount, actions, "sweep")
    return _sweeps(problem, problem.model, tolerance, max_sweeps)


def policy_evaluation(
    level: Any,
    policy: Policy,
    discount: float | None = None,
    *,
    actions: str = "all",
    tolerance: float = 1e-10,
    max_sweeps: int = MAX_SWEEPS,
) -> Learning[Sweep]:
    """Yield the sweeps of iterative policy evaluation, from values of 0 towards the policy's.

    A sweep gives each state the value of the policy's next step, by the values of the sweep
    before (two arrays). Number 0 is before the first one. Each sweep's `policy` is the greedy one
    for its values, not the one that is evaluated.

    Args:
        level: a name, a path, a mapping or a `Level`.
        policy: as `evaluate` takes it; `"uniform"` is what the book calls equiprobable.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"all"`, `"moves"` without stay, or `"turns"`: turn left, turn right, forward.
        tolerance: the last sweep is the first one whose `delta` is not above this.
        max_sweeps: the number of sweeps after which it ends in any case, at least 1.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has an invalid value.
    """
    problem = read_problem(level, discount, actions, "sweep")
    return _sweeps(problem, problem.model.mixed(problem.weights(policy)), tolerance, max_sweeps)


def policy_iteration(
    level: Any, discount: float | None = None, *, actions: str = "all", max_sweeps: int = 1000
) -> Learning[Sweep]:
    """Yield the rounds of policy iteration, from the random policy to an optimal one.

    A round evaluates a policy exactly (`values`) and improves it (`policy`); number 1 has the
    values of the random policy. An action is replaced only by a better one. The last round finds
    nothing to improve: its values are those of its policy.

    Without a discount, the random policy leaves out actions that may lead to inescapable states
    from where the episode can surely be ended. Where it is optimal to go on for ever, because the
    rewards are positive or zero, the rounds may stop below the optimum, or never; `solve` does not.

    Args:
        level: a name, a path, a mapping or a `Level`.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"all"`, `"moves"` without stay, or `"turns"`: turn left, turn right, forward.
        max_sweeps: the number of rounds after which it ends in any case, at least 1.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has an invalid value.
        UndefinedReturnError: while iterating: there is no discount, and an intermediate policy
            goes on for ever while rewards cancel out.
    """
    check_counts(max_sweeps=max_sweeps)
    return Learning(Sweep, _rounds(read_problem(level, discount, actions, "round"), max_sweeps))


def _sweeps(problem: Problem, model: Model, tolerance: float, max_sweeps: int) -> Learning[Sweep]:
    """Check the bounds and return the sweeps. The chain of a policy has a single action."""
    check_counts(max_sweeps=max_sweeps)
    if not tolerance >= 0:
        raise ValueError(f"tolerance must not be negative, not {tolerance!r}")

    def sweeps() -> Iterator[Sweep]:
        values = np.zeros(model.size)
        yield problem.sweep(0, values, np.inf)
        for number in range(1, max_sweeps + 1):
            before, values = values, model.action_values(values, problem.discount).max(axis=1)
            delta = largest_change(values, before)
            yield problem.sweep(number, values, delta)
            if delta <= tolerance:
                return

    return Learning(Sweep, sweeps())


def _rounds(problem: Problem, max_sweeps: int) -> Iterator[Sweep]:
    model, discount = problem.model, problem.discount
    # States keep the random mixture until an action is better: without a discount, a policy that
    # commits itself without an improvement might go round in circles.
    weights = problem.weights("random")
    if discount == 1:
        weights = _without_risks(model, weights)
    values = np.zeros(model.size)
    for number in range(1, max_sweeps + 1):
        before, values = values, chain_values(model.mixed(weights), discount, problem.space)
        ahead = action_values(model, values, discount)
        size = np.where(np.isfinite(values), np.abs(values), 0.0)
        better = ahead.max(axis=1) > values + TOLERANCE * np.maximum(1.0, size)
        weights[better] = np.eye(ahead.shape[1])[problem.greedy(ahead)[better]]
        yield problem.sweep(number, values, largest_change(values, before), weights.argmax(axis=1))
        if not better.any():
            return


def _without_risks(model: Model, weights: Floats) -> Floats:
    """Return a policy without the actions that risk an endless episode, `[n, actions]`.

    From -inf no action looks better than another if each has a chance to lead to -inf again.
    """
    sure, rows = surely_ending(model, model.allowed)
    _, action = attractor(model, model.end, rows)
    safe = np.where(sure[:, None], weights * rows, weights)
    none = safe.sum(axis=1) == 0
    safe[none] = np.eye(weights.shape[1])[action[none]]
    kept: Floats = safe / safe.sum(axis=1, keepdims=True)
    return kept


# -- Monte Carlo prediction ------------------------------------------------------------------


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
) -> Learning[Sweep]:
    """Yield the values of a policy as they are estimated from episodes, cell by cell.

    A cell's value is the mean of the returns that followed visits to it; 0 as long as no episode
    has visited it. Each `Sweep` is numbered by the episodes so far, and its `policy` is the greedy
    one for its values, not the one that is followed. Episodes are truncated after the level's
    `max_steps`, or 10,000 where it has none; rewards after that are missing from the means.

    Args:
        level: a name, a path, a mapping or a `Level`.
        policy: as `evaluate` takes it.
        episodes: the number of episodes, at least 1.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"all"`, `"moves"` without stay, or `"turns"`: turn left, turn right, forward.
        seed: the random seed. The same arguments give the same sweeps.
        first_visit: whether only an episode's first visit to a cell counts, or every one.
        every: the number of episodes from one `Sweep` to the next; the last may come sooner.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has an invalid value.
    """
    check_counts(episodes=episodes, every=every)
    problem = read_problem(level, discount, actions, "episode")
    sampler = _Sampler(problem, problem.weights(policy), np.random.default_rng(check_seed(seed)))
    return Learning(Sweep, _estimates(problem, sampler, episodes, first_visit, every))


def _estimates(
    problem: Problem, sampler: _Sampler, episodes: int, first_visit: bool, every: int
) -> Iterator[Sweep]:
    values = np.zeros(problem.model.size)
    visits = np.zeros(problem.model.size, np.int64)
    before = values.copy()
    for number in range(1, episodes + 1):
        states, rewards = sampler.episode()
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


class _Sampler:
    """Samples episodes from a level's exact tables."""

    def __init__(self, problem: Problem, weights: Floats, rng: np.random.Generator):
        """Prepare to follow a policy, `[n, actions]`."""
        model, space = problem.model, problem.space
        self._rng = rng
        self._max_steps = problem.max_steps
        self._end = model.size
        self._start = _cumulated(space.mdp.start[model.states])
        self._action = _cumulated(weights)
        self._outcome = _cumulated(model.probability)
        self._next_state = model.next_state
        self._reward = space.mdp.reward[model.states, space.first_action :]

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
    return sums / sums[..., -1:]


# -- temporal-difference control -------------------------------------------------------------


def q_learning(
    level: Any,
    episodes: int = 1000,
    *,
    step_size: float = 0.1,
    epsilon: float = 0.1,
    discount: float | None = None,
    actions: str = "moves",
    seed: int = 0,
    every: int = 10,
    initial: float = 0.0,
    exploring_starts: bool = False,
    planning_steps: int = 0,
) -> Learning[Trials]:
    """Yield the estimates of Q-learning: off-policy control, towards the optimal action values.

    The robot acts epsilon-greedily in the level's Gymnasium environment; ties are broken at
    random. Each `Trials` is numbered by the episodes
    so far. Episodes are truncated after the level's `max_steps`, or 10,000 where it has none; the
    last step of such an episode still bootstraps from the next state.

    With `planning_steps` it is Dyna-Q: after each step, it also learns from so many others, drawn
    evenly from what came last of each state and action that has been taken.

    Args:
        level: a name, a path, a mapping or a `Level`.
        episodes: the number of episodes, at least 1.
        step_size: how far an estimate moves towards the target of a step, above 0 and at most 1.
        epsilon: the probability of an action drawn evenly from all of them, 0 to 1.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"moves"`, `"all"` with stay, or `"turns"`: turn left, turn right, forward.
            Actions that a wall refuses can be taken too.
        seed: the random seed. The same arguments give the same trials.
        every: the number of episodes from one `Trials` to the next; the last may come sooner.
        initial: the action values at first.
        exploring_starts: whether episodes begin in a cell that is drawn evenly from those to
            which others lead; only for levels without things, and for robots that do not turn.
        planning_steps: the number of updates after each step from what is remembered, at least 0.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has an invalid value.
    """
    problem = read_problem(level, discount, actions, "episode")
    if exploring_starts and problem.model.states.max(initial=0) >= problem.space.mdp.cells:
        raise ValueError(
            "exploring_starts is for levels without things, and for robots that do not turn"
        )
    check_count("planning_steps", planning_steps, 0)
    agent = _Agent(problem, step_size, epsilon, seed, initial)
    episode = partial(agent.q_learning_episode, exploring_starts, planning_steps)
    return _trials(agent, episode, episodes, every)


def sarsa(
    level: Any,
    episodes: int = 1000,
    *,
    step_size: float = 0.1,
    epsilon: float = 0.1,
    discount: float | None = None,
    actions: str = "moves",
    seed: int = 0,
    every: int = 10,
    initial: float = 0.0,
    n_steps: int = 1,
) -> Learning[Trials]:
    """Yield the estimates of Sarsa: on-policy control, towards the values of what the robot does.

    As `q_learning`, but the target of a step has the value of the action that the robot takes
    next, not of the greedy one: it learns to keep clear of what a random step would cost.
    With `n_steps`, the target has the rewards of so many steps, and the value of the action after
    them: n-step Sarsa.

    Args:
        level: a name, a path, a mapping or a `Level`.
        episodes: the number of episodes, at least 1.
        step_size: how far an estimate moves towards the target of a step, above 0 and at most 1.
        epsilon: the probability of an action drawn evenly from all of them, 0 to 1.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"moves"`, `"all"` with stay, or `"turns"`: turn left, turn right, forward.
            Actions that a wall refuses can be taken too.
        seed: the random seed. The same arguments give the same trials.
        every: the number of episodes from one `Trials` to the next; the last may come sooner.
        initial: the action values at first.
        n_steps: how many rewards a target has, at least 1.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has an invalid value.
    """
    check_counts(n_steps=n_steps)
    problem = read_problem(level, discount, actions, "episode")
    agent = _Agent(problem, step_size, epsilon, seed, initial)
    return _trials(agent, partial(agent.sarsa_episode, n_steps), episodes, every)


def _trials(
    agent: _Agent, episode: Callable[[], float], episodes: int, every: int
) -> Learning[Trials]:
    check_counts(episodes=episodes, every=every)

    def trials() -> Iterator[Trials]:
        states, returns = agent.problem.model.states, []
        before = agent.values.copy()
        for number in range(1, episodes + 1):
            returns.append(episode())
            if number % every == 0 or number == episodes:
                delta = largest_change(agent.values, before)
                yield agent.problem.trials(number, agent.values[states], delta, returns)
                before = agent.values.copy()

    return Learning(Trials, trials())


class _Agent:
    """Acts in a level's environment and learns action values, `[states, actions]`.

    What follows the end of an episode is worth 0.
    """

    def __init__(
        self, problem: Problem, step_size: float, epsilon: float, seed: int, initial: float
    ):
        self.problem, self._epsilon = problem, check_share("epsilon", epsilon)
        self._step_size = check_share("step_size", step_size, is_above_0=True)
        space = problem.space
        if not math.isfinite(initial):
            raise ValueError(f"initial must be a finite number, not {initial!r}")
        self.values = np.full((space.mdp.num_states, space.num_actions), float(initial))
        self._reached = space.reached
        self._seen: dict[tuple[int, int], int] = {}
        self._memory: list[tuple[int, int, float, int | None]] = []
        self._rng = np.random.default_rng(check_seed(seed))
        self._env = make(space.level, observation="index", actions=space.actions).unwrapped
        self._env.reset(seed=int(self._rng.integers(2**31)))

    def q_learning_episode(self, exploring_starts: bool, planning_steps: int) -> float:
        """Run an episode of Q-learning and return its return."""
        state, _ = self._env.reset(options=self._drawn_start() if exploring_starts else None)
        total, factor = 0.0, 1.0
        for _ in range(self.problem.max_steps):
            action = self._choose(state)
            following, reward, over, _, _ = self._env.step(action)
            self._learn_greedily(state, action, float(reward), None if over else following)
            if planning_steps:
                self._plan(
                    planning_steps, state, action, float(reward), None if over else following
                )
            total, factor = total + factor * float(reward), factor * self.problem.discount
            if over:
                break
            state = following
        return total

    def sarsa_episode(self, n_steps: int) -> float:
        """Run an episode of Sarsa and return its return."""
        state, _ = self._env.reset()
        action = self._choose(state)
        total, factor = 0.0, 1.0
        waiting: deque[tuple[int, int, float]] = deque()
        for step in range(1, self.problem.max_steps + 1):
            following, reward, over, _, _ = self._env.step(action)
            next_action = self._choose(following)
            waiting.append((state, action, float(reward)))
            total, factor = total + factor * float(reward), factor * self.problem.discount
            is_last = over or step == self.problem.max_steps
            ahead = 0.0 if over else float(self.values[following, next_action])
            while len(waiting) >= (1 if is_last else n_steps):
                target = ahead
                for _, _, each in reversed(waiting):
                    target = each + self.problem.discount * target
                self._learn(*waiting.popleft()[:2], target)
            if is_last:
                break
            state, action = following, next_action
        return total

    def _drawn_start(self) -> dict[str, Any]:
        state = self._reached[self._rng.integers(self._reached.size)]
        return {"start": self.problem.space.mdp.cell(int(state))}

    def _plan(
        self, count: int, state: int, action: int, reward: float, following: int | None
    ) -> None:
        """Remember a step in the place of the last one like it, and learn from remembered ones."""
        place = self._seen.setdefault((state, action), len(self._seen))
        self._memory[place : place + 1] = [(state, action, reward, following)]
        for _ in range(count):
            self._learn_greedily(*self._memory[self._rng.integers(len(self._memory))])

    def _learn_greedily(
        self, state: int, action: int, reward: float, following: int | None
    ) -> None:
        """Learn from a step as if the best action followed; None is the end of the episode."""
        ahead = 0.0 if following is None else float(self.values[following].max())
        self._learn(state, action, reward + self.problem.discount * ahead)

    def _choose(self, state: int) -> int:
        """Return an action, epsilon-greedily."""
        row = self.values[state]
        if self._rng.random() < self._epsilon:
            return int(self._rng.integers(row.size))
        greedy = np.flatnonzero(row == row.max())
        return int(greedy[self._rng.integers(greedy.size)])

    def _learn(self, state: int, action: int, target: float) -> None:
        """Move an action's value towards a target."""
        self.values[state, action] += self._step_size * (target - self.values[state, action])
