"""Agents without memory as tables: what they do in every state of a level."""

from __future__ import annotations

import numpy as np

from babyrobot_levels.analysis.solver.policies import StateSpace
from babyrobot_levels.analysis.solver.within import ByStep, weights_by_step
from babyrobot_levels.envs.observations.base import Observer
from babyrobot_levels.scoring.agents import Chooser, Table

BATCH = 4096
"""The most observations that an agent is asked about at once."""


def policy_of(
    agent: Table | Chooser, space: StateSpace, observer: Observer, limit: int | None
) -> ByStep:
    """Return what an agent does in each state, and in each step if it takes that into account.

    Args:
        agent: an agent without memory.
        space: the states of the level.
        observer: makes the observations of the level.
        limit: the number of steps after which episodes are truncated; None for no limit.

    Raises:
        ValueError: its answers are no actions, or no probabilities that add up to 1; or it is a
            policy for another limit.
    """
    if isinstance(agent, Table):
        policy = agent.of(space.level.name, space.level.digest)
        return weights_by_step(policy, space, limit)
    mdp, first = space.mdp, space.first_action
    states = np.flatnonzero(~mdp.is_terminal & ~space.without_value)
    table = np.zeros((mdp.num_states, mdp.num_actions - first))
    # Where no episode comes, any action will do.
    table[:, 0] = 1.0
    for begin in range(0, states.size, BATCH):
        part = states[begin : begin + BATCH]
        seen = observer.rows(part)
        table[part] = agent(seen, mdp.action_mask[part, first:].astype(np.int8))
    return weights_by_step(table, space, limit)
