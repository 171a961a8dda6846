"""Values by sweeps in the order of distance from the end, as machine code. Imports Numba.

Sweeps over a whole level need as many rounds as the end is far away: what a value owes to the end
moves on by a few states in each. So a round sweeps only a window of distances, which grows by the
next distance, and loses the nearest ones as soon as their values have settled. Where a policy leads
to the end against what pushes it back, a state is settled after some ten rounds, however far the
end is, so that the work grows with the number of transitions.
"""

import numba
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Nodes = NDArray[np.int32]
Flags = NDArray[np.bool_]

jit = numba.njit(cache=True, nogil=True, error_model="numpy")

SETTLED = 1e-14
"""A value that changes by no more than this share of the largest one has settled."""

BEHIND = 8
"""The nearest distances stay in the window until it is so wide: at first, little changes."""

EVERY = 9
"""Of so many rounds, one tries all actions. The others keep to the best ones, and cost less."""

RELAXATION = 1.25
"""Rounds that keep to a policy change values by so much more: it takes half as many (SOR)."""

MIN_ADVANCE = 0.1
"""The least advance towards the end that a first guess assumes, as a share of what is possible."""


LEAST_LEAVING = 1e-12
"""An action that leaves its state with a smaller probability leads nowhere."""


@jit
def before(
    next_state: Nodes, probability: Floats, rows: Flags, size: int
) -> tuple[NDArray[np.int64], Nodes]:
    """Return for each state and the end (`size`) the other states from which a step may lead there.

    Returns:
        Where those of each begin, `[size + 2]`, and the states themselves.
    """
    begin = np.zeros(size + 2, np.int64)
    distinct = np.empty(next_state.shape[1] * next_state.shape[2], np.int32)
    states = np.empty(0, np.int32)
    for is_filling in (False, True):
        for state in range(size):
            count = 0
            for action in range(next_state.shape[1]):
                if not rows[state, action]:
                    continue
                for outcome in range(next_state.shape[2]):
                    target = next_state[state, action, outcome]
                    if probability[state, action, outcome] <= 0.0 or target == state:
                        continue
                    is_new = True
                    for other in distinct[:count]:
                        is_new = is_new and other != target
                    if not is_new:
                        continue
                    distinct[count] = target
                    count += 1
                    if is_filling:
                        begin[target] -= 1
                        states[begin[target]] = state
                    else:
                        begin[target] += 1
        if not is_filling:
            # Each is filled from its end to its begin.
            begin = np.cumsum(begin)
            states = np.empty(begin[-1], np.int32)
    return begin, states


@jit
def distances(begin: Ints, states: Nodes, goals: Flags) -> tuple[Nodes, Nodes]:
    """Return how many steps a goal is away at least, -1 for never, and the states in that order."""
    distance = np.full(goals.size, -1, np.int32)
    order = np.empty(goals.size, np.int32)
    known = 0
    for goal in range(goals.size):
        if goals[goal]:
            distance[goal] = 0
            order[known] = goal
            known += 1
    done = 0
    while done < known:
        node = order[done]
        done += 1
        for edge in range(begin[node], begin[node + 1]):
            state = states[edge]
            if distance[state] < 0:
                distance[state] = distance[node] + 1
                order[known] = state
                known += 1
    return distance, order[:known]


@jit
def action_value(
    state: int,
    action: int,
    next_state: Nodes,
    probability: Floats,
    reward: Floats,
    values: Floats,
    discount: float,
) -> float:
    """Return an action's value, if it is taken again wherever it leads to its own state."""
    if reward[state, action] == -np.inf:
        return -np.inf
    total, leaving = 0.0, 1.0
    for outcome in range(next_state.shape[2]):
        following = np.uint32(next_state[state, action, outcome])
        chance = discount * probability[state, action, outcome]
        if following == state:
            leaving -= chance
        else:
            total += chance * values[following]
    if np.isnan(total):
        return first_guess(state, action, next_state, probability, reward, values, discount)
    total += reward[state, action]
    if leaving == 1.0:
        return float(total)
    return float(total / leaving) if leaving > LEAST_LEAVING else -np.inf


@jit
def first_guess(
    state: int,
    action: int,
    next_state: Nodes,
    probability: Floats,
    reward: Floats,
    values: Floats,
    discount: float,
) -> float:
    """Return an action's value where some of the states that follow have none yet (nan).

    These are farther away: going on, values are taken to fall as they do from what is known.
    """
    total, known, farther = 0.0, 0.0, 0.0
    for outcome in range(next_state.shape[2]):
        following = next_state[state, action, outcome]
        chance = probability[state, action, outcome]
        if following != state and np.isnan(values[following]):
            farther += chance
        elif following != state:
            known += chance
            total += chance * values[following]
    if known < 1e-9:
        return -np.inf
    mean = total / known
    step = reward[state, action] - (1.0 - discount) * mean
    return float(mean + step / max(known - farther, MIN_ADVANCE * known))


@jit
def improve(
    state: int,
    policy: Ints,
    next_state: Nodes,
    probability: Floats,
    reward: Floats,
    values: Floats,
    discount: float,
) -> float:
    """Give a state its best action, and return that action's value."""
    own = policy[state]
    best = action_value(state, own, next_state, probability, reward, values, discount)
    for action in range(reward.shape[1]):
        if action != own:
            value = action_value(state, action, next_state, probability, reward, values, discount)
            if value > best:
                best = value
                policy[state] = action
    return best


@jit
def sweep(
    states: Nodes,
    tries_all: bool,
    policy: Ints,
    next_state: Nodes,
    probability: Floats,
    reward: Floats,
    values: Floats,
    discount: float,
) -> float:
    """Update the values of some states in their order, and return the largest change."""
    changed = 0.0
    for state in states:
        if tries_all:
            value = improve(state, policy, next_state, probability, reward, values, discount)
        else:
            value = action_value(
                state, policy[state], next_state, probability, reward, values, discount
            )
        change = abs(value - values[state])
        if np.isnan(change):
            # It is the first value.
            changed = np.inf
        elif not tries_all:
            value = values[state] + RELAXATION * (value - values[state])
        changed = max(changed, change)
        values[state] = value
    return changed


@jit
def solve(
    order: Nodes,
    first: Ints,
    next_state: Nodes,
    probability: Floats,
    reward: Floats,
    discount: float,
    most: float,
) -> tuple[Floats, int, float]:
    """Return values, `[n + 1]`, the rounds until they had settled, and how much of `most` is left.

    The rounds are 0 where they have not settled.

    Args:
        order: the states, the nearest to the end first, `[n]`.
        first: where in this order each distance begins, and where the last one ends.
        next_state: int32, `[n, actions, outcomes]`.
        probability: `[n, actions, outcomes]`.
        reward: `[n, actions]`, -inf for actions that may not be taken.
        discount: the discount.
        most: how often each state's actions may all be tried, on average, before this gives up.
    """
    size, actions = reward.shape
    values, policy = np.full(size + 1, np.nan), np.empty(size, np.int64)
    values[size] = 0.0
    scale = 0.0
    for state in range(size):
        policy[state] = reward[state].argmax()
        scale = max(scale, abs(reward[state, policy[state]]))
    levels, low, high, rounds, left = first.size - 1, 0, 0, 0, float(most) * size
    while low < levels and left > 0:
        if high < levels:
            states = order[first[high] : first[high + 1]]
            sweep(states, True, policy, next_state, probability, reward, values, discount)
            high += 1
        rounds += 1
        window = order[first[low] : first[high]]
        if rounds % EVERY:
            left -= window.size / actions
            sweep(window, False, policy, next_state, probability, reward, values, discount)
            continue
        left -= window.size
        is_settled = True
        for level in range(low, high):
            states = order[first[level] : first[level + 1]]
            changed = sweep(states, True, policy, next_state, probability, reward, values, discount)
            for state in states:
                scale = max(scale, abs(values[state]))
            is_settled = is_settled and changed <= SETTLED * scale
            if is_settled and (high == levels or high - level > BEHIND):
                low = level + 1
    while left > 0:
        left -= size
        rounds += 1
        changed = sweep(order, True, policy, next_state, probability, reward, values, discount)
        # Guesses may have been far too large.
        if changed <= SETTLED * np.abs(values).max():
            return values, rounds, left / size
    return values, 0, left / size
