"""Values of levels by other means than the solver's: value iteration, and trying all policies."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.mdp.tables import Mdp

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


def dense(mdp: Mdp, first_action: int) -> tuple[Floats, Floats]:
    """Return `[actions, states + 1, states + 1]` probabilities and `[actions, states + 1]` expected
    rewards, read outcome by outcome. The last state is where all episodes end.
    """
    size, actions = mdp.num_states + 1, 5 - first_action
    steps, rewards = np.zeros((actions, size, size)), np.zeros((actions, size))
    steps[:, -1, -1] = 1.0
    for state in range(mdp.num_states):
        for action in range(actions):
            if mdp.is_terminal[state]:
                steps[action, state, -1] = 1.0
                continue
            for probability, goal, reward, over in mdp.outcomes(state, action + first_action):
                steps[action, state, size - 1 if over else goal] += probability
                rewards[action, state] += probability * reward
    return steps, rewards


def value_iteration(steps: Floats, rewards: Floats, discount: float) -> Floats:
    """Return optimal values `[states + 1]`, to the last digit."""
    values = np.zeros(steps.shape[1])
    for _ in range(100_000):
        ahead: Floats = (rewards + discount * steps @ values).max(axis=0)
        if np.abs(ahead - values).max() <= 1e-14 * (1 + np.abs(values).max()):
            return ahead
        values = ahead
    raise AssertionError("value iteration has not come to an end")


def all_totals(steps: Floats, rewards: Floats, states: list[int]) -> tuple[Floats, Flags]:
    """Return the undiscounted values of all policies, and where they are unclear.

    Args:
        steps: as `dense` returns it.
        rewards: as `dense` returns it.
        states: the states in which a policy has a choice.

    Returns:
        Values `[policies, len(states)]`, which may be infinite, and flags of the same shape: from
        there a policy may come into a loop in which rewards cancel out.
    """
    keep = [*states, steps.shape[1] - 1]
    choices = np.array(list(product(range(steps.shape[0]), repeat=len(states))))
    choices = np.concatenate([choices, np.zeros((len(choices), 1), int)], axis=1)
    rows = np.arange(len(keep))
    chains = steps[:, keep][:, :, keep][choices, rows]
    # What leads to other states leads to where the episode is over.
    chains[:, :, -1] += 1.0 - chains.sum(axis=2)
    reward = rewards[:, keep][choices, rows]
    # A lazy chain stays half of the time: it has the same averages, and surely a limit.
    limit = (chains + np.eye(len(keep))) / 2
    for _ in range(50):
        limit = limit @ limit
        limit /= limit.sum(axis=2, keepdims=True)
    limit[limit < 1e-12] = 0.0
    gain = (limit @ reward[:, :, None])[:, :, 0]
    gain[np.abs(gain) < 1e-9] = 0.0
    recurrent = np.einsum("pss->ps", limit) > 0
    may_come = limit > 0
    cancels = recurrent & (gain == 0) & (np.abs(reward) > 1e-12)
    settled = np.where(recurrent, 0.0, reward)
    values = np.linalg.solve(np.eye(len(keep)) - chains + limit, settled[:, :, None])[:, :, 0]

    def reaches(flags: Flags) -> Flags:
        return np.asarray((may_come & flags[:, None, :]).any(axis=2), bool)

    values[reaches(recurrent & (gain < 0))] = -np.inf
    values[reaches(recurrent & (gain > 0))] = np.inf
    return values[:, :-1], reaches(cancels)[:, :-1]


def states_of(mdp: Mdp) -> list[int]:
    """Return the states in which an episode goes on."""
    return [int(state) for state in np.flatnonzero(~mdp.is_terminal)]


def world(*, rows: list[str], **fields: Any) -> dict[str, Any]:
    """Return a level without walls: `S` starts, `E` exits, `X` cells that end, `#` blocked ones."""
    cells = {(x, y): mark for y, row in enumerate(rows) for x, mark in enumerate(row)}

    def at(mark: str) -> list[list[int]]:
        return [list(cell) for cell, found in cells.items() if found == mark]

    areas = [{"at": cell, "ends": True} for cell in at("X")]
    return {
        "version": 1,
        "size": [len(rows[0]), len(rows)],
        "start": at("S"),
        "exit": at("E") or "none",
        "blocked": [{"at": cell} for cell in at("#")],
        **fields,
        "areas": areas + fields.get("areas", []),
    }
