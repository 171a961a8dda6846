"""The model that solving works on: non-terminal states, one more for the end, and its graph."""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.analysis.solver.compiled import is_compiled
from babyrobot_levels.mdp.graph import Graph
from babyrobot_levels.mdp.tables import Flags, Floats, Ints, Mdp

DENSE_STATES = 150
"""Up to so many states, components are found with plain NumPy: importing SciPy takes longer."""


MAX_REWARD = 1e140
"""Of larger rewards, the squares of sums over many steps may be beyond floating point."""


@dataclass(frozen=True, eq=False)
class Model:
    """A decision process over `n` states, numbered from 0; number `n` stands for the end.

    The end has value 0. A model with a single action is a Markov chain.

    Attributes:
        states: the level's numbers of the states, `[n]`.
        probability: `[n, actions, outcomes]`.
        next_state: int32, `[n, actions, outcomes]`; outcomes of probability 0 lead to the end.
        reward: the expected reward, `[n, actions]`; -inf for actions that may not be taken.
        success: the probability that a step leads onto an exit, `[n, actions]`.
    """

    states: Ints
    probability: Floats
    next_state: NDArray[np.int32]
    reward: Floats
    success: Floats

    @property
    def size(self) -> int:
        """The number of states, without the end."""
        return self.states.size

    @cached_property
    def allowed(self) -> Flags:
        """Which actions may be taken, `[n, actions]`."""
        return np.asarray(self.reward > -np.inf, bool)

    @cached_property
    def ending(self) -> Floats:
        """How likely actions end the episode, `[n, actions]`."""
        return self.chances(self.end)

    @cached_property
    def inner(self) -> Flags:
        """Which of them have no chance to end the episode, `[n, actions]`."""
        return np.asarray(self.allowed & (self.ending == 0), bool)

    @cached_property
    def order(self) -> tuple[NDArray[np.int32], NDArray[np.int32], int]:
        """What the compiled `distances` to the end by all actions returns."""
        from babyrobot_levels.analysis.solver.compiled.rows import distances

        return distances(*kernel_arrays(self), self.allowed, self.end)

    @cached_property
    def end(self) -> Flags:
        """Flags for states and the end, `[n + 1]`, of which only the end's is set."""
        return np.append(np.zeros(self.size, bool), True)

    def leads_to(self, goals: Flags) -> Flags:
        """Return which actions have a chance to lead to one of the goals (`[n + 1]`)."""
        return self.chances(goals) > 0

    def chances(self, goals: Flags) -> Floats:
        """Return how likely actions lead to one of the goals (`[n + 1]`), `[n, actions]`."""
        if is_compiled(self.size):
            from babyrobot_levels.analysis.solver.compiled import tables

            return tables.chances(*kernel_arrays(self), goals)
        hits = np.flatnonzero(goals[self.next_state])
        chance = self.probability.ravel()[hits]
        likely = np.bincount(hits // self.probability.shape[2], chance, self.reward.size)
        # Of no hits, it makes a table of whole numbers.
        return np.asarray(likely, np.float64).reshape(self.reward.shape)

    def action_values(self, values: Floats, discount: float) -> Floats:
        """Return the action values, `[n, actions]`, for finite state values `[n]`."""
        known = np.append(values, 0.0)
        if is_compiled(self.size):
            from babyrobot_levels.analysis.solver.compiled import tables

            reward = np.ascontiguousarray(self.reward)
            return tables.action_values(*kernel_arrays(self), reward, known, discount)
        following = known[self.next_state]
        ahead: Floats = np.einsum("sao,sao->sa", self.probability, following)
        return self.reward + discount * ahead

    def with_rewards(self, reward: Floats) -> Model:
        """Return the model with other rewards, and so perhaps with fewer actions."""
        made = replace(self, reward=reward)
        # What may happen does not depend on them.
        vars(made).update({name: vars(self)[name] for name in vars(self).keys() & {"ending"}})
        return made

    def with_stops(self, stops: Flags) -> Model:
        """Return the model with one more, last action: to stop for nothing, in some states.

        Where there are no such states, it is the model as it is.
        """
        if not stops.any():
            return self
        size, _, outcomes = self.probability.shape
        stop = np.zeros((size, 1, outcomes))
        stop[:, :, 0] = 1.0
        return Model(
            self.states,
            np.concatenate([self.probability, stop], axis=1),
            np.concatenate(
                [self.next_state, np.full(stop.shape, size, self.next_state.dtype)], axis=1
            ),
            np.concatenate([self.reward, np.where(stops, 0.0, -np.inf)[:, None]], axis=1),
            np.concatenate([self.success, np.zeros((size, 1))], axis=1),
        )

    def restrict(self, keep: Flags, rows: Flags | None = None) -> Model:
        """Return the model of some of the states. What leads to others leads to the end.

        Args:
            keep: the states that are kept, `[n]`.
            rows: the actions that may be taken, `[n, actions]`; by default, those that may be now.
        """
        if keep.all():
            if rows is None or rows is self.allowed or np.array_equal(rows, self.allowed):
                return self
            return self.with_rewards(np.where(rows, self.reward, -np.inf))
        count = int(keep.sum())
        number = np.full(self.size + 1, count, self.next_state.dtype)
        number[:-1][keep] = np.arange(count)
        reward = self.reward if rows is None else np.where(rows, self.reward, -np.inf)
        return Model(
            self.states[keep],
            self.probability[keep],
            number[self.next_state[keep]],
            reward[keep],
            self.success[keep],
        )

    def under(self, policy: Ints) -> Model:
        """Return the chain of a policy: an action for each state, `[n]`."""
        rows = np.arange(self.size)[:, None], policy[:, None]
        return Model(
            self.states,
            self.probability[rows],
            self.next_state[rows],
            self.reward[rows],
            self.success[rows],
        )

    def mixed(self, weights: Floats) -> Model:
        """Return the chain of a policy: a probability for each action, `[n, actions]`."""
        probability = (weights[:, :, None] * self.probability).reshape(self.size, -1)
        next_state = self.next_state.reshape(self.size, -1)
        # The possible outcomes to the front: most policies leave few of them.
        order = np.argsort(probability == 0, axis=1, kind="stable")
        order = order[:, : int((probability > 0).sum(axis=1).max(initial=1))]
        return Model(
            self.states,
            np.take_along_axis(probability, order, axis=1)[:, None],
            np.take_along_axis(next_state, order, axis=1)[:, None],
            (weights * self.reward).sum(axis=1, keepdims=True),
            (weights * self.success).sum(axis=1, keepdims=True),
        )


@dataclass(frozen=True, eq=False)
class Core:
    """The states of a model with finite values, and the actions that matter there.

    Attributes:
        model: these states; its last action may be to stop in a loop that costs nothing.
        inside: their numbers in the whole model, `[n]`.
        policy: an optimal policy, `[n]`.
    """

    model: Model
    inside: Ints
    policy: Ints


def build_model(mdp: Mdp, exits: Flags, first_action: int) -> Model:
    """Return the model of a level's tables.

    Args:
        mdp: the tables.
        exits: in which states the robot stands on an open exit, `[states]`.
        first_action: the action that becomes number 0: 1 leaves `stay` out.
    """
    states = np.flatnonzero(~mdp.is_terminal)
    number = np.full(mdp.num_states, states.size, np.int32)
    number[states] = np.arange(states.size)
    # Where nothing lies between them, the tables need no copy.
    rows = places(states)
    probability = mdp.probability[rows, first_action:]
    if is_compiled(states.size):
        from babyrobot_levels.analysis.solver.compiled import tables

        given = mdp.probability, mdp.next_state, mdp.reward, mdp.terminal
        made = tables.of_model(states, number, exits, *given, first_action)
        model = Model(states, np.ascontiguousarray(probability), *made[:3])
        vars(model)["ending"] = made[3]
        return model
    following = mdp.next_state[rows, first_action:]
    ends = mdp.terminal[rows, first_action:]
    return Model(
        states,
        probability,
        np.where((probability > 0) & ~ends, number[following], np.int32(states.size)),
        np.einsum("sao,sao->sa", probability, mdp.reward[rows, first_action:]),
        np.einsum("sao,sao->sa", probability, (exits[following] & ends).astype(np.float64)),
    )


def places(states: Ints) -> Ints | slice:
    """Return what picks some states, which rise: a slice where nothing lies between them."""
    is_whole = states.size > 0 and states[-1] - states[0] + 1 == states.size
    return slice(states[0], states[-1] + 1) if is_whole else states


def largest_reward(mdp: Mdp) -> float:
    """Return the largest reward of a step, or cost, of a level's tables."""
    return float(max(mdp.reward.max(initial=0.0), -mdp.reward.min(initial=0.0)))


def too_large_to_add_up(largest: float) -> str | None:
    """Return why such rewards cannot be added up, in words; None if they can."""
    if largest <= MAX_REWARD:
        return None
    return f"rewards of up to {largest:g} are too large to add up; use at most {MAX_REWARD:g}"


# -- which states lead where, whatever the probabilities ------------------------------------


def kernel_arrays(model: Model) -> tuple[NDArray[np.int32], Floats]:
    """Return where each outcome leads and how likely it is, laid out as compiled loops want it."""
    return np.ascontiguousarray(model.next_state), np.ascontiguousarray(model.probability)


def distances(model: Model, goals: Flags, rows: Flags) -> NDArray[np.int32]:
    """Return how many steps a goal is away at least, `[n + 1]`; -1 where none can be reached."""
    if is_compiled(model.size):
        if goals is model.end and rows is model.allowed:
            return model.order[0]
        from babyrobot_levels.analysis.solver.compiled.rows import distances as compiled

        return compiled(*kernel_arrays(model), rows, goals)[0]
    happens = (model.probability > 0) & rows[:, :, None]
    source = np.repeat(np.arange(model.size, dtype=np.int32), happens.sum(axis=(1, 2)))
    # Edges reversed: from each next state to the state before it.
    graph = Graph(model.size + 1, model.next_state[happens], source)
    return graph.distances(np.flatnonzero(goals))


def attractor(model: Model, goals: Flags, rows: Flags) -> tuple[Flags, Ints]:
    """Return which states can reach a goal by some of the actions, and how.

    Args:
        model: the states and actions.
        goals: the goals among states and the end, `[n + 1]`.
        rows: the actions that may be taken, `[n, actions]`.

    Returns:
        Which states are goals or have a chance to reach one, `[n]`; and for each of them the
        action most likely to come nearer, counted in steps, `[n]`; -1 for goals and all others.
    """
    size, distance = model.size, distances(model, goals, rows)
    if is_compiled(size):
        from babyrobot_levels.analysis.solver.compiled import tables

        return distance[:-1] >= 0, tables.nearer(*kernel_arrays(model), rows, distance)
    distance[distance < 0] = size + 2
    nearer = distance[model.next_state] < distance[:-1, None, None]
    progress = np.einsum("sao,sao->sa", model.probability, nearer)
    progress[~rows] = -1.0
    reached = distance[:-1] <= size
    return reached, np.where(reached & ~goals[:-1], progress.argmax(axis=1), -1)


def surely_ending(model: Model, rows: Flags) -> tuple[Flags, Flags]:
    """Return where the end can be reached with probability one, by some of the actions.

    Returns:
        These states, `[n]`, and the actions that lead to none but these states, `[n, actions]`.
    """
    distance = distances(model, model.end, rows)
    if is_compiled(model.size):
        from babyrobot_levels.analysis.solver.compiled import tables

        rows, distance = tables.surely(*kernel_arrays(model), rows, distance)
        return distance[:-1] >= 0, rows
    while True:
        lost = distance < 0
        risky = rows & model.leads_to(lost) if lost.any() else lost
        if not risky.any():
            return ~lost[:-1], rows & ~lost[:-1, None]
        rows = rows & ~risky
        distance = distances(model, model.end, rows)


def going_on(model: Model, rows: Flags) -> Flags:
    """Return those of some actions that never lead to where there are none of them."""
    if is_compiled(model.size):
        from babyrobot_levels.analysis.solver.compiled import tables

        return tables.going_on(*kernel_arrays(model), rows)
    while True:
        risky = rows & model.leads_to(np.append(~rows.any(axis=1), False))
        if not risky.any():
            return rows
        rows = rows & ~risky


def strong_components(size: int, source: Ints, target: Ints) -> Ints:
    """Return a label for each of `size` states: equal where each can reach the other.

    Args:
        size: how many states there are.
        source: where each edge begins, in rising order.
        target: where it ends.
    """
    if size <= DENSE_STATES and "scipy.sparse" not in sys.modules:
        reach = np.eye(size, dtype=np.float32)
        reach[source, target] = 1.0
        for _ in range(max(1, size.bit_length())):
            reach = np.minimum(reach @ reach, 1.0)
        label: Ints = ((reach > 0) & (reach.T > 0)).argmax(axis=1)
        return label
    from scipy.sparse import csr_array  # type: ignore[import-untyped]
    from scipy.sparse.csgraph import connected_components  # type: ignore[import-untyped]

    first = np.append(0, np.cumsum(np.bincount(source, minlength=size)))
    edges = np.ones(source.size), target.astype(np.int32), first
    graph = csr_array(edges, shape=(size, size))
    # Of an edge that is there twice, SciPy makes no end.
    graph.sum_duplicates()
    _, named, number = np.unique(
        connected_components(graph, connection="strong")[1], return_index=True, return_inverse=True
    )
    # Each is named by its first state, as above: results must not depend on what is imported.
    components: Ints = named[number]
    return components


def end_components(model: Model, rows: Flags) -> tuple[Ints, Flags]:
    """Find the maximal end components: where an episode can go on for ever and reach each state.

    Args:
        model: the states and actions.
        rows: the actions that may be taken, `[n, actions]`.

    Returns:
        A label for each state, -1 for those in no such set, and the actions that keep to their
        set, `[n, actions]`.
    """
    inside = rows & ~model.leads_to(model.end)
    actions, outcomes = model.probability.shape[1:]
    elsewhere = model.next_state != np.arange(model.size)[:, None, None]
    still = inside & ~((model.probability > 0) & elsewhere).any(axis=2)
    while True:
        # Most actions go this way, at once, and not layer by layer as components are found again.
        inside = still | going_on(model, inside & ~still)
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
