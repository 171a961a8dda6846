"""What the outcomes in the exact tables mean: the event behind each of them."""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.mdp.tables import FREE, GLASS, REFUSED, Mdp


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
    target = mdp.intended_next_state[..., None]
    at_target = mdp.next_state == target
    to_a_start = target == mdp.num_states
    if to_a_start.any():
        at_target |= to_a_start & (mdp.start > 0)[mdp.next_state]
    events: NDArray[np.int8] = _EVENTS.take(at_target * _ROW + mdp.obstruction[..., None])
    return events


_ROW = np.int8(3)
_EVENTS = np.empty((2, _ROW), np.int8)
"""The events, by whether the robot ends up where the action leads, and by what hinders it."""
_EVENTS[0, [FREE, REFUSED, GLASS]] = Event.SKIDDED, Event.SKIDDED, Event.BOUNCED
_EVENTS[1, [FREE, REFUSED, GLASS]] = Event.REACHED, Event.BUMPED, Event.REACHED
