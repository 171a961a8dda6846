"""Which states lead where, whatever the probabilities: reachability and components."""

from __future__ import annotations

from collections import deque

import numpy as np

from babyrobot_levels.analysis.solver.model import Flags, Ints, Model

DENSE_STATES = 150
"""Up to so many states, components are found with plain NumPy: importing SciPy takes longer."""


def attractor(model: Model, goals: Flags, rows: Flags) -> tuple[Flags, Ints]:
    """Return which states can get to a goal by some of the actions, and how.

    Args:
        model: the states and actions.
        goals: the goals among states and the end, `[n + 1]`.
        rows: the actions that may be taken, `[n, actions]`.

    Returns:
        Which states are goals or have a chance to get to one, `[n]`; and for each of them the
        action most likely to come nearer, counted in steps, `[n]`; -1 for goals and all others.
    """
    size = model.size
    happens = (model.probability > 0) & rows[:, :, None]
    source = np.repeat(np.arange(size, dtype=np.int32), happens.sum(axis=(1, 2)))
    distance = distances(size + 1, model.next_state[happens], source, np.flatnonzero(goals))
    nearer = distance[model.next_state] < distance[:-1, None, None]
    progress = np.einsum("sao,sao->sa", model.probability, nearer)
    progress[~rows] = -1.0
    reached = distance[:-1] <= size
    return reached, np.where(reached & ~goals[:-1], progress.argmax(axis=1), -1)


def distances(size: int, source: Ints, target: Ints, roots: Ints) -> Ints:
    """Return the fewest edges from one of the roots to each node, `[size]`.

    Args:
        size: the number of nodes; one that cannot be reached is at this number plus 1.
        source: where each edge begins.
        target: where it ends.
        roots: where the ways begin.
    """
    distance = np.full(size, size + 1, np.int32)
    if size <= DENSE_STATES:
        ahead: list[list[int]] = [[] for _ in range(size)]
        for begin, end in zip(source.tolist(), target.tolist(), strict=True):
            ahead[begin].append(end)
        found = dict.fromkeys(roots.tolist(), 0)
        # A dict keeps the order in which nodes were found, which is that of their distances.
        waiting = deque(found)
        while waiting:
            node = waiting.popleft()
            for other in ahead[node]:
                if other not in found:
                    found[other] = found[node] + 1
                    waiting.append(other)
        distance[list(found)] = list(found.values())
        return distance
    from scipy.sparse import csr_array  # type: ignore[import-untyped]
    from scipy.sparse.csgraph import breadth_first_order  # type: ignore[import-untyped]

    # One more node, from which an edge leads to each root.
    begins = np.append(source, np.full(roots.size, size, source.dtype))
    weights = np.ones(begins.size, np.int8)
    graph = csr_array(
        (weights, (begins, np.append(target, roots.astype(target.dtype)))),
        shape=(size + 1, size + 1),
    )
    order, before = breadth_first_order(graph, size)
    # Each node knows the one before it: jumps of double length count the way in few rounds.
    before[size] = size
    count = np.zeros(size + 1, np.intp)
    count[order[1:]] = 1
    while (before[order] != size).any():
        count[order] += count[before[order]]
        before[order] = before[before[order]]
    distance[order[1:]] = count[order[1:]] - 1
    return distance


def surely_ending(model: Model, rows: Flags) -> tuple[Flags, Ints, Flags]:
    """Return where the end can be reached with probability one, by some of the actions.

    Returns:
        These states, `[n]`; for each an action of one policy that does it, `[n]`, -1 elsewhere;
        and the actions that lead to none but these states, `[n, actions]`.
    """
    while True:
        reached, action = attractor(model, model.end, rows)
        risky = rows & model.leads_to(np.append(~reached, False))
        if not risky.any():
            return reached, action, rows & reached[:, None]
        rows = rows & ~risky


def strong_components(size: int, source: Ints, target: Ints) -> Ints:
    """Return a label for each of `size` states: equal where each can get to the other."""
    if size <= DENSE_STATES:
        reach = np.eye(size, dtype=np.float32)
        reach[source, target] = 1.0
        for _ in range(max(1, size.bit_length())):
            reach = np.minimum(reach @ reach, 1.0)
        label: Ints = ((reach > 0) & (reach.T > 0)).argmax(axis=1)
        return label
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    graph = csr_array((np.ones(source.size, np.int8), (source, target)), shape=(size, size))
    components: Ints = connected_components(graph, connection="strong")[1].astype(np.intp)
    return components


def end_components(model: Model, rows: Flags) -> tuple[Ints, Flags]:
    """Find the largest sets of states in which the robot can go on for ever and get everywhere.

    Args:
        model: the states and actions.
        rows: the actions that may be taken, `[n, actions]`.

    Returns:
        A label for each state, -1 for those in no such set, and the actions that keep to their
        set, `[n, actions]`.
    """
    inside = rows & ~model.leads_to(model.end)
    actions, outcomes = model.probability.shape[1:]
    while True:
        edges = np.flatnonzero((model.probability > 0) & inside[:, :, None])
        source = edges // (actions * outcomes)
        label = strong_components(model.size, source, model.next_state.ravel()[edges])
        differs = label[source] != label[model.next_state.ravel()[edges]]
        if not differs.any():
            return np.where(inside.any(axis=1), label, -1), inside
        inside.ravel()[edges[differs] // outcomes] = False


def closed_classes(chain: Model) -> Ints:
    """Return a label for each state that a chain never leaves for good, -1 for all others."""
    edges = np.flatnonzero(chain.probability > 0)
    source, target = edges // chain.probability.shape[2], chain.next_state.ravel()[edges]
    inner = target < chain.size
    label = strong_components(chain.size, source[inner], target[inner])
    leaving = source[np.append(label, -1)[target] != label[source]]
    is_open = np.zeros(chain.size, bool)
    is_open[label[leaving]] = True
    return np.where(is_open[label], -1, label)
