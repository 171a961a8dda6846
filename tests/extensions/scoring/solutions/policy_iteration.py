"""What a student hands in: policy iteration, from actions towards the end."""

from __future__ import annotations

from typing import Any

import numpy as np
from value_iteration import ahead


def towards_the_end(mdp: Any) -> Any:
    """Return a policy that ends its episodes wherever one can, by steps backwards from the end."""
    policy, done = np.zeros(mdp.num_states, int), mdp.is_terminal.copy()
    for _ in range(mdp.num_states):
        happens = mdp.probability > 0
        nearer = (happens & (mdp.terminal | done[mdp.next_state])).any(axis=-1)
        new = nearer.any(axis=1) & ~done
        policy[new] = nearer[new].argmax(axis=1)
        done |= new
    return policy


def policy_iteration(level: Any) -> Any:
    """Return an optimal policy."""
    mdp = level.compile()
    policy, states = towards_the_end(mdp), np.arange(mdp.num_states)
    while True:
        values = np.zeros(mdp.num_states)
        for _ in range(1000):
            values = np.where(mdp.is_terminal, 0.0, ahead(level, values)[states, policy])
        found = ahead(level, values)
        better = found.max(axis=1) > values + 1e-9
        if not (better & ~mdp.is_terminal).any():
            return policy.reshape(mdp.shape)
        policy = np.where(better, found.argmax(axis=1), policy)
