"""Passes over the tables of a model, as machine code. Imports Numba.

Each does in one pass, without arrays in between, what NumPy does in several. Loops do a part of
the states for each call.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.analysis.solver.compiled.rows import (
    AT_ONCE,
    Flags,
    Floats,
    Ints,
    distances,
    inner,
    jit,
    parts,
)

Targets = NDArray[np.int32]


@jit
def add_chances(
    next_state: Targets, probability: Floats, goals: Flags, found: Floats, first: int, last: int
) -> None:
    """Add up how likely each action of some states leads to a goal."""
    for state in range(first, last):
        for action in range(next_state.shape[1]):
            total = 0.0
            for outcome in range(next_state.shape[2]):
                if goals[next_state[state, action, outcome]]:
                    total += probability[state, action, outcome]
            found[state, action] = total


def chances(next_state: Targets, probability: Floats, goals: Flags) -> Floats:
    """Return how likely each action leads to a goal (`[n + 1]`), `[n, actions]`."""
    found = np.empty(next_state.shape[:2])
    for part in parts(len(next_state)):
        add_chances(next_state, probability, goals, found, *part)
    return found


@inner
def action_value(
    state: int,
    action: int,
    next_state: Targets,
    probability: Floats,
    reward: Floats,
    values: Floats,
    discount: float,
) -> float:
    """Return what an action is worth; the value of the end is 0."""
    total = 0.0
    for outcome in range(next_state.shape[2]):
        target = next_state[state, action, outcome]
        if target < values.size:
            total += probability[state, action, outcome] * values[target]
    return float(reward[state, action] + discount * total)


@jit
def note_action_values(
    next_state: Targets,
    probability: Floats,
    reward: Floats,
    values: Floats,
    discount: float,
    found: Floats,
    first: int,
    last: int,
) -> None:
    """Note what each action of some states is worth."""
    given = next_state, probability, reward, values, discount
    for state in range(first, last):
        for action in range(reward.shape[1]):
            found[state, action] = action_value(state, action, *given)


def action_values(
    next_state: Targets, probability: Floats, reward: Floats, values: Floats, discount: float
) -> Floats:
    """Return the action values, `[n, actions]`, for finite values, `[n]`."""
    found = np.empty(reward.shape)
    for part in parts(values.size):
        note_action_values(next_state, probability, reward, values, discount, found, *part)
    return found


@jit
def keep_best(
    next_state: Targets,
    probability: Floats,
    reward: Floats,
    values: Floats,
    discount: float,
    margin: float,
    policy: Ints,
    first: int,
    last: int,
) -> None:
    """Give some states their first best action, unless that of a policy is as good.

    Args:
        next_state: `[n, actions, outcomes]`; `n` is the end.
        probability: `[n, actions, outcomes]`.
        reward: `[n, actions]`.
        values: the values, `[n]`.
        discount: the discount.
        margin: actions whose values differ by no more are equally good.
        policy: the policy, `[n]`; changed.
        first: the first state.
        last: the one after the last.
    """
    given = next_state, probability, reward, values, discount
    for state in range(first, last):
        best = -np.inf
        for action in range(reward.shape[1]):
            best = max(best, action_value(state, action, *given))
        if action_value(state, policy[state], *given) >= best - margin:
            continue
        for action in range(reward.shape[1]):
            if action_value(state, action, *given) >= best - margin:
                policy[state] = action
                break


@jit
def choose_nearer(
    next_state: Targets,
    probability: Floats,
    rows: Flags,
    distance: Targets,
    found: Ints,
    first: int,
    last: int,
) -> None:
    """Choose for some states the action most likely to come nearer; -1 for those at distance 0.

    A distance below 0 is one of states from which nothing leads there.
    """
    for state in range(first, last):
        found[state] = -1
        most = -1.0
        for action in range(rows.shape[1] if distance[state] > 0 else 0):
            if not rows[state, action]:
                continue
            total = 0.0
            for outcome in range(next_state.shape[2]):
                away = distance[next_state[state, action, outcome]]
                if 0 <= away < distance[state]:
                    total += probability[state, action, outcome]
            if total > most:
                most, found[state] = total, action


def nearer(next_state: Targets, probability: Floats, rows: Flags, distance: Targets) -> Ints:
    """Return the actions most likely to come nearer, `[n]`, as `model.attractor` does."""
    found = np.empty(len(next_state), np.int64)
    for part in parts(found.size):
        choose_nearer(next_state, probability, rows, distance, found, *part)
    return found


@jit
def lose(
    begin: Ints, before: Ints, rows: Flags, left: Targets, waiting: Targets, counts: Ints, most: int
) -> None:
    """Take away the actions that may lead to lost states, and lose the states without any.

    Args:
        begin: where the rows that may lead to each node begin.
        before: these rows: `state * actions + action`.
        rows: the actions that may be taken, `[n, actions]`; changed.
        left: how many each state has, -1 for lost ones, `[n]`; changed.
        waiting: the lost states; changed.
        counts: how many of them are done, and how many there are; changed.
        most: how many to do now.
    """
    done, known, actions = counts[0], counts[1], rows.shape[1]
    for _ in range(most):
        if done == known:
            break
        node = waiting[done]
        done += 1
        for at in range(begin[node], begin[node + 1]):
            state, action = divmod(before[at], actions)
            if not rows[state, action]:
                continue
            rows[state, action] = False
            if left[state] > 0:
                left[state] -= 1
                if left[state] == 0:
                    left[state] = -1
                    waiting[known] = state
                    known += 1
    counts[0], counts[1] = done, known


@jit
def violation(
    next_state: Targets,
    probability: Floats,
    reward: Floats,
    values: Floats,
    discount: float,
    rounding: float,
    size: float,
    first: int,
    last: int,
) -> float:
    """Return by how much values of some states violate the Bellman equation; -inf for no action.

    Args:
        next_state: `[n, actions, outcomes]`; `n` is the end.
        probability: `[n, actions, outcomes]`.
        reward: `[n, actions]`; -inf for actions that do not count.
        values: the values, `[n]`.
        discount: the discount.
        rounding: the rounding of a sum, as a share of the sizes in it.
        size: what is added to the sizes of differences of values.
        first: the first state.
        last: the one after the last.
    """
    worst = -np.inf
    for state in range(first, last):
        value, highest = values[state], -np.inf
        for action in range(reward.shape[1]):
            if reward[state, action] == -np.inf:
                continue
            total, sizes = 0.0, 0.0
            for outcome in range(next_state.shape[2]):
                target = next_state[state, action, outcome]
                other = values[target] if target < values.size else 0.0
                change = probability[state, action, outcome] * (other - value)
                total += change
                sizes += abs(change)
            gain = discount * total + (reward[state, action] - (1.0 - discount) * value)
            unsure = rounding * (sizes + size)
            worst = max(worst, gain + unsure)
            highest = max(highest, gain - unsure)
        if highest > -np.inf:
            worst = max(worst, -highest)
    return worst


@jit
def count_rows_before(
    next_state: Targets, probability: Floats, rows: Flags, begin: Ints, first: int, last: int
) -> None:
    """Count for each state, and the end, how often an action of some states may lead there."""
    for state in range(first, last):
        for action in range(rows.shape[1]):
            for outcome in range(next_state.shape[2] if rows[state, action] else 0):
                if probability[state, action, outcome] > 0.0:
                    begin[next_state[state, action, outcome]] += 1


@jit
def note_rows_before(
    next_state: Targets,
    probability: Floats,
    rows: Flags,
    begin: Ints,
    before: Ints,
    first: int,
    last: int,
) -> None:
    """Note these actions; `begin`, where those of each state end, moves to where they begin."""
    actions = rows.shape[1]
    for state in range(first, last):
        for action in range(actions):
            for outcome in range(next_state.shape[2] if rows[state, action] else 0):
                if probability[state, action, outcome] > 0.0:
                    node = next_state[state, action, outcome]
                    begin[node] -= 1
                    before[begin[node]] = state * actions + action


def surely(
    next_state: Targets, probability: Floats, rows: Flags, distance: Targets
) -> tuple[Flags, Targets]:
    """Return the actions by which the end is reached with probability one.

    Args:
        next_state: `[n, actions, outcomes]`; `n` is the end.
        probability: `[n, actions, outcomes]`.
        rows: the actions that may be taken, `[n, actions]`.
        distance: how many steps of these the end is away at least, `[n + 1]`; -1 for never.

    Returns:
        Those actions, of states that can surely end, and the distance by them.
    """
    if (distance >= 0).all():
        return rows, distance
    size, rows = len(next_state), rows.copy()
    begin = np.zeros(size + 2, np.int64)
    for part in parts(size):
        count_rows_before(next_state, probability, rows, begin, *part)
    np.cumsum(begin, out=begin)
    before = np.empty(begin[-1], np.int64)
    for part in parts(size):
        note_rows_before(next_state, probability, rows, begin, before, *part)
    left, waiting = rows.sum(axis=1, dtype=np.int32), np.empty(size, np.int32)
    counts, goals = np.zeros(2, np.int64), np.arange(size + 1) == size
    while True:
        lost = np.flatnonzero((distance[:-1] < 0) & (left >= 0))
        if not lost.size:
            return rows & (left > 0)[:, None], distance
        waiting[counts[1] : counts[1] + lost.size], left[lost] = lost, -1
        counts[1] += lost.size
        while counts[0] < counts[1]:
            lose(begin, before, rows, left, waiting, counts, AT_ONCE)
        distance, _ = distances(next_state, probability, rows, goals)


@jit
def fill_model(
    states: Ints,
    probability: Floats,
    following: Targets,
    rewards: Floats,
    ends: Flags,
    first_action: int,
    number: Targets,
    exits: Flags,
    next_state: Targets,
    reward: Floats,
    success: Floats,
    first: int,
    last: int,
) -> None:
    """Fill the tables of a model for some of its states, as `of_model` has them."""
    for state in range(first, last):
        of = states[state]
        for action in range(reward.shape[1]):
            paid, reached, row = 0.0, 0.0, first_action + action
            for outcome in range(next_state.shape[2]):
                chance, target = probability[of, row, outcome], following[of, row, outcome]
                is_over = ends[of, row, outcome]
                paid += chance * rewards[of, row, outcome]
                reached += chance if is_over and exits[target] else 0.0
                goes_on = chance > 0.0 and not is_over
                next_state[state, action, outcome] = number[target] if goes_on else states.size
            reward[state, action], success[state, action] = paid, reached


def of_model(
    states: Ints, number: Targets, exits: Flags, given: Any, first_action: int
) -> tuple[Targets, Floats, Floats]:
    """Return next states, rewards and chances to reach an exit, as a model has them.

    Args:
        states: the level's numbers of the states, `[n]`.
        number: the number of each state of the level, `[states]`; `n` for terminal ones.
        exits: which states of the level are exits, `[states]`.
        given: the level's probability, next state, reward and whether it ends,
            `[states, actions, outcomes]`.
        first_action: the first action that counts.
    """
    probability, following, rewards, ends = given
    shape = states.size, probability.shape[1] - first_action, probability.shape[2]
    made = np.empty(shape, np.int32), np.empty(shape[:2]), np.empty(shape[:2])
    for part in parts(states.size):
        fill_model(
            *(states, probability, following, rewards, ends, first_action, number, exits),
            *made,
            *part,
        )
    return made
