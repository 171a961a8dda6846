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
def row_value(rows: Rows, state: Any, action: Any, values: Floats) -> float:
    """Return what a row is worth."""
    total = rows.reward[state, action]
    for outcome in range(rows.target.shape[2]):
        total += rows.weight[state, action, outcome] * values[rows.target[state, action, outcome]]
    return float(total)


@inner
def best_value(rows: Rows, state: Any, values: Floats) -> float:
    """Return what the best row of a state is worth."""
    best = -np.inf
    for action in range(rows.reward.shape[1]):
        value = row_value(rows, state, np.uint32(action), values)
        best = value if value > best else best
    return best


@jit
def sweep(rows: Rows, values: Floats, chosen: Ints, slack: float, step: int) -> tuple[float, int]:
    """Update the values of all states, onward (`step` 1) or back (-1), and choose their best rows.

    Args:
        rows: the process.
        values: the values, and that of the end, `[n + 1]`; changed.
        chosen: the chosen row of each state; changed where another is better by more than `slack`.
        slack: how much better it has to be.
        step: 1 or -1.

    Returns:
        The largest change of a value, and how many rows have been chosen anew.
    """
    size, most, changed = rows.factor.size, 0.0, 0
    for count in range(size):
        state = np.uint32(count if step > 0 else size - 1 - count)
        best, own, found, now = -np.inf, -np.inf, 0, chosen[state]
        for action in range(rows.reward.shape[1]):
            value = row_value(rows, state, np.uint32(action), values)
            own = value if action == now else own
            found = action if value > best else found
            best = value if value > best else best
        if best > own + slack:
            chosen[state] = found
            changed += 1
        most = max(most, abs(best - values[state]))
        values[state] = best
    return most, changed


@jit
def choose(
    rows: Rows, values: Floats, chosen: Ints, moving: Nodes, calm: float
) -> tuple[float, int]:
    """Update the values of all states, and choose their best rows.

    Args:
        rows: the process.
        values: the values; changed, by more than they should at once, so that they settle sooner.
        chosen: the best row of each state; changed.
        moving: the states whose values change by more than `calm`, `[n + 1]`; changed.
        calm: a change that does not matter to others.

    Returns:
        The largest change, and how many states move.
    """
    most, count = 0.0, 0
    for index in range(rows.factor.size):
        state = np.uint32(index)
        best, found = -np.inf, 0
        for action in range(rows.reward.shape[1]):
            value = row_value(rows, state, np.uint32(action), values)
            found = action if value > best else found
            best = value if value > best else best
        change, chosen[state] = best - values[state], found
        values[state] += change * rows.factor[state]
        moving[count] = state
        count += abs(change) > calm
        most = max(most, abs(change))
    return most, count


@jit
def follow(rows: Rows, values: Floats, chosen: Ints, moving: Nodes, times: int) -> None:
    """Update the values of the states that move some times, by the rows that are chosen."""
    for _ in range(times):
        for state in moving:
            change = row_value(rows, state, np.uint32(chosen[state]), values) - values[state]
            values[state] += change * rows.factor[state]


@jit
def guess(rows: Rows, values: Floats, borders: Ints) -> None:
    """Guess the values of states, distance by distance, by those of states nearer to the end.

    Going on, values are taken to fall as they do where a step leads towards the end.
    """
    for distance in range(borders.size - 1):
        known = borders[distance]
        for index in range(known, borders[distance + 1]):
            state, best = np.uint32(index), -np.inf
            for action in range(rows.reward.shape[1]):
                best = max(best, row_guess(rows, state, np.uint32(action), values, known))
            values[state] = best


@inner
def row_guess(rows: Rows, state: Any, action: Any, values: Floats, known: int) -> float:
    """Return what a row may be worth, -inf if it leads to none of the states that are known."""
    near, away, total = rows.killing[state, action], 0.0, 0.0
    for outcome in range(rows.target.shape[2]):
        target, weight = rows.target[state, action, outcome], rows.weight[state, action, outcome]
        if target < known:
            near += weight
            total += weight * values[target]
        else:
            away += weight
    if near <= 0.0:
        return -np.inf
    reward = rows.reward[state, action]
    fall = min(reward, 0.0) * PESSIMISM + max(reward, 0.0)
    return float(total / near + fall / max(near - away, LEAST_ADVANCE * near))


@jit
def advance(rows: Rows, values: Floats, borders: Ints, width: int, settled: float) -> None:
    """Sweep over a window of distances that moves away from the end.

    Args:
        rows: the process.
        values: the values, guessed.
        borders: where the states of each distance begin.
        width: the most distances in the window.
        settled: distances whose values change by no more leave the window, nearest first.
    """
    levels, low, high = borders.size - 1, 0, 0
    while low < levels:
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
                changed = max(changed, abs(change))
            is_settled = is_settled and changed <= settled
            if is_settled and (high == levels or high - level > NARROW):
                low = level + 1


@jit
def climb(rows: Rows, values: Floats, chosen: Ints, slack: float, step: int) -> int:
    """Choose for states what is better by more than `slack`, and raise their values at once.

    Values that are no higher than those of what is chosen remain so: rows of a loop are never all
    chosen for what the others promise, as the last of them would have to be better than itself.

    Returns:
        How many states have been changed.
    """
    size, changed = rows.factor.size, 0
    for count in range(size):
        state = np.uint32(count if step > 0 else size - 1 - count)
        bar = max(values[state], row_value(rows, state, np.uint32(chosen[state]), values))
        values[state] = bar
        best, found = bar + slack, -1
        for action in range(rows.reward.shape[1]):
            value = row_value(rows, state, np.uint32(action), values)
            if value > best:
                best, found = value, action
        if found >= 0:
            values[state], chosen[state] = best, found
            changed += 1
    return changed
