"""A policy in a level as a Markov chain, outcome by outcome: for simulating and for following."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from babyrobot_levels.analysis.solver.model import Flags, Floats, Ints
from babyrobot_levels.analysis.solver.policies import Policy, read_policy
from babyrobot_levels.analysis.solver.space import StateSpace


@dataclass(frozen=True, eq=False)
class Chain:
    """The outcomes of a policy's step from each state, `[states, outcomes]` each."""

    cumulated: Floats
    next_state: Ints
    reward: Floats
    terminal: Flags

    @cached_property
    def probability(self) -> Floats:
        """The probability of each outcome, `[states, outcomes]`."""
        return np.diff(self.cumulated, axis=1, prepend=0.0)


def chains(space: StateSpace, weights: Callable[[int], Floats]) -> Callable[[int], Chain]:
    """Return a function from a step to the chain of a policy that may depend on it."""
    last: tuple[Floats, Chain] | None = None

    def at(step: int) -> Chain:
        nonlocal last
        here = weights(step)
        if last is None or last[0] is not here:
            last = here, chain_of(space, here)
        return last[1]

    return at


def chain_of(space: StateSpace, weights: Floats) -> Chain:
    """Return the outcomes of steps with these probabilities of actions, the possible ones first."""
    first, mdp = space.first_action, space.mdp
    count = mdp.num_states
    probability = (weights[:, :, None] * mdp.probability[:, first:]).reshape(count, -1)
    order = np.argsort(probability == 0, axis=1, kind="stable")
    order = order[:, : int((probability > 0).sum(axis=1).max())]
    probability = np.take_along_axis(probability, order, axis=1)
    next_state = mdp.next_state[:, first:].reshape(count, -1)
    reward = mdp.reward[:, first:].reshape(count, -1)
    terminal = mdp.terminal[:, first:].reshape(count, -1)
    cumulated = np.cumsum(probability, axis=1)
    # Rounding must not leave a gap at the top: the last possible outcome takes what is left.
    last = np.maximum((probability > 0).sum(axis=1) - 1, 0)
    cumulated[np.arange(probability.shape[1]) >= last[:, None]] = 1.0
    return Chain(
        cumulated,
        np.take_along_axis(next_state, order, axis=1).astype(np.intp),
        np.take_along_axis(reward, order, axis=1),
        np.take_along_axis(terminal, order, axis=1),
    )


def weights_of(policy: Policy, space: StateSpace) -> Floats:
    """Return a policy as probabilities, `[states, actions]`."""
    return read_policy(policy, space.mdp, space.actions, space.level.things())
