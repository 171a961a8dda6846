"""Linear systems of Markov chains as machine code. Imports Numba.

A chain is a sparse matrix of probabilities with a killing probability for each state: a row says
`(killing + sum of p) x_i - sum of p_j x_j = b_i`. No entry cancels another one, so that residuals
are exact to rounding of the differences between neighbours, however large the values are.

Systems are solved by BiCGSTAB (H. A. van der Vorst, 1992), preconditioned by an incomplete
elimination in the order of distance from the end, which is exact where states form a tree, as in
mazes.
"""

from __future__ import annotations

from typing import Any, NamedTuple

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
from babyrobot_levels.analysis.solver.compiled.values import share_of
from babyrobot_levels.text import budget

MOST_ITERATIONS = 300
"""After so many iterations, what has been found is what is returned."""

AT_A_TIME = 500_000
"""One call does iterations for about so many states: between calls, signals are heard."""

WIDTH = 4
"""How many entries most states have on a side at most. Loops are compiled for so many."""

COMPENSATED = 0.8
"""The share of what elimination would fill in that is taken from the diagonal instead."""


class Chain(NamedTuple):
    """A Markov chain over `n` states: the weights of steps over what is left of the diagonal.

    Attributes:
        nearer: the earlier states to which a step may lead, `[n, slots]`; any where there is none.
        near: how likely it does, discounted, times `pivot`, `[n, slots]`; 0 where there is none.
        farther: the later states.
        far: the same for these.
        pivot: the inverse of what remains of the diagonal in the incomplete elimination, `[n]`.
        shift: the diagonal times this inverse, minus 1, `[n]`.
        slots: as `Rows` have it.
    """

    nearer: Nodes
    near: Floats
    farther: Nodes
    far: Floats
    pivot: Floats
    shift: Floats
    slots: Any


@jit
def most_entries(rows: Rows, chosen: Ints) -> int:
    """Return how many entries a state has before it, or behind it, at most."""
    most = 0
    for state in range(chosen.size):
        row, near, far = chosen[state], 0, 0
        for slot in range(len(rows.slots)):
            is_far = rows.target[state, row * len(rows.own), slot] > state
            is_entry = rows.weight[state, row, slot] > 0.0
            near += is_entry and not is_far
            far += is_entry and is_far
        most = max(most, near, far)
    return most


def followed(rows: Rows, chosen: Ints) -> Chain:
    """Return the chain of the rows that are chosen, one for each state, and eliminate in it."""
    most = most_entries(rows, chosen)
    slots = (0,) * WIDTH if most <= WIDTH else np.zeros(most, np.uint8)
    return eliminated(rows, chosen, slots)


@jit
def eliminated(rows: Rows, chosen: Ints, slots: Any) -> Chain:
    """Do what `followed` does, for a number of entries on a side."""
    size = chosen.size
    shape = size, len(slots)
    nearer, near = np.zeros(shape, np.uint32), np.zeros(shape)
    farther, far = np.zeros(shape, np.uint32), np.zeros(shape)
    pivot, shift = np.empty(size), np.empty(size)
    # From the last state on, filling nothing in.
    for step in range(size):
        state = size - 1 - step
        row = chosen[state]
        diagonal, left, before, behind = rows.killing[state, row], 0.0, 0, 0
        for slot in range(len(rows.slots)):
            other = rows.target[state, row * len(rows.own), slot]
            weight = rows.weight[state, row, slot]
            diagonal += weight
            if weight <= 0.0:
                continue
            if other < state:
                nearer[state, before], near[state, before] = other, weight
                before += 1
                continue
            farther[state, behind], far[state, behind] = other, weight
            behind += 1
            for back in range(len(slots)):
                is_filled = nearer[other, back] != state
                left -= weight * near[other, back] * (COMPENSATED if is_filled else 1.0)
        left = left + diagonal if left + diagonal > 0.0 else 1.0
        pivot[state], shift[state] = 1.0 / left, diagonal / left - 1.0
        for slot in range(len(slots)):
            near[state, slot] *= pivot[state]
            far[state, slot] *= pivot[state]
    return Chain(nearer, near, farther, far, pivot, shift, slots)


@inner
def residual(rows: Rows, chosen: Ints, right: Floats, x: Floats, left: Floats) -> None:
    """Set `left` to `right - A x` for the system of the rows that are chosen; `x` is `[n + 1]`."""
    for index in range(chosen.size):
        state, row = np.uint32(index), np.uint32(chosen[index])
        owner, own = row * np.uint32(len(rows.own)), x[state]
        total = right[state] - rows.killing[state, row] * own
        for slot in range(len(rows.slots)):
            total += rows.weight[state, row, slot] * (x[rows.target[state, owner, slot]] - own)
        left[state] = total


@inner
def upper(chain: Chain, right: Floats, x: Floats) -> None:
    """Solve `(pivots - entries before the diagonal) x = pivots right`, from the first state on."""
    for index in range(right.size):
        state = np.uint32(index)
        total = right[state]
        for slot in range(len(chain.slots)):
            total += chain.near[state, slot] * x[chain.nearer[state, slot]]
        x[state] = total


@inner
def image_of(chain: Chain, right: Floats, solved: Floats, x: Floats) -> None:
    """Set `x` to what elimination on both sides makes of the system times `right`.

    `solved` is `upper` of `right`, and the lower system is solved for `A solved`. The product comes
    for nothing (S. C. Eisenstat, 1981): all entries before the diagonal are those of the upper one.
    """
    upper(chain, right, solved)
    for step in range(right.size):
        state = np.uint32(right.size - 1 - step)
        total = right[state] + chain.shift[state] * solved[state]
        for slot in range(len(chain.slots)):
            other = chain.farther[state, slot]
            total += chain.far[state, slot] * (x[other] - solved[other])
        x[state] = total


@summing
def dot(one: Floats, other: Floats) -> float:
    """Return the sum of products."""
    total = 0.0
    for index in range(one.size):
        total += one[index] * other[index]
    return total


@jit
def bicgstab(
    chain: Chain,
    left: Floats,
    shadow: Floats,
    vectors: Floats,
    numbers: Floats,
    goal: float,
    times: int,
) -> bool:
    """Go on with iterations; return whether what is left has fallen to a goal, or will not.

    Args:
        chain: the chain.
        left: what is left, `[n]`, of the system that elimination on both sides leaves; changed.
        shadow: a vector without structure: of another, a residual of few entries may be orthogonal
            to the next one.
        vectors: what is found, and four more, which are 0 at first, `[5, n + 1]`; changed.
        numbers: three numbers, which are 1 at first; changed.
        goal: the square of the norm.
        times: the number of iterations.
    """
    size = left.size
    x, direction, image = vectors[0, :size], vectors[1, :size], vectors[2, :size]
    second, solved = vectors[3, :size], vectors[4, :size]
    rho, alpha, omega = numbers[0], numbers[1], numbers[2]
    for _ in range(times):
        before, rho = rho, dot(shadow, left)
        factor = rho / before * alpha / omega
        for index in range(size):
            direction[index] = left[index] + factor * (direction[index] - omega * image[index])
        image_of(chain, direction, solved, image)
        alpha = dot(shadow, image)
        alpha = rho / (alpha if alpha != 0.0 else 1.0)
        for index in range(size):
            left[index] -= alpha * image[index]
        image_of(chain, left, solved, second)
        own = dot(second, second)
        omega = dot(second, left) / (own if own != 0.0 else 1.0)
        for index in range(size):
            x[index] += alpha * direction[index] + omega * left[index]
            left[index] -= omega * second[index]
        if not dot(left, left) > goal or omega == 0.0:
            return True
    numbers[0], numbers[1], numbers[2] = rho, alpha, omega
    return False


@jit
def begun(rows: Rows, chosen: Ints, chain: Chain, values: Floats) -> tuple[Floats, Floats]:
    """Return what values, `[n + 1]`, leave of a system, `[n]`, and this from both sides' view.

    The latter solves `(pivots - entries behind the diagonal) x = right`, from the last state on.
    """
    right, left = np.empty(chosen.size), np.zeros(chosen.size)
    for index in range(chosen.size):
        right[index] = rows.reward[index, chosen[index]]
    residual(rows, chosen, right, values, right)
    for step in range(chosen.size):
        state = np.uint32(chosen.size - 1 - step)
        total = right[state] * chain.pivot[state]
        for slot in range(len(chain.slots)):
            total += chain.far[state, slot] * left[chain.farther[state, slot]]
        left[state] = total
    return right, left


@jit
def ended(
    rows: Rows, chosen: Ints, chain: Chain, right: Floats, vectors: Floats, values: Floats
) -> float:
    """Add what iterations have found to values; return the largest change, as `improved` does."""
    size = chosen.size
    found, left = vectors[1], vectors[2, :size]
    upper(chain, vectors[0, :size], found)
    residual(rows, chosen, right, found, left)
    norm, most = dot(right, right), 0.0
    if norm > 0.0 and not dot(left, left) < norm / 4.0:
        return np.inf
    for state in range(size):
        values[state] += found[state]
        most = max(most, abs(found[state]))
    return share_of(most, values)


def improved(
    rows: Rows, chosen: Ints, chain: Chain, shadow: Floats, values: Floats, tolerance: float
) -> float:
    """Bring values nearer to those of the rows that are chosen; return the largest change.

    It is a share of the largest value; inf where this solves nothing, and nothing changes.

    Args:
        rows: the process.
        chosen: the rows, one for each state.
        chain: their chain.
        shadow: as for `bicgstab`.
        values: the values, `[n + 1]`, that of the end 0; changed.
        tolerance: which share of what they leave may remain, about.
    """
    size = chosen.size
    right, left = begun(rows, chosen, chain, values)
    vectors, numbers = np.zeros((5, size + 1)), np.ones(3)
    goal, times = tolerance**2 * dot(left, left), max(6, AT_A_TIME // size)
    for _ in range(0, MOST_ITERATIONS if goal else 0, times):
        budget.spend(40 * times * size)
        if bicgstab(chain, left, shadow, vectors, numbers, goal, times):
            break
    return float(ended(rows, chosen, chain, right, vectors, values))
