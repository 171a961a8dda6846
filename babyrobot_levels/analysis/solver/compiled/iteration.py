"""Optimal values of large levels: sweeps in the order of distance, then Newton's method.

Sweeps over a window of distances that moves away from the end (`advance`) bring values near the
optimal ones: most of what a value owes to the end comes from states that are nearer. Where policies
lead to the end against what pushes them back, further sweeps do the rest. Where chance spreads over
long distances they would take as many rounds as the level is wide, or many more. There, each round
solves the linear system of the best policy (policy iteration is Newton's method for the Bellman
equation: M. L. Puterman and S. L. Brumelle, 1979), nearly, as far as the policy is worth it.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from babyrobot_levels.analysis.solver.compiled import values as kernel
from babyrobot_levels.analysis.solver.compiled.chains import Chain, followed, improved
from babyrobot_levels.analysis.solver.compiled.rows import Rows
from babyrobot_levels.mdp.tables import Floats, Ints
from babyrobot_levels.text import budget

ROUNDING = 2.0**-52
"""The rounding of a number, as a share of it."""

SETTLED = 1e-14
"""Values that are wrong by no more than this share of the largest one have settled."""

WIDTH = 8
"""The most distances in the window: so often, about, each state is updated."""

AT_A_TIME = 4
"""So many sweeps tell how fast values settle. The first one chooses what the others follow."""

FAST = 0.8
"""Where errors shrink by more than that in each sweep, sweeps are faster than linear systems."""

HOPELESS = 0.92
"""Where they shrink by less at first, sweeps are given up at once."""

NEARLY = 1e-2
"""To which share of what is left linear systems are solved at first: policies change meanwhile."""

WHOLLY = 1e-9
"""The share at the end: what is left then is solved anew."""

SURELY = 10.0
"""An error that is expected to be so many times smaller than it has to be is not looked at."""

CLIMBS = 30
"""Sweeps between two policies that are evaluated exactly. They only save time."""

MOST_ROUNDS = 60
"""A bound that only rounding, or a policy that never ends, can exceed."""


class Search:
    """Values that come nearer to the optimal ones, in the order of rows."""

    def __init__(self, rows: Rows):
        self.rows, self.size = rows, rows.factor.size
        self.chosen = np.zeros(self.size, np.int64)
        # The last one is the end.
        self.values = np.zeros(self.size + 1)
        self.rounds = 0
        self._moving = np.empty(self.size + 1, np.uint32)
        self._chain: Chain | None = None

    @cached_property
    def _shadow(self) -> Floats:
        return np.random.default_rng(0).random(self.size)

    @property
    def scale(self) -> float:
        """The largest size of a value."""
        return float(kernel.largest(self.values))

    def begin(self, borders: Ints) -> bool:
        """Begin with a first guess, improved distance by distance."""
        budget.spend((WIDTH + 1) * self.rows.weight.size)
        kernel.guess(self.rows, self.values, borders)
        kernel.advance(self.rows, self.values, borders, WIDTH, SETTLED * self.scale)
        return self.scale < np.inf

    def run(self) -> bool:
        """Find the values; return whether they have been found."""
        if self._settles():
            return True
        last, ratio = np.inf, 1.0
        for _ in range(MOST_ROUNDS):
            change, changed = self._sweep()
            if change <= ROUNDING:
                return True
            # Once the policy has been found, the rest is solved at one go.
            share = SETTLED / SURELY**2 / change / max(ratio, 1.0)
            tolerance = NEARLY if changed else min(NEARLY, max(share, WHOLLY))
            error = self._step(tolerance)
            if not np.isfinite(error):
                return False
            ratio = error / change
            if change <= SETTLED or not changed:
                if error <= SETTLED * max(1, 1 / SURELY / tolerance):
                    return True
                if error > last / 2:
                    return bool(error <= 1e3 * SETTLED)
            last = error
        return False

    def climb(self, chosen: Ints, slack: float) -> bool:
        """Raise the values from those of some rows; return whether they have been found.

        Args:
            chosen: the rows, one for each state.
            slack: what is better by no more than this share of the largest value does not count.
        """
        is_row = np.isfinite(self.rows.reward)
        if not is_row[np.arange(self.size), chosen].all():
            return False
        self.chosen, largest = chosen, float(np.abs(self.rows.reward[is_row]).max())
        for _ in range(MOST_ROUNDS):
            self._chain = None
            if not self._evaluate():
                return False
            if not self._climb(slack * max(self.scale, largest)):
                return True
        return False

    def _climb(self, slack: float) -> bool:
        """Raise values by sweeps; return whether anything is better by more than `slack`."""
        for number in range(CLIMBS):
            self._spend()
            if not kernel.climb(self.rows, self.values, self.chosen, slack, 1 - 2 * (number % 2)):
                return number > 0
        return True

    def _evaluate(self) -> bool:
        """Set values to those of what is chosen; return whether they have been found."""
        last = np.inf
        while True:
            error = self._step(WHOLLY)
            if error <= SETTLED or not error < last / 2:
                return bool(error <= 1e3 * SETTLED)
            last = error

    def _settles(self) -> bool:
        """Sweep as long as that is fast; return whether values have settled."""
        before, last, number = self.values.copy(), np.inf, 0
        while True:
            change = self._choose()
            rate = (change / last) ** (1 / AT_A_TIME) if number else 0.0
            if change <= 2 * ROUNDING:
                return True
            if number and change * rate <= SETTLED * (1 - rate):
                return True
            if number and not rate < (FAST if number > 1 else HOPELESS):
                # What over-relaxation has raised too far is no good beginning.
                self.values = before
                return False
            last, number = change, number + 1

    def _choose(self) -> float:
        """Sweep with the best rows, then some times with the same; return the largest change."""
        self._spend(AT_A_TIME)
        given = self.rows, self.values, self.chosen, self._moving
        return float(kernel.settle(*given, SETTLED / SURELY**2, AT_A_TIME - 1))

    def _sweep(self) -> tuple[float, int]:
        """Sweep, and choose rows; return the largest change, and how many are chosen anew."""
        self._spend(2)
        change, count = kernel.sweep(self.rows, self.values, self.chosen, 4 * ROUNDING)
        if count:
            self._chain = None
        return change, count

    def _spend(self, sweeps: int = 1) -> None:
        self.rounds += sweeps
        budget.spend(2 * self.rows.weight.size)

    def _step(self, tolerance: float) -> float:
        """Change values nearly to those of the rows that are chosen; return the largest change."""
        given = self.rows, self.chosen
        if self._chain is None:
            self._chain = followed(*given)
        return improved(*given, self._chain, self._shadow, self.values, tolerance)
