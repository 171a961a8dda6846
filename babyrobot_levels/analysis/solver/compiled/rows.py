"""A decision process in the order of distance from the end, as compiled loops read it.

Imports Numba, as all that works on rows does. Loops do a part of the work for each call, so that
whoever waits can interrupt between them.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Nodes = NDArray[np.uint32]
Flags = NDArray[np.bool_]

jit = numba.njit(cache=True, nogil=True, error_model="numpy")
inner = numba.njit(cache=True, nogil=True, error_model="numpy", forceinline=True)

LEAST_LEAVING = 1e-12
"""An action that leaves its state with a smaller probability leads nowhere."""

MOST_RELAXED = 1.6
"""The largest factor by which changes of values are stretched."""

AT_ONCE = 1 << 20
"""So many states are worked on by one call: between calls, signals are heard."""


def parts(size: int) -> Iterator[tuple[int, int]]:
    """Yield the first number and the one after the last of parts of some states."""
    for first in range(0, size, AT_ONCE):
        yield first, min(first + AT_ONCE, size)


def backward_parts(size: int) -> Iterator[tuple[int, int]]:
    """Yield the same parts, the last one first."""
    return reversed([*parts(size)])


class Rows(NamedTuple):
    """What may be done in each of `n` states, the nearest to the end first.

    A row is an action as if it were taken again wherever it leads back to its own state, so that
    walls slow nothing down: `value = reward + sum of weight * value of target`. Its weights and
    `killing` add up to 1.

    Attributes:
        first: where the rows of each state begin, `[n + 1]`.
        action: the action of each row.
        begin: where the outcomes of each row begin, `[rows + 1]`.
        reward: the expected reward, `[rows]`.
        killing: how likely a row ends the episode, or the discount does, `[rows]`.
        target: another state, for each outcome.
        weight: how likely it is, discounted.
        factor: by how much changes of a state's value are best stretched, `[n]`.
    """

    first: Ints
    action: NDArray[np.int8]
    begin: Ints
    reward: Floats
    killing: Floats
    target: Nodes
    weight: Floats
    factor: Floats

    def row_of(self, policy: Ints, actions: int) -> Ints:
        """Return the row of each state's action, `[n]`; -1 where it leads nowhere."""
        size = self.factor.size
        table = np.full(size * actions, -1)
        state = np.repeat(np.arange(size), np.diff(self.first))
        table[state * actions + self.action] = np.arange(self.action.size)
        found: Ints = table[np.arange(size) * actions + policy]
        return found


def ordered(
    distance: NDArray[np.int32], order: NDArray[np.int32]
) -> tuple[NDArray[np.int32], Ints]:
    """Return the states of a process in the order of their distance from the end.

    Args:
        distance: how many steps the end is away, `[n + 1]`, -1 for never.
        order: the nodes for which it is known, from the end on.

    Returns:
        The states, those that cannot reach the end last, and where those of each distance begin
        among them, their number at last.
    """
    others = np.flatnonzero(distance < 0).astype(np.int32)
    order = np.concatenate([order[1:], others])
    steps = np.diff(distance[order], prepend=0)
    return order, np.append(np.flatnonzero(steps), order.size)


def rows_of(
    order: NDArray[np.int32],
    next_state: NDArray[np.int32],
    probability: Floats,
    reward: Floats,
    discount: float,
) -> Rows:
    """Return the rows of a process.

    Args:
        order: its states, the nearest to the end first, `[n]`.
        next_state: `[n, actions, outcomes]`; `n` is the end.
        probability: `[n, actions, outcomes]`.
        reward: `[n, actions]`, -inf for actions that may not be taken.
        discount: the discount.
    """
    size, (actions, outcomes) = order.size, next_state.shape[1:]
    number = np.empty(size + 1, np.int64)
    number[order], number[size] = np.arange(size), size
    most = size * actions
    found = Rows(
        first=np.zeros(size + 1, np.int64),
        action=np.empty(most, np.int8),
        begin=np.zeros(most + 1, np.int64),
        reward=np.empty(most),
        killing=np.empty(most),
        target=np.empty(most * outcomes, np.uint32),
        weight=np.empty(most * outcomes),
        factor=np.empty(size),
    )
    for part in parts(size):
        fill(order, number, next_state, probability, reward, discount, found, *part)
    count = int(found.first[-1])
    filled = int(found.begin[count])
    return Rows(
        found.first,
        found.action[:count],
        found.begin[: count + 1],
        found.reward[:count],
        found.killing[:count],
        found.target[:filled],
        found.weight[:filled],
        found.factor,
    )


@inner
def leaving_of(
    state: int,
    action: int,
    next_state: NDArray[np.int32],
    probability: Floats,
    reward: Floats,
    discount: float,
) -> float:
    """Return how likely an action leaves its state, the discount included; 0 if it is no row."""
    if reward[state, action] == -np.inf:
        return 0.0
    back = 0.0
    for outcome in range(next_state.shape[2]):
        if next_state[state, action, outcome] == state:
            back += discount * probability[state, action, outcome]
    return 1.0 - back if 1.0 - back > LEAST_LEAVING else 0.0


@jit
def fill(
    order: NDArray[np.int32],
    number: Ints,
    next_state: NDArray[np.int32],
    probability: Floats,
    reward: Floats,
    discount: float,
    rows: Rows,
    first: int,
    last: int,
) -> None:
    """Fill the rows of some states, after those before them."""
    size = order.size
    for index in range(first, last):
        state, row = order[index], rows.first[index]
        nearest, rows.factor[index] = 0.0, 1.0
        for action in range(reward.shape[1]):
            leaving = leaving_of(state, action, next_state, probability, reward, discount)
            if leaving == 0.0:
                continue
            at, near, far = rows.begin[row], 0.0, 0.0
            rows.action[row] = action
            rows.reward[row] = reward[state, action] / leaving
            killing = 1.0 - discount
            for outcome in range(next_state.shape[2]):
                target = next_state[state, action, outcome]
                chance = discount * probability[state, action, outcome]
                if target == state or chance <= 0.0:
                    continue
                if target == size:
                    killing += chance
                    continue
                rows.target[at] = number[target]
                rows.weight[at] = chance / leaving
                near += rows.weight[at] if number[target] < index else 0.0
                far += rows.weight[at] if number[target] > index else 0.0
                at += 1
            rows.killing[row] = killing / leaving
            row += 1
            rows.begin[row] = at
            if near > nearest:
                nearest = near
                square = min(4.0 * near * far, 1.0)
                # D. M. Young's formula for successive over-relaxation of neighbours in a line.
                rows.factor[index] = min(2.0 / (1.0 + np.sqrt(1.0 - square)), MOST_RELAXED)
        rows.first[index + 1] = row


# -- what leads where --------------------------------------------------------------------------


@inner
def successors(
    state: int,
    next_state: NDArray[np.int32],
    probability: Floats,
    allowed: Flags,
    found: NDArray[np.int32],
) -> int:
    """Note the other states to which a step may lead, each once; return how many."""
    count = 0
    for action in range(next_state.shape[1]):
        if not allowed[state, action]:
            continue
        for outcome in range(next_state.shape[2]):
            target = next_state[state, action, outcome]
            if probability[state, action, outcome] <= 0.0 or target == state:
                continue
            is_new = True
            for index in range(count):
                is_new = is_new and found[index] != target
            found[count] = target
            count += is_new
    return count


@jit
def count_edges(
    next_state: NDArray[np.int32],
    probability: Floats,
    allowed: Flags,
    found: NDArray[np.int32],
    begin: Ints,
    first: int,
    last: int,
) -> None:
    """Count for each state, and the end, from how many others a step may lead there."""
    for state in range(first, last):
        for index in range(successors(state, next_state, probability, allowed, found)):
            begin[found[index]] += 1


@jit
def note_edges(
    next_state: NDArray[np.int32],
    probability: Floats,
    allowed: Flags,
    found: NDArray[np.int32],
    begin: Ints,
    before: NDArray[np.int32],
    first: int,
    last: int,
) -> None:
    """Note these others; `begin`, where those of each state end, moves to where they begin."""
    for state in range(first, last):
        for index in range(successors(state, next_state, probability, allowed, found)):
            node = found[index]
            begin[node] -= 1
            before[begin[node]] = state


@jit
def search(
    begin: Ints,
    before: NDArray[np.int32],
    distance: NDArray[np.int32],
    order: NDArray[np.int32],
    progress: Ints,
    most: int,
) -> None:
    """Go on with a breadth-first search backwards from nodes that are known.

    Args:
        begin: where the states before each node begin.
        before: these states.
        distance: the distance of each node, -1 where it is unknown; changed.
        order: the known ones, in the order of their distance; changed.
        progress: from how many of these the search has gone on, and how many are known; changed.
        most: from how many to go on now.
    """
    done, known = progress[0], progress[1]
    for _ in range(most):
        if done == known:
            break
        node = order[done]
        done += 1
        for edge in range(begin[node], begin[node + 1]):
            state = before[edge]
            if distance[state] < 0:
                distance[state] = distance[node] + 1
                order[known] = state
                known += 1
    progress[0], progress[1] = done, known


def distances(
    next_state: NDArray[np.int32], probability: Floats, allowed: Flags, goals: Flags
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Return how many steps a goal is away at least, -1 for never, and the nodes in that order.

    Args:
        next_state: `[n, actions, outcomes]`; `n` is the end.
        probability: `[n, actions, outcomes]`.
        allowed: the actions that may be taken, `[n, actions]`.
        goals: the goals among states and the end, `[n + 1]`.
    """
    size = goals.size - 1
    given = next_state, probability, allowed, np.empty(next_state[0].size + 1, np.int32)
    begin = np.zeros(size + 2, np.int64)
    for part in parts(size):
        count_edges(*given, begin, *part)
    np.cumsum(begin, out=begin)
    before = np.empty(begin[-1], np.int32)
    for part in parts(size):
        note_edges(*given, begin, before, *part)
    distance, order = np.full(size + 1, -1, np.int32), np.empty(size + 1, np.int32)
    ends = np.flatnonzero(goals)
    distance[ends], order[: ends.size] = 0, ends
    progress = np.array([0, ends.size])
    while progress[0] < progress[1]:
        search(begin, before, distance, order, progress, AT_ONCE)
    return distance, order[: progress[1]]
