"""Which states lead where, whatever the probabilities: reachability and components."""

from __future__ import annotations

import numpy as np

from babyrobot_levels.analysis.solver.model import Flags, Ints, Model
from babyrobot_levels.mdp.graph import Graph

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
    # Edges reversed: from each next state to the state before it.
    graph = Graph(size + 1, model.next_state[happens], source)
    distance = graph.distances(np.flatnonzero(goals).tolist())
    distance[distance < 0] = size + 2
    nearer = distance[model.next_state] < distance[:-1, None, None]
    progress = np.einsum("sao,sao->sa", model.probability, nearer)
    progress[~rows] = -1.0
    reached = distance[:-1] <= size
    return reached, np.where(reached & ~goals[:-1], progress.argmax(axis=1), -1)


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
    from scipy.sparse import csr_array  # type: ignore[import-untyped]
    from scipy.sparse.csgraph import connected_components  # type: ignore[import-untyped]

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
