"""Linear systems of Markov chains as machine code. Imports Numba.

A chain is a sparse matrix of probabilities with a killing probability for each state: a row says
`(killing + sum of p) x_i - sum of p_j x_j = b_i`. No entry cancels another one, so that residuals
are exact to rounding of the differences between neighbours, however large the values are.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from babyrobot_levels.analysis.solver.compiled.rows import Floats, Ints, Nodes, Rows, jit


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
def follow(rows: Rows, chosen: Ints, chain: Chain, first: int, last: int) -> None:
    """Fill the entries of some states, after those before them, with the rows that are chosen."""
    for state in range(first, last):
        at, row = chain.begin[state], chosen[state]
        chain.killing[state] = rows.killing[row]
        for is_later in (False, True):
            for outcome in range(rows.begin[row], rows.begin[row + 1]):
                if (rows.target[outcome] > state) == is_later:
                    chain.target[at] = rows.target[outcome]
                    chain.weight[at] = rows.weight[outcome]
                    at += 1
            if not is_later:
                chain.middle[state] = at
        chain.begin[state + 1] = at


@jit
def residual(chain: Chain, right: Floats, x: Floats, left: Floats, first: int, last: int) -> None:
    """Set `left = right - A x`."""
    for state in range(first, last):
        own = x[state]
        total = right[state] - chain.killing[state] * own
        for at in range(chain.begin[state], chain.begin[state + 1]):
            total += chain.weight[at] * (x[chain.target[at]] - own)
        left[state] = total


@jit
def eliminate(chain: Chain, first: int, last: int) -> None:
    """Find the pivots of states from the last one on, of an elimination that fills nothing in."""
    for step in range(last - first):
        state = last - 1 - step
        pivot = diagonal = chain.killing[state]
        for at in range(chain.begin[state], chain.begin[state + 1]):
            pivot += chain.weight[at]
            diagonal += chain.weight[at]
        for at in range(chain.middle[state], chain.begin[state + 1]):
            other = chain.target[at]
            for back in range(chain.begin[other], chain.middle[other]):
                if chain.target[back] == state:
                    pivot -= chain.weight[at] * chain.weight[back] * chain.pivot[other]
                    break
        pivot = pivot if pivot > 0.0 else 1.0
        chain.pivot[state] = 1.0 / pivot
        chain.shift[state] = diagonal / pivot - 2.0


@jit
def lower(chain: Chain, right: Floats, x: Floats, first: int, last: int) -> None:
    """Solve `(pivots - entries behind the diagonal) x = right`, from the last state on."""
    for step in range(last - first):
        state = np.uint32(last - 1 - step)
        total = right[state]
        for at in range(chain.middle[state], chain.begin[state + 1]):
            total += chain.weight[at] * x[chain.target[at]]
        x[state] = total * chain.pivot[state]


@jit
def upper(chain: Chain, right: Floats, x: Floats, first: int, last: int) -> None:
    """Solve `(pivots - entries before the diagonal) x = pivots right`, from the first state on."""
    for index in range(first, last):
        state = np.uint32(index)
        total = 0.0
        for at in range(chain.begin[state], chain.middle[state]):
            total += chain.weight[at] * x[chain.target[at]]
        x[state] = right[state] + total * chain.pivot[state]


@jit
def between(chain: Chain, right: Floats, solved: Floats, x: Floats, first: int, last: int) -> None:
    """Solve the lower system for what `A solved` is, where `solved` is `upper` of `right`.

    The product comes for nothing (S. C. Eisenstat, 1981): all entries before the diagonal are those
    of the upper system. What is found lacks `solved`, which is to be added.
    """
    for step in range(last - first):
        state = np.uint32(last - 1 - step)
        total = 0.0
        for at in range(chain.middle[state], chain.begin[state + 1]):
            total += chain.weight[at] * x[chain.target[at]]
        right_here = right[state] + chain.shift[state] * solved[state]
        x[state] = right_here + total * chain.pivot[state]


# -- vectors ----------------------------------------------------------------------------------


@jit
def dot(one: Floats, other: Floats) -> float:
    """Return the sum of products."""
    total = 0.0
    for index in range(one.size):
        total += one[index] * other[index]
    return total


@jit
def add(x: Floats, factor: float, y: Floats) -> None:
    """Add a multiple of one vector to another."""
    for index in range(x.size):
        x[index] += factor * y[index]


@jit
def turn(direction: Floats, image: Floats, left: Floats, factor: float, omega: float) -> None:
    """Set `direction = left + factor (direction - omega image)`."""
    for index in range(left.size):
        direction[index] = left[index] + factor * (direction[index] - omega * image[index])
