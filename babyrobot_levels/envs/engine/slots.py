"""Tables with slots, for levels that come and go while robots walk."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from babyrobot_levels.envs.engine.tables import ALWAYS, Outcomes, Tables, words_of
from babyrobot_levels.mdp.actions import NUM_ACTIONS
from babyrobot_levels.mdp.tables import Mdp


@dataclass(frozen=True, slots=True)
class Span:
    """Where the part of a slot is in arrays of states, of rows and so on."""

    states: slice
    rows: slice
    chances: slice
    outcomes: slice
    starts: slice


@dataclass(frozen=True, slots=True)
class Room:
    """What there is room for.

    Attributes:
        slots: how many levels.
        states: how many states in each of them.
        starts: how many starts each of them has.
        chances: how many rows of a level may leave something to chance.
        outcomes: how many outcomes such a row may have.
    """

    slots: int
    states: int
    starts: int
    chances: int = 1
    outcomes: int = 2

    def span(self, slot: int, num_actions: int) -> Span:
        """Return where a slot's part is in the tables."""
        rest = self.slots * self.states * num_actions
        return Span(
            states=_part(slot, self.states),
            rows=_part(slot, self.states * num_actions),
            chances=_part(slot, self.chances),
            outcomes=_part(slot, self.chances * self.outcomes, rest + 1),
            starts=_part(slot, self.starts),
        )


def _part(slot: int, size: int, base: int = 0) -> slice:
    return slice(base + slot * size, base + (slot + 1) * size)


def empty_tables(room: Room, first_action: int, limit: int) -> Tables:
    """Return tables whose slots are filled by `write_level`.

    They always have room for chance, so that how much a step draws at most never changes.

    Args:
        room: what there is room for.
        first_action: the action that becomes number 0: 1 leaves `stay` out.
        limit: after how many steps episodes are cut off.
    """
    num_actions = NUM_ACTIONS - first_action
    num_states = room.slots * room.states
    rest, chances = num_states * num_actions, room.slots * room.chances
    num_outcomes = rest + 1 + chances * room.outcomes
    return Tables(
        num_actions=num_actions,
        next_state=np.zeros(num_outcomes, np.intp),
        reward=np.zeros(num_outcomes),
        arrival=np.zeros(num_outcomes, np.uint64),
        chance=np.full(rest + 1, -1, np.intp),
        first=rest + 1 + room.outcomes * np.arange(chances, dtype=np.intp),
        threshold=np.full((chances, room.outcomes), ALWAYS),
        over=np.zeros(num_states, np.bool_),
        standing=np.zeros(num_states, np.uint64),
        offset=room.states * np.arange(room.slots + 1, dtype=np.intp),
        starts=np.zeros(room.slots * room.starts, np.intp),
        first_start=room.starts * np.arange(room.slots + 1, dtype=np.intp),
        limit=np.full(room.slots, limit, np.int64),
        draws_levels=False,
    )


def needed(outcomes: Outcomes) -> tuple[int, int]:
    """Return how many rows of a level leave something to chance, and their most outcomes."""
    return int(np.count_nonzero(outcomes.count > 1)), outcomes.threshold.shape[1]


def write_level(tables: Tables, span: Span, mdp: Mdp, outcomes: Outcomes) -> None:
    """Write a level into a slot.

    Args:
        tables: those of `empty_tables`.
        span: where the slot's part is.
        mdp: the level's exact tables.
        outcomes: its outcomes, for which there must be room.
    """
    base, num_rows = span.states.start, outcomes.count.size
    is_chancy = outcomes.count > 1
    count, width = int(np.count_nonzero(is_chancy)), outcomes.threshold.shape[1]
    threshold = tables.threshold[span.chances]
    for name, column in outcomes.columns.items():
        array = getattr(tables, name)
        shift = base if name == "next_state" else 0
        array[span.rows][:num_rows] = column[:, 0] + shift
        if count:
            further = array[span.outcomes].reshape(threshold.shape)
            further[:count, :width] = column[is_chancy] + shift
    chance = tables.chance[span.rows]
    chance.fill(-1)
    chance[:num_rows][is_chancy] = np.arange(span.chances.start, span.chances.start + count)
    threshold.fill(ALWAYS)
    threshold[:count, :width] = outcomes.threshold[is_chancy]
    tables.over[span.states][: mdp.num_states] = mdp.over
    first_action = NUM_ACTIONS - tables.num_actions
    standing = words_of(mdp.possible[:, first_action:])
    tables.standing[span.states][: mdp.num_states] = standing
    tables.starts[span.starts] = np.flatnonzero(mdp.start) + base
