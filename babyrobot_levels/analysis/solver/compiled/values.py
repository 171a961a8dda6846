"""Values by sweeps in place over rows, as machine code (Gauss-Seidel). Imports Numba."""

from __future__ import annotations

from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.compiled.rows import Floats, Ints, Nodes, Rows, inner, jit

PESSIMISM = 2.0
"""Guesses fall so many times as fast as they should: what is too low rises at once."""

LEAST_ADVANCE = 0.1
"""The least advance towards the end that a guess assumes, as a share of what is possible."""

NARROW = 8
"""The nearest distances stay in the window until it is so wide: at first, little changes."""


@inner
def row_value(rows: Rows, row: Any, values: Floats) -> float:
    """Return what a row is worth."""
    total = rows.reward[row]
    for at in range(rows.begin[row], rows.begin[row + 1]):
        total += rows.weight[at] * values[rows.target[at]]
    return float(total)


@inner
def best_value(rows: Rows, state: Any, values: Floats) -> float:
    """Return what the best row of a state is worth."""
    best = -np.inf
    for row in range(rows.first[state], rows.first[state + 1]):
        value = row_value(rows, row, values)
        best = value if value > best else best
    return best


@jit
def sweep(rows: Rows, values: Floats, first: int, last: int, step: int) -> float:
    """Update the values of some states, onward (`step` 1) or back (-1).

    Returns:
        The largest change.
    """
    most, begin = 0.0, first if step > 0 else last - 1
    for count in range(last - first):
        state = np.uint32(begin + step * count)
        change = best_value(rows, state, values) - values[state]
        values[state] += change
        most = abs(change) if abs(change) > most else most
    return most


@jit
def choose(
    rows: Rows,
    values: Floats,
    chosen: Ints,
    moving: Nodes,
    counts: Ints,
    calm: float,
    first: int,
    last: int,
) -> float:
    """Update the values of some states, and choose their best rows.

    Args:
        rows: the process.
        values: the values; changed, by more than they should at once, so that they settle sooner.
        chosen: the best row of each state; changed.
        moving: the states whose values change by more than `calm`; changed.
        counts: how many there are; changed.
        calm: a change that does not matter to others.
        first: the first state.
        last: the one after the last.

    Returns:
        The largest change.
    """
    most, count = 0.0, counts[0]
    for index in range(first, last):
        state = np.uint32(index)
        best = -np.inf
        for row in range(rows.first[state], rows.first[state + 1]):
            value = row_value(rows, row, values)
            if value > best:
                best, chosen[state] = value, row
        change = best - values[state]
        values[state] += change * rows.factor[state]
        moving[count] = state
        count += abs(change) > calm
        most = max(most, abs(change))
    counts[0] = count
    return most


@jit
def follow(rows: Rows, values: Floats, chosen: Ints, moving: Nodes, first: int, last: int) -> None:
    """Update the values of some of the states that move by the rows that are chosen."""
    for index in range(first, last):
        state = moving[index]
        change = row_value(rows, chosen[state], values) - values[state]
        values[state] += change * rows.factor[state]


@jit
def guess(rows: Rows, values: Floats, borders: Ints) -> None:
    """Guess the values of states, distance by distance, by those of states nearer to the end.

    Going on, values are taken to fall as they do where a step leads towards the end.
    """
    for distance in range(borders.size - 1):
        known = borders[distance]
        for state in range(known, borders[distance + 1]):
            best = -np.inf
            for row in range(rows.first[state], rows.first[state + 1]):
                best = max(best, row_guess(rows, row, values, known))
            values[state] = best


@inner
def row_guess(rows: Rows, row: int, values: Floats, known: int) -> float:
    """Return what a row may be worth, -inf if it leads to none of the states that are known."""
    near, away, total = rows.killing[row], 0.0, 0.0
    for at in range(rows.begin[row], rows.begin[row + 1]):
        if rows.target[at] < known:
            near += rows.weight[at]
            total += rows.weight[at] * values[rows.target[at]]
        else:
            away += rows.weight[at]
    if near <= 0.0:
        return -np.inf
    fall = min(rows.reward[row], 0.0) * PESSIMISM + max(rows.reward[row], 0.0)
    return float(total / near + fall / max(near - away, LEAST_ADVANCE * near))


@jit
def advance(
    rows: Rows, values: Floats, borders: Ints, window: Ints, most: int, width: int, settled: float
) -> None:
    """Sweep over a window of distances that moves away from the end.

    Args:
        rows: the process.
        values: the values, guessed.
        borders: where the states of each distance begin.
        window: the first distance of the window, and the one after the last; changed.
        most: how many states may be updated in this call.
        width: the most distances in it.
        settled: distances whose values change by no more leave the window, nearest first.
    """
    levels, low, high = borders.size - 1, window[0], window[1]
    while low < levels and most > 0:
        if high < levels:
            high += 1
            low = max(low, high - width)
        else:
            low += 1
        is_settled = True
        for level in range(low, high):
            changed = 0.0
            for index in range(borders[level], borders[level + 1]):
                state = np.uint32(index)
                change = best_value(rows, state, values) - values[state]
                values[state] += change
                changed = abs(change) if abs(change) > changed else changed
            most -= borders[level + 1] - borders[level]
            is_settled = is_settled and changed <= settled
            if is_settled and (high == levels or high - level > NARROW):
                low = level + 1
    window[0], window[1] = low, high


@jit
def improve(rows: Rows, values: Floats, chosen: Ints, slack: float, first: int, last: int) -> int:
    """Choose for states the row that is best by more than `slack`; return how many changed."""
    changed = 0
    for index in range(first, last):
        state = np.uint32(index)
        before = chosen[state]
        bar = row_value(rows, before, values) + slack
        for row in range(rows.first[state], rows.first[state + 1]):
            value = row_value(rows, row, values)
            if value > bar:
                bar = value
                chosen[state] = row
        changed += chosen[state] != before
    return changed


@jit
def climb(
    rows: Rows, values: Floats, chosen: Ints, slack: float, first: int, last: int, step: int
) -> int:
    """Choose for states what is better by more than `slack`, and raise their values at once.

    Values that are no higher than those of what is chosen remain so: rows of a loop are never all
    chosen for what the others promise, as the last of them would have to be better than itself.

    Returns:
        How many states have been changed.
    """
    changed, begin = 0, first if step > 0 else last - 1
    for count in range(last - first):
        state = np.uint32(begin + step * count)
        bar = max(values[state], row_value(rows, chosen[state], values))
        values[state] = bar
        best, found = bar + slack, -1
        for row in range(rows.first[state], rows.first[state + 1]):
            value = row_value(rows, row, values)
            if value > best:
                best, found = value, row
        if found >= 0:
            values[state], chosen[state] = best, found
            changed += 1
    return changed
