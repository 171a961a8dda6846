"""Linear systems of Markov chains as machine code. Imports Numba.

A chain is a sparse matrix of probabilities with a killing probability for each state: a row says
`(killing + sum of p) x_i - sum of p_j x_j = b_i`. No entry cancels another one, so that residuals
are exact to rounding of the differences between neighbours, however large the values are.

Systems are solved by BiCGSTAB (H. A. van der Vorst, 1992), preconditioned by an incomplete
elimination in the order of distance from the end, which is exact where states form a tree, as in
mazes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from babyrobot_levels.analysis.solver.compiled.rows import (
    Floats,
    Ints,
    Nodes,
    Rows,
    inner,
    jit,
    summing,
)
from babyrobot_levels.text import budget

MOST_ITERATIONS = 300
"""After so many iterations, what has been found is what is returned."""

AT_A_TIME = 6
"""So many of them are done by one call: between calls, signals are heard."""


class Chain(NamedTuple):
    """A Markov chain over `n` states.

    Attributes:
        begin: where the entries of each state begin, `[n + 1]`, those that lead to earlier states
            first.
        middle: where those that lead to later ones begin, `[n]`.
        target: the other states to which a step may lead.
        weight: how likely it does, discounted.
        killing: how likely a step ends the episode, or the discount does, `[n]`.
        pivot: the inverse of what remains of the diagonal in the incomplete elimination, `[n]`.
        shift: the diagonal times this inverse, minus 2, `[n]`.
    """

    begin: Ints
    middle: Ints
    target: Nodes
    weight: Floats
    killing: Floats
    pivot: Floats
    shift: Floats


@jit
def followed(rows: Rows, chosen: Ints) -> Chain:
    """Return the chain of the rows that are chosen, one for each state, and eliminate in it."""
    size, outcomes = chosen.size, rows.target.shape[2]
    begin, middle = np.zeros(size + 1, np.int64), np.empty(size, np.int64)
    target, weight = np.empty(size * outcomes, np.uint32), np.empty(size * outcomes)
    killing, pivot, shift = np.empty(size), np.empty(size), np.empty(size)
    at = 0
    for state in range(size):
        row = chosen[state]
        killing[state] = rows.killing[state, row]
        for is_later in (False, True):
            for outcome in range(outcomes):
                other, chance = rows.target[state, row, outcome], rows.weight[state, row, outcome]
                if chance > 0.0 and (other > state) == is_later:
                    target[at], weight[at] = other, chance
                    at += 1
            if not is_later:
                middle[state] = at
        begin[state + 1] = at
    # From the last state on, filling nothing in.
    for step in range(size):
        state = size - 1 - step
        diagonal = killing[state]
        for at in range(begin[state], begin[state + 1]):
            diagonal += weight[at]
        left = diagonal
        for at in range(middle[state], begin[state + 1]):
            other = target[at]
            for back in range(begin[other], middle[other]):
                if target[back] == state:
                    left -= weight[at] * weight[back] * pivot[other]
                    break
        left = left if left > 0.0 else 1.0
        pivot[state], shift[state] = 1.0 / left, diagonal / left - 2.0
    return Chain(begin, middle, target, weight, killing, pivot, shift)


@jit
def residual(chain: Chain, right: Floats, x: Floats) -> Floats:
    """Return `right - A x`."""
    left = np.empty(right.size)
    for state in range(right.size):
        own = x[state]
        total = right[state] - chain.killing[state] * own
        for at in range(chain.begin[state], chain.begin[state + 1]):
            total += chain.weight[at] * (x[chain.target[at]] - own)
        left[state] = total
    return left


@jit
def lower(chain: Chain, right: Floats) -> Floats:
    """Solve `(pivots - entries behind the diagonal) x = right`, from the last state on."""
    x = np.empty(right.size)
    for step in range(right.size):
        state = np.uint32(right.size - 1 - step)
        total = right[state]
        for at in range(chain.middle[state], chain.begin[state + 1]):
            total += chain.weight[at] * x[chain.target[at]]
        x[state] = total * chain.pivot[state]
    return x


@inner
def upper(chain: Chain, right: Floats, x: Floats) -> None:
    """Solve `(pivots - entries before the diagonal) x = pivots right`, from the first state on."""
    for index in range(right.size):
        state, total = np.uint32(index), 0.0
        for at in range(chain.begin[state], chain.middle[state]):
            total += chain.weight[at] * x[chain.target[at]]
        x[state] = right[state] + total * chain.pivot[state]


@inner
def image_of(chain: Chain, right: Floats, solved: Floats, x: Floats) -> None:
    """Set `x` to what elimination on both sides makes of the system times `right`.

    `solved` is `upper` of `right`, and the lower system is solved for `A solved`. The product comes
    for nothing (S. C. Eisenstat, 1981): all entries before the diagonal are those of the upper one.
    """
    upper(chain, right, solved)
    for step in range(right.size):
        state, total = np.uint32(right.size - 1 - step), 0.0
        for at in range(chain.middle[state], chain.begin[state + 1]):
            other = chain.target[at]
            total += chain.weight[at] * (x[other] - solved[other])
        x[state] = (
            right[state] + (chain.shift[state] + 1.0) * solved[state] + total * chain.pivot[state]
        )


@summing
def dot(one: Floats, other: Floats) -> float:
    """Return the sum of products."""
    total = 0.0
    for index in range(one.size):
        total += one[index] * other[index]
    return total


@jit
def bicgstab(
    chain: Chain, left: Floats, shadow: Floats, vectors: Floats, numbers: Floats, goal: float
) -> bool:
    """Go on with iterations; return whether what is left has fallen to a goal, or will not.

    Args:
        chain: the chain.
        left: what is left, `[n]`, of the system that elimination on both sides leaves; changed.
        shadow: a vector without structure: of another, a residual of few entries may be orthogonal
            to the next one.
        vectors: what is found, and four more, which are 0 at first, `[5, n]`; changed.
        numbers: three numbers, which are 1 at first; changed.
        goal: the square of the norm.
    """
    x, direction, image = vectors[0], vectors[1], vectors[2]
    second, solved = vectors[3], vectors[4]
    rho, alpha, omega = numbers[0], numbers[1], numbers[2]
    for _ in range(AT_A_TIME):
        before, rho = rho, dot(shadow, left)
        factor = rho / before * alpha / omega
        for index in range(left.size):
            direction[index] = left[index] + factor * (direction[index] - omega * image[index])
        image_of(chain, direction, solved, image)
        alpha = dot(shadow, image)
        alpha = rho / (alpha if alpha != 0.0 else 1.0)
        for index in range(left.size):
            left[index] -= alpha * image[index]
        image_of(chain, left, solved, second)
        own = dot(second, second)
        omega = dot(second, left) / (own if own != 0.0 else 1.0)
        for index in range(left.size):
            x[index] += alpha * direction[index] + omega * left[index]
            left[index] -= omega * second[index]
        if not dot(left, left) > goal or omega == 0.0:
            return True
    numbers[0], numbers[1], numbers[2] = rho, alpha, omega
    return False


def solved(chain: Chain, right: Floats, shadow: Floats, tolerance: float) -> tuple[Floats, float]:
    """Return a solution of a chain's system, and the norm of what it leaves, as a share.

    Args:
        chain: the chain.
        right: the right side, `[n]`.
        shadow: as for `bicgstab`.
        tolerance: which share of its norm may be left, about.
    """
    size, norm = right.size, dot(right, right) ** 0.5
    if not norm:
        return np.zeros(size), 0.0
    left, vectors, numbers = lower(chain, right), np.zeros((5, size)), np.ones(3)
    goal = tolerance**2 * dot(left, left)
    for _ in range(0, MOST_ITERATIONS, AT_A_TIME):
        budget.spend(40 * AT_A_TIME * size)
        if bicgstab(chain, left, shadow, vectors, numbers, goal):
            break
    found = vectors[1]
    upper(chain, vectors[0], found)
    rest = residual(chain, right, found)
    return found, dot(rest, rest) ** 0.5 / norm
