"""A decision process in the order of distance from the end, as compiled loops read it.

Imports Numba, as all that works on rows does.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Nodes = NDArray[np.uint32]
Targets = NDArray[np.int32]
Flags = NDArray[np.bool_]

FUSED = {"contract"}
"""What is not as IEEE 754 has it: a product that is added to something is rounded once."""

jit = numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=FUSED)
inner = numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=FUSED, forceinline=True)

summing = numba.njit(
    cache=True, nogil=True, error_model="numpy", fastmath={*FUSED, "reassoc"}, forceinline=True
)
"""Compiles a sum whose order does not matter: that of the machine at hand is four times as fast."""

LEAST_LEAVING = 1e-12
"""An action that leaves its state with a smaller probability leads nowhere."""

MOST_RELAXED = 1.6
"""The largest factor by which changes of values are stretched."""


class Rows(NamedTuple):
    """What may be done in each of `n` states, the nearest to the end first; number `n` is the end.

    A row is an action as if it were taken again wherever it leads back to its own state, so that
    walls slow nothing down: `value = reward + sum of weight * value of target`. Its weights and
    `killing` add up to 1. All rows are equally long: loops that the processor can foresee take
    half the time.

    Attributes:
        reward: the expected reward, `[n, actions]`; -inf where an action leads nowhere.
        killing: how likely a row ends the episode, or the discount does, `[n, actions]`.
        target: another state, `[n, actions, outcomes]`; the end where there is none.
        weight: how likely it is, discounted, `[n, actions, outcomes]`; 0 for the end.
        factor: by how much changes of a state's value are best stretched, `[n]`.
    """

    reward: Floats
    killing: Floats
    target: Nodes
    weight: Floats
    factor: Floats


@jit
def rows_of(
    order: Targets, next_state: Targets, probability: Floats, reward: Floats, discount: float
) -> Rows:
    """Return the rows of a process.

    Args:
        order: its states, the nearest to the end first, `[n]`.
        next_state: `[n, actions, outcomes]`; `n` is the end.
        probability: `[n, actions, outcomes]`.
        reward: `[n, actions]`, -inf for actions that may not be taken.
        discount: the discount.
    """
    size, actions, outcomes = next_state.shape
    number = np.empty(size + 1, np.uint32)
    number[size] = size
    for index in range(size):
        number[order[index]] = index
    rows = Rows(
        np.empty((size, actions)),
        np.empty((size, actions)),
        np.empty((size, actions, outcomes), np.uint32),
        np.empty((size, actions, outcomes)),
        np.empty(size),
    )
    for index in range(size):
        state, nearest, square = order[index], 0.0, 0.0
        for action in range(actions):
            back = 0.0
            for outcome in range(outcomes):
                is_back = next_state[state, action, outcome] == state
                back += probability[state, action, outcome] if is_back else 0.0
            leaving, near, far, ends = 1.0 - discount * back, 0.0, 0.0, 0.0
            is_row = leaving > LEAST_LEAVING and reward[state, action] > -np.inf
            share = 1.0 / leaving if is_row else 0.0
            for outcome in range(outcomes):
                target = next_state[state, action, outcome]
                chance = discount * probability[state, action, outcome] * share
                ends += chance if target == size else 0.0
                is_other = is_row and target != state and target != size
                other, weight = number[target] if is_other else size, chance if is_other else 0.0
                rows.target[index, action, outcome] = other
                rows.weight[index, action, outcome] = weight
                near += weight if other < index else 0.0
                far += weight if other > index else 0.0
            rows.reward[index, action] = reward[state, action] * share if is_row else -np.inf
            rows.killing[index, action] = (1.0 - discount) * share + ends
            if near > nearest:
                nearest, square = near, min(4.0 * near * far, 1.0)
        # D. M. Young's formula for successive over-relaxation of neighbours in a line.
        rows.factor[index] = min(2.0 / (1.0 + np.sqrt(1.0 - square)), MOST_RELAXED)
    return rows


# -- what leads where --------------------------------------------------------------------------


@jit
def distances(
    next_state: Targets, probability: Floats, allowed: Flags, goals: Flags
) -> tuple[Targets, Targets]:
    """Return how many steps a goal is away at least, -1 for never, and the nodes in that order.

    Args:
        next_state: `[n, actions, outcomes]`; `n` is the end.
        probability: `[n, actions, outcomes]`.
        allowed: the actions that may be taken, `[n, actions]`.
        goals: the goals among states and the end, `[n + 1]`.
    """
    size, actions, outcomes = next_state.shape
    # Edges, each once, grouped by where they begin, and then by where they end.
    target, behind = np.empty(next_state.size, np.int32), np.empty(size, np.int64)
    last, begin = np.full(size + 1, -1, np.int32), np.zeros(size + 2, np.int64)
    count = 0
    for state in range(size):
        for action in range(actions):
            for outcome in range(outcomes if allowed[state, action] else 0):
                node = next_state[state, action, outcome]
                if last[node] != state and probability[state, action, outcome] > 0.0:
                    last[node] = state
                    target[count] = node
                    begin[node] += 1
                    count += 1
        behind[state] = count
    for node in range(size + 1):
        begin[node + 1] += begin[node]
    before, at = np.empty(count, np.int32), 0
    for state in range(size):
        while at < behind[state]:
            begin[target[at]] -= 1
            before[begin[target[at]]] = state
            at += 1
    distance, order = np.full(size + 1, -1, np.int32), np.empty(size + 1, np.int32)
    done = known = 0
    for node in range(size + 1):
        if goals[node]:
            distance[node], order[known] = 0, node
            known += 1
    while done < known:
        node = order[done]
        done += 1
        for at in range(begin[node], begin[node + 1]):
            state = before[at]
            if distance[state] < 0:
                distance[state], order[known] = distance[node] + 1, state
                known += 1
    return distance, order[:known]


@jit
def ordered(distance: Targets, order: Targets) -> tuple[Targets, Ints]:
    """Return the states of a process in the order of their distance from the end.

    Args:
        distance: how many steps the end is away, `[n + 1]`, -1 for never.
        order: the nodes for which it is known, from the end on.

    Returns:
        The states, those that cannot reach the end last, and where those of each distance begin
        among them, their number at last.
    """
    size = distance.size - 1
    found, borders = np.empty(size, np.int32), np.empty(size + 2, np.int64)
    found[: order.size - 1] = order[1:]
    count, levels, known = order.size - 1, 0, 0
    for state in range(size):
        if distance[state] < 0:
            found[count] = state
            count += 1
    for index in range(size):
        if distance[found[index]] != known:
            known, borders[levels] = distance[found[index]], index
            levels += 1
    borders[levels] = size
    return found, borders[: levels + 1]
