"""The engine that needs nothing but NumPy: whole arrays, looked up into arrays that stay."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.engine.draws import Draws
from babyrobot_levels.engine.robots import Record, Results, Robots
from babyrobot_levels.engine.tables import Floats, Ints, Tables


class PlainEngine:
    """Steps with NumPy."""

    name = "numpy"

    def __init__(self, tables: Tables, observations: NDArray[np.int64], num_robots: int) -> None:
        """Make the arrays that steps write on their way.

        Args:
            tables: what the robots walk in.
            observations: what each state shows, int64 `[states, numbers]`.
            num_robots: how many there are.
        """
        self._tables, self._observations = tables, observations
        self._rows = np.empty(num_robots, np.intp)
        self._chancy = np.empty(num_robots, np.bool_)

    def begin(self, robots: Robots, which: Ints, draws: Draws) -> None:
        """Begin new episodes for the robots of these numbers."""
        tables = self._tables
        drawn = draws.take(which.size * tables.draws_to_begin).reshape(which.size, -1)
        if tables.draws_levels:
            robots.level[which] = drawn[:, 0] * tables.limit.size
        level = robots.level.take(which)
        start = tables.first_start.take(level)
        if tables.draws_starts:
            count = tables.first_start.take(level + 1) - start
            start += (drawn[:, -1] * count).astype(np.intp)
        robots.state[which] = tables.starts.take(start)
        robots.deadline[which] = tables.limit.take(level) + robots.clock
        robots.over[which] = False

    def step(self, robots: Robots, actions: Ints, draws: Draws, results: Results) -> bool:
        """Have robots act, and those whose episodes are over begin anew in the place of it."""
        tables, rows, state = self._tables, self._rows, robots.state
        # Negative numbers are large ones without their sign.
        if actions.view(np.uintp).max() >= tables.num_actions:
            return False
        robots.clock += 1
        np.multiply(state, tables.num_actions, out=rows)
        np.add(rows, actions, out=rows)
        np.logical_not(robots.over, out=results.acted)
        anew = robots.over.nonzero()[0]
        if anew.size:
            rows[anew] = tables.rest
        if tables.most_outcomes > 1:
            self._leave_to_chance(rows, draws)
        # With `mode="raise"`, NumPy would not write into `out` directly. Nothing is out of bounds.
        tables.next_state.take(rows, out=state, mode="clip")
        tables.reward.take(rows, out=results.rewards, mode="clip")
        tables.arrival.take(rows, out=results.words, mode="clip")
        if anew.size:
            self.begin(robots, anew, draws)
            results.words[anew] = tables.standing.take(state.take(anew))
        tables.over.take(state, out=results.terminated, mode="clip")
        np.greater_equal(robots.clock, robots.deadline, out=results.truncated)
        np.logical_or(results.terminated, results.truncated, out=robots.over)
        self._observations.take(state, axis=0, out=results.observations, mode="clip")
        return True

    def walk(
        self, robots: Robots, policy: Floats, chances: Floats, draws: Draws, record: Record
    ) -> None:
        """Have robots follow a policy, begin anew where episodes end, and note all of it."""
        tables, state, level = self._tables, robots.state, robots.level
        results = Results.empty(state.size, self._observations.shape[1])
        thresholds = np.ascontiguousarray(policy.T)
        for row in range(len(chances)):
            base = tables.offset.take(level)
            record.observations[row] = state - base
            tables.standing.take(state, out=record.words[row], mode="clip")
            actions = np.zeros(state.size, np.intp)
            for threshold in thresholds:
                actions += chances[row] >= threshold.take(state)
            self.step(robots, actions, draws, results)
            record.actions[row] = actions
            record.rewards[row] = results.rewards
            record.terminations[row] = results.terminated
            record.truncations[row] = results.truncated
            record.next_observations[row] = state - base
            over = robots.over.nonzero()[0]
            if over.size:
                self.begin(robots, over, draws)

    def _leave_to_chance(self, rows: Ints, draws: Draws) -> None:
        """Replace rows that have several outcomes by the outcomes that are drawn."""
        tables = self._tables
        chancy = tables.chancy.take(rows, out=self._chancy, mode="clip").nonzero()[0]
        if not chancy.size:
            return
        drawn = draws.take(chancy.size)
        outcome = rows.take(chancy)
        for _ in range(tables.most_outcomes - 1):
            missed = drawn >= tables.threshold.take(outcome)
            outcome = np.where(missed, tables.otherwise.take(outcome), outcome)
        rows[chancy] = outcome
