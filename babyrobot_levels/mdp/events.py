"""What the outcomes in the exact tables mean: the event behind each of them."""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.mdp.tables import FREE, GLASS, REFUSED, Mdp

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld


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

    Only the robot's cell counts, not what happens to things. The events of padding, outcomes of
    probability 0, mean nothing.
    """
    target = mdp.intended_next_state[..., None]
    to_a_start = target == mdp.num_states
    starts: NDArray[np.bool_] = mdp.start > 0
    next_cell = mdp.next_state
    if mdp.num_states > mdp.cells:
        starts = np.logical_or.reduce(starts.reshape(-1, mdp.cells))
        next_cell, target = next_cell % mdp.cells, target % mdp.cells
    at_target = next_cell == target
    if to_a_start.any():
        at_target = np.where(to_a_start, starts[next_cell], at_target)
    events: NDArray[np.int8] = _EVENTS.take(at_target * _ROW + mdp.obstruction[..., None])
    return events


def hits_of(world: GridWorld, mdp: Mdp) -> NDArray[np.bool_]:
    """Return which outcomes are hits, bool `[states, actions, outcomes]`.

    A mover hits the robot if they stand in one cell after the step, or have changed places in it.
    There are no hits where the episode is over. Those of padding mean nothing.

    Args:
        world: the level.
        mdp: its tables, with or without turning.
    """
    hits = np.zeros(mdp.next_state.shape, np.bool_)
    if not world.movers:
        return hits
    here = (np.arange(mdp.num_states) % mdp.cells)[:, None, None]
    there = mdp.next_state % mdp.cells
    before = (np.arange(mdp.num_states) // (mdp.cells * mdp.headings))[:, None, None]
    after = mdp.next_state // (mdp.cells * mdp.headings)
    values = mdp.configurations[:, world.things().static :]
    for mover, phase in zip(world.movers, values.T, strict=True):
        cells = np.array([y * mdp.width + x for x, y in mover.phases])[phase]
        was, now = cells[before], cells[after]
        hits |= (now == there) | ((now == here) & (was == there) & (here != there))
    hits[mdp.is_terminal] = False
    return hits


_ROW = np.int8(3)
_EVENTS = np.empty((2, _ROW), np.int8)
"""The events, by whether the robot ends up where the action leads, and by what hinders it."""
_EVENTS[0, [FREE, REFUSED, GLASS]] = Event.SKIDDED, Event.SKIDDED, Event.BOUNCED
_EVENTS[1, [FREE, REFUSED, GLASS]] = Event.REACHED, Event.BUMPED, Event.REACHED
