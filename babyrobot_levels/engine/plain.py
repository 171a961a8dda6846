"""The engine that needs nothing but NumPy: whole arrays, looked up into arrays that stay."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.engine.draws import Draws
from babyrobot_levels.engine.robots import Record, Results, Robots
from babyrobot_levels.engine.tables import NO_LIMIT, Floats, Ints, Tables, signs_of

_UNSIGNED = np.dtype(np.uintp)


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
        # An array is cheaper to calculate with than a number, which would become one each time.
        self._num_actions = np.array(tables.num_actions, np.intp)
        self._too_large = self._num_actions.astype(_UNSIGNED)
        self._has_chance = tables.chance >= 0
        self._has_limits = bool((tables.limit < NO_LIMIT).any())
        self._flags = np.empty(num_robots, np.bool_)

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
        np.less(actions.view(_UNSIGNED), self._too_large, self._flags)
        if np.count_nonzero(self._flags) < rows.size:
            return False
        robots.clock += 1
        np.multiply(state, self._num_actions, rows)
        np.add(rows, actions, rows)
        results.acted.fill(True)
        anew = robots.over.nonzero()[0]
        if anew.size:
            results.acted[anew] = False
            rows[anew] = tables.rest
        if tables.first.size:
            self._leave_to_chance(rows, draws)
        # With `mode="raise"`, NumPy would not write into `out` directly. Nothing is out of bounds.
        tables.next_state.take(rows, out=state, mode="clip")
        tables.reward.take(rows, out=results.rewards, mode="clip")
        tables.arrival.take(rows, out=results.words, mode="clip")
        if anew.size:
            self.begin(robots, anew, draws)
            results.words[anew] = tables.standing.take(state.take(anew))
        tables.over.take(state, out=results.terminated, mode="clip")
        if self._has_limits:
            np.less_equal(robots.deadline, np.array(robots.clock), results.truncated)
            np.logical_or(results.terminated, results.truncated, robots.over)
        else:
            results.truncated.fill(False)
            robots.over[:] = results.terminated
        self._observations.take(state, axis=0, out=results.observations, mode="clip")
        return True

    def walk(
        self, robots: Robots, policy: Floats, chances: Floats, draws: Draws, record: Record
    ) -> None:
        """Have robots follow a policy, begin anew where episodes end, and note all of it."""
        tables, state, level = self._tables, robots.state, robots.level
        signs = signs_of(tables.num_actions)
        results = Results(state.size, self._observations.shape[1], signs)
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
        """Replace rows that leave something to chance by the outcomes that are drawn."""
        tables = self._tables
        chancy = self._has_chance.take(rows, out=self._flags, mode="clip").nonzero()[0]
        if chancy.size:
            chance = tables.chance.take(rows.take(chancy))
            threshold = tables.threshold.take(chance, axis=0)
            # Repeating is cheaper than to compare arrays of different shapes.
            drawn = draws.take(chancy.size).repeat(threshold.shape[1]).reshape(threshold.shape)
            rows[chancy] = tables.first.take(chance) + (drawn >= threshold).argmin(axis=1)
