"""The tables that stepping reads: the outcomes of all levels as flat arrays, one look-up a step.

`build_tables` makes them for levels that stay; `empty_tables` and `write_level` for levels that are
replaced by others while environments run, each in a slot of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.mdp.actions import NUM_ACTIONS
from babyrobot_levels.mdp.events import Event, events_of
from babyrobot_levels.mdp.tables import Mdp

Ints = NDArray[np.intp]
Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Words = NDArray[np.uint64]


def info_dtype(num_actions: int) -> np.dtype[np.void]:
    """Return the dtype of an info word: the info of a step, in eight bytes that move as one.

    `mask`, int8 `[actions]`: the action mask of the state; `reached` and `skidded`, bool: whether
    the outcome was `Event.REACHED` or `Event.SKIDDED`.
    """
    return np.dtype(
        {
            "names": ["mask", "reached", "skidded"],
            "formats": [(np.int8, (num_actions,)), np.bool_, np.bool_],
            "offsets": [0, 6, 7],
            "itemsize": 8,
        }
    )


def masks_at(state_info: Words, states: Ints, num_actions: int) -> NDArray[np.int8]:
    """Return the action masks of states, int8 `[states, num_actions]`, as a new array.

    Args:
        state_info: the attribute of `Tables`.
        states: the states, in the numbering of the tables.
        num_actions: how many actions there are.
    """
    masks: NDArray[np.int8] = state_info.take(states).view(info_dtype(num_actions))["mask"]
    return masks


ALWAYS = 2.0
"""A threshold that no draw reaches."""

NO_LIMIT = 2**62
"""A number of steps that no episode reaches."""


@dataclass(frozen=True, eq=False)
class Tables:
    """Levels as engines read them, one after the other.

    A state here is the state in its level, `y * width + x`, plus the level's `offset`. Stepping
    looks up row `state * num_actions + action`. Where an action has one outcome, the outcome has
    the row's number. Where it has several, `stochastic` gives the number of the stochastic row;
    its outcomes follow one another from `first[number]` on, and a draw selects the first one for
    which `threshold[number]` is above it. One more row, `idle_row`, is for environments that do not
    act in a step.

    Attributes:
        num_actions: how many actions there are, 5 or, without stay, 4.
        next_state: intp `[outcomes]`.
        reward: float64 `[outcomes]`.
        outcome_info: uint64 `[outcomes]`: the info word after this outcome.
        stochastic: intp `[rows]`: the number of the stochastic row, -1 for a deterministic row.
        first: intp `[stochastic rows]`.
        threshold: float64 `[stochastic rows, most outcomes]`: cumulated probabilities, `ALWAYS`
            from a row's last outcome on.
        is_terminal: bool `[states]`.
        state_info: uint64 `[states]`: the info word at reset, which has the action mask alone.
        offset: intp `[levels + 1]`: where each level's states begin.
        starts: intp `[starts]`: the start states, level by level.
        first_start: intp `[levels + 1]`: where each level's starts begin.
        limit: int64 `[levels]`: the time limit of episodes, in steps.
        draws_levels: whether each episode draws its level.
    """

    num_actions: int
    next_state: Ints
    reward: Floats
    outcome_info: Words
    stochastic: Ints
    first: Ints
    threshold: Floats
    is_terminal: Flags
    state_info: Words
    offset: Ints
    starts: Ints
    first_start: Ints
    limit: NDArray[np.int64]
    draws_levels: bool

    @property
    def idle_row(self) -> int:
        """The row in which nothing happens."""
        return self.stochastic.size - 1

    @property
    def draws_starts(self) -> bool:
        """Whether there is a level with more than one start."""
        return self.starts.size > self.limit.size

    @property
    def draws_per_reset(self) -> int:
        """How many draws a reset takes: one for the level, one for the start."""
        return int(self.draws_levels) + int(self.draws_starts)

    @property
    def most_draws(self) -> int:
        """How many draws a step takes at most, including an autoreset."""
        return int(self.first.size > 0) + self.draws_per_reset

    def starting_at(self, starts: Ints) -> Tables:
        """Return tables with one start for each level, given in the level's own numbering."""
        first_start = np.arange(starts.size + 1)
        return replace(self, starts=self.offset[:-1] + starts, first_start=first_start)


def build_tables(
    mdps: Sequence[Mdp], limits: Sequence[int], first_action: int, draws_levels: bool = False
) -> Tables:
    """Return the tables of levels.

    Args:
        mdps: the levels' exact tables.
        limits: the time limit of each level.
        first_action: the action that becomes number 0; 1 leaves `stay` out.
        draws_levels: whether each episode draws its level.
    """
    offset = np.cumsum([0, *(mdp.num_states for mdp in mdps)])
    num_actions = NUM_ACTIONS - first_action
    parts = [outcomes_of(mdp, first_action, base) for mdp, base in zip(mdps, offset, strict=False)]
    idle_row = int(offset[-1]) * num_actions
    idle = np.zeros(1, np.uint64)
    # First the outcomes with their rows' numbers, then the idle one, then those of stochastic rows.
    columns = {
        name: np.concatenate(
            [
                *(part.columns[name][:, 0] for part in parts),
                idle.view(parts[0].columns[name].dtype),
                *(part.columns[name][part.is_stochastic] for part in parts),
            ]
        )
        for name in ("next_state", "reward", "outcome_info")
    }
    count = np.concatenate([*(part.count for part in parts), [1]])
    stochastic = np.where(count > 1, np.cumsum(count > 1) - 1, -1)
    count = count[count > 1]
    threshold = np.full((count.size, count.max(initial=1)), ALWAYS)
    done = 0
    for part in parts:
        rows = part.threshold[part.count > 1, : threshold.shape[1]]
        threshold[done : done + len(rows), : rows.shape[1]] = rows
        done += len(rows)
    starts = [np.flatnonzero(mdp.start) + base for mdp, base in zip(mdps, offset, strict=False)]
    state_info = np.concatenate([_mask_words(mdp.action_mask[:, first_action:]) for mdp in mdps])
    return Tables(
        num_actions=num_actions,
        **columns,
        stochastic=stochastic.astype(np.intp),
        first=idle_row + 1 + np.cumsum(count) - count,
        threshold=threshold,
        is_terminal=np.concatenate([mdp.is_terminal for mdp in mdps]),
        state_info=state_info,
        offset=offset.astype(np.intp),
        starts=np.concatenate(starts).astype(np.intp),
        first_start=np.cumsum([0, *map(len, starts)]).astype(np.intp),
        limit=np.array(limits, np.int64),
        draws_levels=draws_levels,
    )


@dataclass(frozen=True, slots=True)
class Outcomes:
    """A level's outcomes, `[rows, outcomes]`; each row has `count` of them, then padding."""

    count: Ints
    threshold: Floats
    columns: dict[str, NDArray[Any]]

    @property
    def is_stochastic(self) -> Flags:
        """Which outcomes belong to rows with more than one."""
        number = np.arange(self.threshold.shape[1])
        return (number < self.count[:, None]) & (self.count > 1)[:, None]


def outcomes_of(mdp: Mdp, first_action: int, base: int) -> Outcomes:
    """Return a level's outcomes, with its states numbered from `base` on."""
    rows = (slice(None), slice(first_action, None))
    width = mdp.probability.shape[2]
    probability = mdp.probability[rows].reshape(-1, width)
    count = np.count_nonzero(probability, axis=1)
    threshold = np.cumsum(probability, axis=1)
    # A row's last outcome takes the rounding error of the sum.
    threshold[np.arange(1, width + 1) >= count[:, None]] = ALWAYS
    next_state = mdp.next_state[rows]
    events = events_of(mdp)[rows]
    info = np.zeros(next_state.shape, info_dtype(NUM_ACTIONS - first_action))
    info["mask"] = mdp.action_mask[next_state, first_action:]
    info["reached"] = events == Event.REACHED
    info["skidded"] = events == Event.SKIDDED
    columns = {
        "next_state": next_state.astype(np.intp) + base,
        "reward": mdp.reward[rows],
        "outcome_info": info.view(np.uint64),
    }
    columns = {name: column.reshape(-1, width) for name, column in columns.items()}
    return Outcomes(count, threshold, columns)


def _mask_words(masks: NDArray[np.int8]) -> Words:
    """Return the info words that have these action masks, int8 `[states, actions]`, alone."""
    info = np.zeros(len(masks), info_dtype(masks.shape[1]))
    info["mask"] = masks
    return info.view(np.uint64)


# -- slots -----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Span:
    """The part of a slot in the arrays of `Tables`, by what the arrays are indexed with."""

    states: slice
    rows: slice
    stochastic: slice
    outcomes: slice
    starts: slice


@dataclass(frozen=True, slots=True)
class Room:
    """The capacity of tables with slots.

    Attributes:
        slots: the number of levels.
        states: the most states of a level.
        starts: the number of starts of each level.
        stochastic: the most stochastic rows of a level.
        outcomes: the most outcomes of such a row.
    """

    slots: int
    states: int
    starts: int
    stochastic: int = 1
    outcomes: int = 2

    def span(self, slot: int, num_actions: int) -> Span:
        """Return the part of a slot in the tables."""
        idle_row = self.slots * self.states * num_actions
        return Span(
            states=_part(slot, self.states),
            rows=_part(slot, self.states * num_actions),
            stochastic=_part(slot, self.stochastic),
            outcomes=_part(slot, self.stochastic * self.outcomes, idle_row + 1),
            starts=_part(slot, self.starts),
        )


def _part(slot: int, size: int, base: int = 0) -> slice:
    return slice(base + slot * size, base + (slot + 1) * size)


def empty_tables(room: Room, first_action: int, limit: int) -> Tables:
    """Return tables whose slots are filled by `write_level`.

    They always have room for stochastic rows, so that `most_draws` never changes.

    Args:
        room: their capacity.
        first_action: the action that becomes number 0; 1 leaves `stay` out.
        limit: the time limit of all levels.
    """
    num_actions = NUM_ACTIONS - first_action
    num_states = room.slots * room.states
    idle_row, stochastic = num_states * num_actions, room.slots * room.stochastic
    num_outcomes = idle_row + 1 + stochastic * room.outcomes
    return Tables(
        num_actions=num_actions,
        next_state=np.zeros(num_outcomes, np.intp),
        reward=np.zeros(num_outcomes),
        outcome_info=np.zeros(num_outcomes, np.uint64),
        stochastic=np.full(idle_row + 1, -1, np.intp),
        first=idle_row + 1 + room.outcomes * np.arange(stochastic, dtype=np.intp),
        threshold=np.full((stochastic, room.outcomes), ALWAYS),
        is_terminal=np.zeros(num_states, np.bool_),
        state_info=np.zeros(num_states, np.uint64),
        offset=room.states * np.arange(room.slots + 1, dtype=np.intp),
        starts=np.zeros(room.slots * room.starts, np.intp),
        first_start=room.starts * np.arange(room.slots + 1, dtype=np.intp),
        limit=np.full(room.slots, limit, np.int64),
        draws_levels=False,
    )


def needed(outcomes: Outcomes) -> tuple[int, int]:
    """Return how many stochastic rows a level has, and the most outcomes of one of them."""
    return int(np.count_nonzero(outcomes.count > 1)), outcomes.threshold.shape[1]


def write_level(tables: Tables, span: Span, mdp: Mdp, outcomes: Outcomes) -> None:
    """Write a level into a slot.

    Args:
        tables: the tables that `empty_tables` returned.
        span: the part of the slot.
        mdp: the level's exact tables.
        outcomes: its outcomes; there must be room for them.
    """
    base, num_rows = span.states.start, outcomes.count.size
    is_stochastic = outcomes.count > 1
    count, width = int(np.count_nonzero(is_stochastic)), outcomes.threshold.shape[1]
    threshold = tables.threshold[span.stochastic]
    for name, column in outcomes.columns.items():
        array = getattr(tables, name)
        shift = base if name == "next_state" else 0
        array[span.rows][:num_rows] = column[:, 0] + shift
        if count:
            further = array[span.outcomes].reshape(threshold.shape)
            further[:count, :width] = column[is_stochastic] + shift
    stochastic = tables.stochastic[span.rows]
    stochastic.fill(-1)
    begin = span.stochastic.start
    stochastic[:num_rows][is_stochastic] = np.arange(begin, begin + count)
    threshold.fill(ALWAYS)
    threshold[:count, :width] = outcomes.threshold[is_stochastic]
    tables.is_terminal[span.states][: mdp.num_states] = mdp.is_terminal
    first_action = NUM_ACTIONS - tables.num_actions
    state_info = _mask_words(mdp.action_mask[:, first_action:])
    tables.state_info[span.states][: mdp.num_states] = state_info
    tables.starts[span.starts] = np.flatnonzero(mdp.start) + base
