"""A decision process in the order of distance from the end, as compiled loops read it.

Imports Numba, as all that works on rows does.
"""

from __future__ import annotations

from typing import Any, NamedTuple

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

LEAST_STRETCHED = 0.1
"""Where chance is in a smaller share of states, values settle sooner if nothing is stretched."""

WIDTHS = 5, 8
"""How many targets the actions of a state may share. Loops over so many are compiled for each."""

MOST_GROWN = 2
"""Where sharing targets would take more than so many times the room, actions have their own."""


class Rows(NamedTuple):
    """What may be done in each of `n` states, the nearest to the end first; number `n` is the end.

    A row is an action as if it were taken again wherever it leads back to its own state, so that
    walls slow nothing down: `value = reward + sum of weight * value of target`. Its weights and
    `killing` add up to 1. All rows are equally long: loops that the processor can foresee take
    half the time. They take half of that where the compiler knows how long they are, and where the
    actions of a state, which mostly lead to the same neighbours, share its targets.

    Attributes:
        reward: the expected reward, `[n, actions]`; -inf where an action leads nowhere.
        killing: how likely a row ends the episode, or the discount does, `[n, actions]`.
        target: other states, `[n, 1 or actions, slots]`; the end where there is none.
        weight: how likely they are, discounted, `[n, actions, slots]`; 0 for the end.
        factor: by how much changes of a state's value are best stretched, `[n]`.
        slots: something as long as rows are: a tuple, where the compiler is to know how long.
        own: a tuple of one element where actions have targets of their own, else of none.
    """

    reward: Floats
    killing: Floats
    target: Nodes
    weight: Floats
    factor: Floats
    slots: Any
    own: Any


def shape_of(actions: int, outcomes: int, neighbours: int) -> tuple[Any, tuple[int, ...]]:
    """Return `slots` and `own` of rows.

    Args:
        actions: how many actions there are.
        outcomes: how many outcomes each has at most.
        neighbours: how many other states are one step away at most.
    """
    width = next((each for each in WIDTHS if neighbours <= each), 0)
    if width and (8 * actions + 4) * width <= MOST_GROWN * 12 * actions * outcomes:
        return (0,) * width, ()
    return (0,) if outcomes == 1 else np.zeros(outcomes, np.uint8), (0,)


@jit
def rows_of(
    order: Targets,
    next_state: Targets,
    probability: Floats,
    reward: Floats,
    discount: float,
    slots: Any,
    own: Any,
) -> Rows:
    """Return the rows of a process.

    Args:
        order: its states, the nearest to the end first, `[n]`.
        next_state: `[n, actions, outcomes]`; `n` is the end.
        probability: `[n, actions, outcomes]`.
        reward: `[n, actions]`, -inf for actions that may not be taken.
        discount: the discount.
        slots: as rows have it.
        own: as rows have it.
    """
    size, actions, outcomes = next_state.shape
    number = np.empty(size + 1, np.uint32)
    number[size] = size
    for index in range(size):
        number[order[index]] = index
    rows = Rows(
        np.empty((size, actions)),
        np.empty((size, actions)),
        np.full((size, max(1, actions * len(own)), len(slots)), size, np.uint32),
        np.empty((size, actions, len(slots))),
        np.empty(size),
        slots,
        own,
    )
    # The slot of each node in the row at hand, behind what is below all others, and its chance.
    mark = np.full(size + 1, -1, np.int64)
    itself, end, width = len(slots), len(slots) + 1, len(slots) + 2
    chance, stretched = np.zeros(width), 0
    for index in range(size):
        state, nearest, square, known = order[index], 0.0, 0.0, 0
        for action in range(actions):
            base = (index * actions + action * len(own)) * width
            target = rows.target[index, action * len(own)]
            if len(own) or action == 0:
                known = 0
                mark[state], mark[size] = base + itself, base + end
            for slot in range(width):
                chance[slot] = 0.0
            is_row = reward[state, action] > -np.inf
            for outcome in range(outcomes if is_row else 0):
                node = next_state[state, action, outcome]
                slot = mark[node] - base
                if slot < 0:
                    slot, mark[node], target[known] = known, base + known, number[node]
                    known += 1
                chance[np.uint32(slot)] += probability[state, action, outcome]
            leaving = 1.0 - discount * chance[itself]
            is_row = is_row and leaving > LEAST_LEAVING
            share = 1.0 / leaving if is_row else 0.0
            stopping, near = (1.0 - discount) * share, discount * share * chance[end]
            rows.killing[index, action] = stopping + near
            for slot in range(len(slots)):
                weight = discount * share * chance[slot]
                rows.weight[index, action, slot] = weight
                near += weight if target[slot] < index else 0.0
            rows.reward[index, action] = reward[state, action] * share if is_row else -np.inf
            if near > nearest:
                nearest, square = near, min(4.0 * near * max(1.0 - near - stopping, 0.0), 1.0)
        # D. M. Young's formula for successive over-relaxation of neighbours in a line.
        rows.factor[index] = min(2.0 / (1.0 + np.sqrt(1.0 - square)), MOST_RELAXED)
        stretched += square > 0.0
    if stretched < LEAST_STRETCHED * size:
        rows.factor[:] = 1.0
    return rows


# -- what leads where --------------------------------------------------------------------------


@jit
def distances(
    next_state: Targets, probability: Floats, allowed: Flags, goals: Flags
) -> tuple[Targets, Targets, int]:
    """Return how many steps a goal is away at least, -1 for never, and the nodes in that order.

    At last, it is how many other states may be one step away from a state at most.

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
    count = most = 0
    for state in range(size):
        # Neither itself nor the end is one of them.
        begun, last[state] = count, state
        for action in range(actions):
            for outcome in range(outcomes if allowed[state, action] else 0):
                node = next_state[state, action, outcome]
                if last[node] != state and probability[state, action, outcome] > 0.0:
                    last[node] = state
                    target[count] = node
                    begin[node] += 1
                    count += 1
        behind[state] = count
        most = max(most, count - begun - (last[size] == state))
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
    return distance, order[:known], most


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
