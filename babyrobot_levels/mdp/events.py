"""What the outcomes in the exact tables mean: the event behind each of them."""

from __future__ import annotations

from collections.abc import Iterator
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


ALL = slice(None)


def events_of(mdp: Mdp, states: slice = ALL) -> NDArray[np.int8]:
    """Return the `Event` of each outcome, int8 `[states, actions, outcomes]`.

    Only the robot's cell counts, not what happens to things. The events of padding, outcomes of
    probability 0, mean nothing.

    Args:
        mdp: the tables.
        states: the states whose outcomes are told.
    """
    target = mdp.intended_next_state[states, :, None]
    to_a_start = target == mdp.num_states
    starts: NDArray[np.bool_] = mdp.start > 0
    next_cell = mdp.next_state[states]
    if mdp.num_states > mdp.cells:
        starts = np.logical_or.reduce(starts.reshape(-1, mdp.cells))
        next_cell, target = next_cell % mdp.cells, target % mdp.cells
    at_target = next_cell == target
    if to_a_start.any():
        at_target = np.where(to_a_start, starts[next_cell], at_target)
    events: NDArray[np.int8] = _EVENTS.take(at_target * _ROW + mdp.obstruction[states, :, None])
    return events


def hits_of(world: GridWorld, mdp: Mdp, states: slice = ALL) -> NDArray[np.bool_]:
    """Return which outcomes are hits, bool `[states, actions, outcomes]`.

    A mover hits the robot if they stand in one cell after the step, or have changed places in it.
    There are no hits where the episode is over. Those of padding mean nothing.

    Args:
        world: the level.
        mdp: its tables, with or without turning.
        states: the states whose outcomes are told.
    """
    hits = np.zeros(mdp.next_state[states].shape, np.bool_)
    for by_mover in hits_by_mover(world, mdp, states):
        hits |= by_mover
    return hits


def hits_by_mover(world: GridWorld, mdp: Mdp, states: slice = ALL) -> Iterator[NDArray[np.bool_]]:
    """Yield the hits of each mover in turn; see `hits_of`."""
    if not world.movers:
        return
    next_state = mdp.next_state[states]
    state = np.arange(mdp.num_states)[states, None, None]
    here, there = state % mdp.cells, next_state % mdp.cells
    before, after = (number // (mdp.cells * mdp.headings) for number in (state, next_state))
    values = mdp.configurations[:, world.things().static :]
    for mover, phase in zip(world.movers, values.T, strict=True):
        cells = np.array([y * mdp.width + x for x, y in mover.phases])[phase]
        was, now = cells[before], cells[after]
        hits = (now == there) | ((now == here) & (was == there) & (here != there))
        hits[mdp.is_terminal[states]] = False
        yield hits


_ROW = np.int8(3)
_EVENTS = np.empty((2, _ROW), np.int8)
"""The events, by whether the robot ends up where the action leads, and by what hinders it."""
_EVENTS[0, [FREE, REFUSED, GLASS]] = Event.SKIDDED, Event.SKIDDED, Event.BOUNCED
_EVENTS[1, [FREE, REFUSED, GLASS]] = Event.REACHED, Event.BUMPED, Event.REACHED
