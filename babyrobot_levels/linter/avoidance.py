"""Movers that the robot cannot avoid: by which starts and by which policies."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.mdp.graph import Graph
from babyrobot_levels.mdp.reachability import ends_by_hit
from babyrobot_levels.mdp.tables import Mdp

Flags = NDArray[np.bool_]

MAX_ROUNDS = 1_000
"""After so many rounds nothing is said."""


def unavoidable_starts(mdp: Mdp, hits: Flags, exits: Flags | None) -> list[int] | None:
    """Return the start states from which every policy that can reach an exit may be hit.

    A state is safe if some action leads from it, whatever happens, to safe states without a hit.
    A policy that is surely never hit takes such actions only; so a start is avoidable if it is
    safe and such actions lead from it to an exit.

    Args:
        mdp: the tables.
        hits: the outcomes to avoid, `[states, actions, outcomes]`.
        exits: the exits, `[states]`; None if surviving is all that counts.

    Returns:
        None if it takes too long.
    """
    happens = (mdp.probability > 0) & ~mdp.is_terminal[:, None, None]
    goes_on = happens & ~mdp.terminal
    safe: Flags = ~mdp.is_terminal
    actions = ~(hits & happens).any(axis=2) & safe[:, None]
    for _ in range(MAX_ROUNDS):
        still = actions & ~(goes_on & ~safe[mdp.next_state]).any(axis=2)
        safe_then: Flags = still.max(axis=1)
        if (safe_then == safe).all():
            break
        actions, safe = still, safe_then
    else:
        return None
    starts = np.flatnonzero(mdp.start)
    if exits is None:
        found = ~safe[starts]
    else:
        rows = happens & still[:, :, None] & ~ends_by_hit(mdp)
        states, taken, outcomes = rows.nonzero()
        back = Graph(mdp.num_states, mdp.next_state[states, taken, outcomes], states)
        found = back.distances(np.flatnonzero(exits)) < 0
        found = found[starts]
    unavoidable: list[int] = starts[found].tolist()
    return unavoidable
