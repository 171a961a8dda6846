"""Optimal values of large levels: sweeps in the order of distance, then Newton's method.

Sweeps over a window of distances that moves away from the end (`march`) bring values near the
optimal ones: most of what a value owes to the end comes from states that are nearer. Where policies
lead to the end against what pushes them back, further sweeps do the rest. Where chance spreads over
long distances they would take as many rounds as the level is wide, or many more. There, each round
solves the linear system of the best policy (policy iteration is Newton's method for the Bellman
equation: M. L. Puterman and S. L. Brumelle, 1979), nearly, as far as the policy is worth it.
"""

from __future__ import annotations

import numpy as np

from babyrobot_levels.analysis.solver.compiled import values as kernel
from babyrobot_levels.analysis.solver.compiled.chains import residual
from babyrobot_levels.analysis.solver.compiled.rows import AT_ONCE, Rows, backward_parts, parts
from babyrobot_levels.analysis.solver.compiled.systems import Solver, followed, forward
from babyrobot_levels.mdp.tables import Ints
from babyrobot_levels.text import budget

ROUNDING = 2.0**-52
"""The rounding of a number, as a share of it."""

SETTLED = 1e-14
"""Values that are wrong by no more than this share of the largest one have settled."""

WIDTH = 8
"""The most distances in the window: so often, about, each state is updated."""

AT_A_TIME = 4
"""So many sweeps tell how fast values settle. The first one chooses what the others follow."""

FAST = 0.74
"""Where errors shrink by more than that in each sweep, sweeps are faster than linear systems."""

NEARLY = 1e-3
"""To which share of what is left linear systems are solved: policies change meanwhile."""

SURELY = 100.0
"""An error that is expected to be so many times smaller than it has to be is not looked at."""

CLIMBS = 30
"""Sweeps between two policies that are evaluated exactly. They only save time."""

MOST_ROUNDS = 60
"""A bound that only rounding, or a policy that never ends, can exceed."""


class Search:
    """Values that come nearer to the optimal ones, in the order of rows."""

    def __init__(self, rows: Rows):
        self.rows, self.size = rows, rows.factor.size
        self.chosen = rows.first[:-1].copy()
        self.values = np.zeros(self.size)
        self.rounds = 0
        self._solver: Solver | None = None

    @property
    def scale(self) -> float:
        """The largest size of a value."""
        return float(np.abs(self.values).max(initial=0.0))

    def begin(self, borders: Ints) -> bool:
        """Begin with a first guess, improved distance by distance."""
        rows, values = self.rows, self.values
        budget.spend((WIDTH + 1) * rows.target.size)
        kernel.guess(rows, values, borders)
        window, settled = np.zeros(2, np.int64), SETTLED * self.scale
        while window[0] < borders.size - 1:
            kernel.advance(rows, values, borders, window, AT_ONCE, WIDTH, settled)
        return bool(np.isfinite(values).all())

    def run(self) -> bool:
        """Find the values; return whether they have been found."""
        if self._settles():
            return True
        last = np.inf
        for _ in range(MOST_ROUNDS):
            changes = [self._sweep(step) for step in (1, -1, 1)]
            if changes[-1] <= ROUNDING * self.scale:
                return True
            changed = self._improve()
            # Once the policy has been found, the rest is solved at one go.
            goal = SETTLED * self.scale
            tolerance = NEARLY if changed else min(NEARLY, max(goal / last, NEARLY**3))
            error = self._step(tolerance)
            if not np.isfinite(error):
                return False
            if error * tolerance <= goal / SURELY:
                return True
            if error <= goal or (not changed and error > last / 2):
                return bool(error <= 1e3 * SETTLED * self.scale)
            last = error
        return False

    def climb(self, chosen: Ints, slack: float) -> bool:
        """Raise the values from those of some rows; return whether they have been found.

        Args:
            chosen: the rows, one for each state; -1 is none.
            slack: what is better by no more than this share of the largest value does not count.
        """
        if (chosen < 0).any():
            return False
        self.chosen = chosen
        for _ in range(MOST_ROUNDS):
            self._solver = None
            if not self._evaluate():
                return False
            if not self._climb(slack * max(self.scale, float(np.abs(self.rows.reward).max()))):
                return True
        return False

    def _climb(self, slack: float) -> bool:
        """Raise values by sweeps; return whether anything is better by more than `slack`."""
        for number in range(CLIMBS):
            self.rounds += 1
            budget.spend(2 * self.rows.target.size)
            changed = sum(
                kernel.climb(
                    self.rows, self.values, self.chosen, slack, *part, 1 - 2 * (number % 2)
                )
                for part in parts(self.size)
            )
            if not changed:
                return number > 0
        return True

    def _evaluate(self) -> bool:
        """Set values to those of what is chosen; return whether they have been found."""
        last = np.inf
        while True:
            error = self._step(NEARLY**3)
            if error <= SETTLED * self.scale or not error < last / 2:
                return bool(error <= 1e3 * SETTLED * self.scale)
            last = error

    def _settles(self) -> bool:
        """Sweep as long as that is fast; return whether values have settled, or undo it."""
        before, last, number = self.values.copy(), np.inf, 0
        while True:
            change, scale = self._choose(), self.scale
            rate = (change / last) ** (1 / AT_A_TIME) if number else 0.0
            if change <= 2 * ROUNDING * scale:
                return True
            if number and change * rate <= SETTLED * scale * (1 - rate):
                return True
            if number > 1 and not rate < FAST:
                self.values = before
                return False
            last, number = change, number + 1

    def _choose(self) -> float:
        """Sweep with the best rows, then some times with the same; return the largest change."""
        self.rounds += AT_A_TIME
        budget.spend(2 * self.rows.target.size)
        moving, counts = np.empty(self.size + 1, np.uint32), np.zeros(1, np.int64)
        given = self.rows, self.values, self.chosen, moving
        calm = SETTLED / SURELY * self.scale
        change = max(float(kernel.choose(*given, counts, calm, *part)) for part in parts(self.size))
        for _ in range(AT_A_TIME - 1):
            for part in parts(int(counts[0])):
                kernel.follow(*given, *part)
        return change

    def _sweep(self, step: int) -> float:
        self.rounds += 1
        budget.spend(2 * self.rows.target.size)
        ranges = parts(self.size) if step > 0 else backward_parts(self.size)
        return max(float(kernel.sweep(self.rows, self.values, *part, step)) for part in ranges)

    def _improve(self) -> int:
        """Choose the best rows; return for how many states they are better than those before."""
        slack = 4 * ROUNDING * self.scale
        changed = sum(
            kernel.improve(self.rows, self.values, self.chosen, slack, *part)
            for part in parts(self.size)
        )
        if changed:
            self._solver = None
        return int(changed)

    def _step(self, tolerance: float) -> float:
        """Change values nearly to those of the rows that are chosen; return the largest change."""
        if self._solver is None:
            self._solver = Solver(followed(self.rows, self.chosen))
        left = np.empty(self.size)
        forward(residual, self._solver.chain, self.rows.reward[self.chosen], self.values, left)
        step, share = self._solver.solve(left, tolerance)
        if not share < 0.5 and left.any():
            return np.inf
        self.values += step
        return float(np.abs(step).max(initial=0.0))
