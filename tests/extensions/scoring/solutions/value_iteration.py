"""What a student hands in: value iteration."""

from __future__ import annotations

from typing import Any

import numpy as np


def ahead(level: Any, values: Any) -> Any:
    """Return the action values for state values, `[states, actions]`."""
    mdp = level.compile()
    following = np.where(mdp.terminal, 0.0, values[mdp.next_state])
    return (mdp.probability * (mdp.reward + level.discount * following)).sum(axis=-1)


def value_iteration(level: Any) -> Any:
    """Return the optimal values."""
    mdp = level.compile()
    values, change = np.zeros(mdp.num_states), 1.0
    while change > 1e-6:
        before, values = values, np.where(mdp.is_terminal, 0.0, ahead(level, values).max(axis=1))
        change = np.abs(values - before).max()
    return values.reshape(mdp.shape)
