"""Linear systems of large Markov chains: a Krylov method.

BiCGSTAB (H. A. van der Vorst, 1992), preconditioned by an incomplete elimination in the order of
distance from the end, which is exact where states form a tree, as in mazes.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.compiled import chains as kernel
from babyrobot_levels.analysis.solver.compiled.chains import Chain
from babyrobot_levels.analysis.solver.compiled.rows import Rows, backward_parts, parts
from babyrobot_levels.mdp.tables import Floats, Ints
from babyrobot_levels.text import budget

MOST_ITERATIONS = 300
"""After so many iterations, what has been found is what is returned."""


def forward(function: Any, chain: Chain, *arguments: Any) -> None:
    """Call a compiled loop for all states, part by part."""
    for part in parts(chain.killing.size):
        function(chain, *arguments, *part)


def backward(function: Any, chain: Chain, *arguments: Any) -> None:
    """Call a compiled loop for all states, part by part, the last one first."""
    for part in backward_parts(chain.killing.size):
        function(chain, *arguments, *part)


def followed(rows: Rows, chosen: Ints) -> Chain:
    """Return the chain of the rows that are chosen, one for each state."""
    size, length = chosen.size, rows.begin[chosen + 1] - rows.begin[chosen]
    room = int(length.sum())
    begin, middle = np.zeros(size + 1, np.int64), np.empty(size, np.int64)
    target, weight = np.empty(room, np.uint32), np.empty(room)
    chain = Chain(begin, middle, target, weight, *np.empty((3, size)))
    for part in parts(size):
        kernel.follow(rows, chosen, chain, *part)
    return chain


class Solver:
    """Solves systems of a chain."""

    def __init__(self, chain: Chain):
        self.chain, self.size = chain, chain.killing.size
        self._solved = np.empty(self.size)
        backward(kernel.eliminate, chain)

    def solve(self, right: Floats, tolerance: float) -> tuple[Floats, float]:
        """Return a solution, and the norm of what it leaves, as a share of that of `right`.

        Args:
            right: the right side, `[n]`.
            tolerance: which share may be left.
        """
        x, left = np.zeros(self.size), np.empty(self.size)
        norm = float(kernel.dot(right, right)) ** 0.5
        if not norm:
            return x, 0.0
        backward(kernel.lower, self.chain, right, left)
        forward(kernel.upper, self.chain, self._bicgstab(left, tolerance), x)
        forward(kernel.residual, self.chain, right, x, left)
        return x, float(kernel.dot(left, left)) ** 0.5 / norm

    def _between(self, right: Floats, image: Floats) -> None:
        forward(kernel.upper, self.chain, right, self._solved)
        backward(kernel.between, self.chain, right, self._solved, image)
        kernel.add(image, 1.0, self._solved)

    def _bicgstab(self, left: Floats, tolerance: float) -> Floats:
        """Return what elimination on both sides makes into `left`, nearly.

        `left` becomes what is left.
        """
        x, direction, image, second = np.zeros((4, self.size))
        # From a vector without structure: a residual of few entries may be orthogonal to the next.
        shadow = np.random.default_rng(0).random(self.size)
        goal = tolerance**2 * kernel.dot(left, left)
        rho = alpha = omega = 1.0
        for _ in range(MOST_ITERATIONS):
            budget.spend(40 * self.size)
            before, rho = rho, kernel.dot(shadow, left)
            kernel.turn(direction, image, left, rho / before * alpha / omega, omega)
            self._between(direction, image)
            alpha = rho / (kernel.dot(shadow, image) or 1.0)
            kernel.add(left, -alpha, image)
            kernel.add(x, alpha, direction)
            self._between(left, second)
            omega = kernel.dot(second, left) / (kernel.dot(second, second) or 1.0)
            kernel.add(x, omega, left)
            kernel.add(left, -omega, second)
            if not kernel.dot(left, left) > goal or not omega:
                break
        return x
