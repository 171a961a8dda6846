"""What the outcomes in the exact tables mean: the event behind each of them."""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.mdp.tables import GLASS, REFUSED, Mdp


class Event(IntEnum):
    """What happens to the robot in an outcome of an action."""

    REACHED = 0
    """It ends up where the action leads without chance."""
    BUMPED = 1
    """A wall refuses the move, and it stays."""
    SKIDDED = 2
    """Chance takes it somewhere else."""
    BOUNCED = 3
    """A wall of glass does not let it through."""


def events_of(mdp: Mdp) -> NDArray[np.int8]:
    """Return the `Event` of each outcome, int8 `[states, actions, outcomes]`.

    The events of padding, outcomes of probability 0, mean nothing.
    """
    target, hindered = mdp.target[..., None], mdp.hindered[..., None]
    at_target = mdp.next_state == target
    to_a_start = target == mdp.num_states
    if to_a_start.any():
        at_target |= to_a_start & (mdp.start > 0)[mdp.next_state]
    events = np.where(at_target, np.int8(Event.REACHED), np.int8(Event.SKIDDED))
    events[at_target & (hindered == REFUSED)] = Event.BUMPED
    events[~at_target & (hindered == GLASS)] = Event.BOUNCED
    return events
