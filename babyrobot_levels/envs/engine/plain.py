"""The engine that needs nothing but NumPy: whole arrays, looked up into arrays that stay."""

from __future__ import annotations

import numpy as np
from numpy import add, greater_equal, multiply, ndarray
from numpy.typing import NDArray

from babyrobot_levels.envs.engine.draws import Draws
from babyrobot_levels.envs.engine.robots import Layout, Record, Results, Robots
from babyrobot_levels.envs.engine.slots import Span
from babyrobot_levels.envs.engine.tables import NO_LIMIT, Floats, Ints, Tables, signs_of

_UNSIGNED = np.dtype(np.uintp)

FEW = 256
"""Up to so many robots, one call that checks actions and finds rows is faster than three."""


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
        self._sizes = tables.over.size, tables.num_actions
        self._has_chance = tables.chance >= 0
        self._has_limits = bool((tables.limit < NO_LIMIT).any())
        self._flags = np.empty(num_robots, np.bool_)

    def reread(self, span: Span) -> None:
        """Take over what has been written into a slot of the tables and observations."""
        self._has_chance[span.rows] = self._tables.chance[span.rows] >= 0

    def begin(self, robots: Robots, which: Ints, draws: Draws) -> None:
        """Begin new episodes for the robots of these numbers."""
        begin(self._tables, robots, which, draws)

    def step(self, robots: Robots, actions: Ints, draws: Draws, results: Results) -> bool:
        """Have robots act, and those whose episodes are over begin anew in the place of it."""
        tables, rows, state = self._tables, self._rows, robots.state
        if rows.size <= FEW:
            try:
                rows = np.ravel_multi_index((state, actions), self._sizes)
            except ValueError:
                return False
        else:
            # Negative numbers are large ones without their sign.
            greater_equal(ndarray(rows.size, _UNSIGNED, actions), self._too_large, self._flags)
            if self._flags.nonzero()[0].size:
                return False
            multiply(state, self._num_actions, rows)
            add(rows, actions, rows)
        robots.clock += 1
        results.said.fill(True)
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
            begin(tables, robots, anew, draws)
            results.words[anew] = tables.standing.take(state.take(anew))
        terminated, truncated = results.terminated, results.truncated
        tables.over.take(state, out=terminated, mode="clip")
        if self._has_limits:
            np.less_equal(robots.deadline, np.array(robots.clock), truncated)
            np.logical_or(terminated, truncated, robots.over)
        else:
            truncated.fill(False)
            robots.over[:] = terminated
        self._observations.take(state, axis=0, out=results.observations, mode="clip")
        return True

    def walk(
        self, robots: Robots, policy: Floats, chances: Floats, draws: Draws, record: Record
    ) -> None:
        """Have robots follow a policy, begin anew where episodes end, and note all of it."""
        tables, state, level = self._tables, robots.state, robots.level
        signs = signs_of(tables.num_actions)
        results = Results(Layout(state.size, self._observations.shape[1], signs))
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
                begin(tables, robots, over, draws)

    def _leave_to_chance(self, rows: Ints, draws: Draws) -> None:
        """Replace rows that leave something to chance by the outcomes that are drawn."""
        tables = self._tables
        chancy = self._has_chance.take(rows, out=self._flags, mode="clip").nonzero()[0]
        if chancy.size:
            chance = tables.chance.take(rows.take(chancy))
            threshold = tables.threshold.take(chance, axis=0)
            # Repeating is cheaper than to compare arrays of different shapes.
            drawn = draws.uniform(chancy).repeat(threshold.shape[1]).reshape(threshold.shape)
            rows[chancy] = tables.first.take(chance) + (drawn >= threshold).argmin(axis=1)


def begin(tables: Tables, robots: Robots, which: Ints, draws: Draws) -> None:
    """Begin new episodes for the robots of these numbers."""
    robots.state[which] = tables.starts.take(draws.starts(which, robots.level, tables))
    robots.deadline[which] = tables.limit.take(robots.level.take(which)) + robots.clock
    robots.over[which] = False
