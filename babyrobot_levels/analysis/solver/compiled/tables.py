"""Passes over the tables of a model, as machine code. Imports Numba.

Each does in one pass, without arrays in between, what NumPy does in several.
"""

from __future__ import annotations

import numpy as np

from babyrobot_levels.analysis.solver.compiled.rows import (
    Flags,
    Floats,
    Ints,
    Targets,
    distances,
    jit,
)


@jit
def chances(next_state: Targets, probability: Floats, goals: Flags) -> Floats:
    """Return how likely each action leads to a goal (`[n + 1]`), `[n, actions]`."""
    size, actions, outcomes = next_state.shape
    found = np.empty((size, actions))
    for state in range(size):
        for action in range(actions):
            total = 0.0
            for outcome in range(outcomes):
                is_goal = goals[next_state[state, action, outcome]]
                total += probability[state, action, outcome] if is_goal else 0.0
            found[state, action] = total
    return found


@jit
def action_values(
    next_state: Targets, probability: Floats, reward: Floats, values: Floats, discount: float
) -> Floats:
    """Return the action values, `[n, actions]`, for finite values, `[n + 1]`, the end's last."""
    found = np.empty(reward.shape)
    for state in range(len(reward)):
        for action in range(reward.shape[1]):
            total = 0.0
            for outcome in range(next_state.shape[2]):
                value = values[np.uint32(next_state[state, action, outcome])]
                total += probability[state, action, outcome] * value
            found[state, action] = reward[state, action] + discount * total
    return found


@jit
def nearer(next_state: Targets, probability: Floats, rows: Flags, distance: Targets) -> Ints:
    """Return the actions most likely to come nearer, `[n]`, as `model.attractor` does.

    It is -1 where the distance is 0, or below 0, from where nothing leads there.
    """
    size, actions, outcomes = next_state.shape
    found = np.full(size, -1)
    for state in range(size):
        most = -1.0
        for action in range(actions if distance[state] > 0 else 0):
            total = 0.0
            for outcome in range(outcomes):
                away = distance[next_state[state, action, outcome]]
                is_nearer = 0 <= away < distance[state]
                total += probability[state, action, outcome] if is_nearer else 0.0
            if total > most and rows[state, action]:
                most, found[state] = total, action
    return found


@jit
def lose(
    begin: Ints, before: Ints, rows: Flags, left: Targets, waiting: Targets, counts: Ints
) -> None:
    """Take away the actions that may lead to lost states, and lose the states without any.

    Args:
        begin: where the rows that may lead to each node begin.
        before: these rows.
        rows: the actions that may be taken, `[n, actions]`; changed.
        left: how many each state has, -1 for lost ones, `[n]`; changed.
        waiting: the lost states; changed.
        counts: how many of them are done, and how many there are; changed.
    """
    done, known, actions = counts[0], counts[1], rows.shape[1]
    while done < known:
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
) -> float:
    """Return by how much values violate the Bellman equation; -inf for no action.

    Args:
        next_state: `[n, actions, outcomes]`; `n` is the end.
        probability: `[n, actions, outcomes]`.
        reward: `[n, actions]`; -inf for actions that do not count.
        values: the values, `[n + 1]`, of the end at last.
        discount: the discount.
        rounding: the rounding of a sum, as a share of the sizes in it.
        size: what is added to the sizes of differences of values.
    """
    worst = -np.inf
    for state in range(len(reward)):
        value, highest = values[state], -np.inf
        for action in range(reward.shape[1]):
            if reward[state, action] == -np.inf:
                continue
            total, sizes = 0.0, 0.0
            for outcome in range(next_state.shape[2]):
                other = values[np.uint32(next_state[state, action, outcome])]
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
def rows_before(next_state: Targets, probability: Floats, rows: Flags) -> tuple[Ints, Ints]:
    """Return where the rows that may lead to each state, and the end, begin, and these rows.

    A row is `state * actions + action`.
    """
    size, actions, outcomes = next_state.shape
    begin = np.zeros(size + 2, np.int64)
    for state in range(size):
        for action in range(actions):
            for outcome in range(outcomes if rows[state, action] else 0):
                is_possible = probability[state, action, outcome] > 0.0
                begin[next_state[state, action, outcome]] += is_possible
    for node in range(size + 1):
        begin[node + 1] += begin[node]
    before = np.empty(begin[size + 1], np.int64)
    for row in range(size * actions):
        state, action = divmod(row, actions)
        for outcome in range(outcomes if rows[state, action] else 0):
            if probability[state, action, outcome] > 0.0:
                node = next_state[state, action, outcome]
                begin[node] -= 1
                before[begin[node]] = row
    return begin, before


def going_on(next_state: Targets, probability: Floats, rows: Flags) -> Flags:
    """Return those of some actions that never lead to where there are none of them."""
    left, rows = rows.sum(axis=1, dtype=np.int32), rows.copy()
    lost = np.flatnonzero(left == 0)
    if lost.size:
        waiting, counts = np.empty(len(left), np.int32), np.array([0, lost.size])
        waiting[: lost.size], left[lost] = lost, -1
        lose(*rows_before(next_state, probability, rows), rows, left, waiting, counts)
    return rows


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
    begin, before = rows_before(next_state, probability, rows)
    left, waiting = rows.sum(axis=1, dtype=np.int32), np.empty(size, np.int32)
    counts, goals = np.zeros(2, np.int64), np.arange(size + 1) == size
    while True:
        lost = np.flatnonzero((distance[:-1] < 0) & (left >= 0))
        if not lost.size:
            return rows & (left > 0)[:, None], distance
        waiting[counts[1] : counts[1] + lost.size], left[lost] = lost, -1
        counts[1] += lost.size
        lose(begin, before, rows, left, waiting, counts)
        distance = distances(next_state, probability, rows, goals)[0]


@jit
def of_model(
    states: Ints,
    number: Targets,
    exits: Flags,
    probability: Floats,
    following: Targets,
    rewards: Floats,
    ends: Flags,
    first_action: int,
) -> tuple[Targets, Floats, Floats, Floats]:
    """Return next states, rewards, and chances to reach an exit and the end, as a model has them.

    Args:
        states: the level's numbers of the states, `[n]`.
        number: the number of each state of the level, `[states]`; `n` for terminal ones.
        exits: which states of the level are exits, `[states]`.
        probability: the level's, `[states, actions, outcomes]`.
        following: its next states.
        rewards: its rewards.
        ends: which of its outcomes end the episode.
        first_action: the first action that counts.
    """
    size, actions, outcomes = states.size, probability.shape[1] - first_action, probability.shape[2]
    next_state = np.empty((size, actions, outcomes), np.int32)
    reward, success = np.empty((size, actions)), np.empty((size, actions))
    ending = np.empty((size, actions))
    for state in range(size):
        of = states[state]
        for action in range(actions):
            paid, reached, ended, row = 0.0, 0.0, 0.0, first_action + action
            for outcome in range(outcomes):
                chance, target = probability[of, row, outcome], following[of, row, outcome]
                is_over = ends[of, row, outcome]
                paid += chance * rewards[of, row, outcome]
                ended += chance if is_over else 0.0
                reached += chance if is_over and exits[target] else 0.0
                goes_on = chance > 0.0 and not is_over
                next_state[state, action, outcome] = number[target] if goes_on else size
            reward[state, action], success[state, action] = paid, reached
            ending[state, action] = ended
    return next_state, reward, success, ending
