"""Values by sweeps in place over rows, as machine code (Gauss-Seidel). Imports Numba."""

from __future__ import annotations

from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.compiled.rows import Floats, Ints, Nodes, Rows, inner, jit

PESSIMISM = 2.0
"""Guesses fall so many times as fast as they should: what is too low rises at once."""

LEAST_ADVANCE = 0.1
"""The least advance towards the end that a guess assumes, as a share of what is possible."""

NARROW = 2
"""The nearest distances stay in the window until it is so wide: at first, little changes."""


@inner
def row_value(rows: Rows, state: Any, action: Any, values: Floats) -> float:
    """Return what a row is worth."""
    total = rows.reward[state, action]
    owner = action * np.uint32(len(rows.own))
    for slot in range(len(rows.slots)):
        total += rows.weight[state, action, slot] * values[rows.target[state, owner, slot]]
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
def largest(values: Floats) -> float:
    """Return the largest size of a value; nan where one is none."""
    most = 0.0
    for value in values:
        most = abs(value) if not abs(value) <= most else most
        if np.isnan(most):
            break
    return most


@inner
def share_of(change: float, values: Floats) -> float:
    """Return a change as a share of the largest size of a value."""
    return 0.0 if change == 0.0 else change / largest(values)


@jit
def sweep(rows: Rows, values: Floats, chosen: Ints, slack: float) -> tuple[float, int]:
    """Update the values of all states, back and then onward, and choose their best rows.

    Args:
        rows: the process.
        values: the values, and that of the end, `[n + 1]`; changed.
        chosen: the chosen row of each state; changed where another is better by more than `slack`.
        slack: how much better it has to be, as a share of the largest value.

    Returns:
        The largest change of a value onward, as such a share, and how many rows have been chosen
        anew.
    """
    size, most, changed, slack = rows.factor.size, 0.0, 0, slack * largest(values)
    for count in range(2 * size):
        most = most if count != size else 0.0
        state = np.uint32(count - size if count >= size else size - 1 - count)
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
    return share_of(most, values), changed


@jit
def settle(
    rows: Rows, values: Floats, chosen: Ints, moving: Nodes, calm: float, times: int
) -> float:
    """Update the values of all states, and some times more those that move, by what is best then.

    Args:
        rows: the process.
        values: the values; changed, by more than they should at once, so that they settle sooner.
        chosen: the best row of each state; changed.
        moving: room for the states whose values change by more than `calm`, `[n + 1]`; changed.
        calm: a change that does not matter to others, as a share of the largest value.
        times: how often the others are updated by the same rows.

    Returns:
        The largest change at first, as such a share.
    """
    most, count, calm = 0.0, 0, calm * largest(values)
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
    for _ in range(times):
        for state in moving[:count]:
            change = row_value(rows, state, np.uint32(chosen[state]), values) - values[state]
            values[state] += change * rows.factor[state]
    return share_of(most, values)


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
    owner = action * np.uint32(len(rows.own))
    for slot in range(len(rows.slots)):
        target, weight = rows.target[state, owner, slot], rows.weight[state, action, slot]
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
