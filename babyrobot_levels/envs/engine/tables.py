"""The tables that stepping reads: the outcomes of all levels as flat arrays, one look-up a step.

`build_tables` makes them for levels that stay; `empty_tables` and `write_level` for levels that are
replaced by others while environments run, each in a slot of its own.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import NUM_ACTIONS, NUM_MOVES
from babyrobot_levels.mdp.tables import Event, Mdp, events_of, hits_of

Ints = NDArray[np.intp]
Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Words = NDArray[np.uint64]

TERMINAL, HIT = 1, 2
"""The bits of `end` in info words."""

FIRST_BYTE, NEXT_BYTE = (0, 8) if sys.byteorder == "little" else (56, -8)
"""How far the first byte of an info word, as a number, is shifted, and each further one more."""

MASK_BITS = min(FIRST_BYTE, FIRST_BYTE + NEXT_BYTE)
"""How far the first two bytes are shifted."""

MOST_ACTIONS = NUM_ACTIONS + NUM_MOVES
"""The most actions of one robot, which has eight moves; several have more together."""

END, REACHED, SKIDDED = 5, 6, 7
"""Which bytes of info words these are; the first ones are the action mask."""


def info_dtype(num_actions: int) -> np.dtype[np.void]:
    """Return the dtype of an info word: the info of a step, in eight bytes that move as one.

    `mask`, int8 `[actions]`: the action mask of the state, of several robots with a bit for each,
    the first one the lowest; of more than five actions, uint16: a bit for each, in this order;
    `end`, uint8: the sum of `TERMINAL`, if
    the episode is over, and `HIT`, if a mover hit the robot; `reached` and `skidded`, bool:
    whether the outcome was `Event.REACHED` or `Event.SKIDDED`.
    """
    mask = np.uint16 if num_actions > NUM_ACTIONS else (np.int8, (num_actions,))
    return np.dtype(
        {
            "names": ["mask", "end", "reached", "skidded"],
            "formats": [mask, np.uint8, np.bool_, np.bool_],
            "offsets": [0, END, REACHED, SKIDDED],
            "itemsize": 8,
        }
    )


def masks_of(words: Words, num_actions: int) -> NDArray[np.int8]:
    """Return the action masks of info words, int8 `[…, actions]`; of up to five actions, a view."""
    masks = words.view(info_dtype(num_actions))["mask"]
    if num_actions > NUM_ACTIONS:
        masks = (masks[..., None] >> np.arange(num_actions, dtype=np.uint16) & 1).astype(np.int8)
    found: NDArray[np.int8] = masks
    return found


def masks_at(state_info: Words, states: Ints, num_actions: int) -> NDArray[np.int8]:
    """Return the action masks of states, int8 `[states, num_actions]`, as a new array.

    Args:
        state_info: the attribute of `Tables`.
        states: the states, in the numbering of the tables.
        num_actions: how many actions there are.
    """
    return np.ascontiguousarray(masks_of(state_info.take(states), num_actions))


def robot_masks_at(state_info: Words, states: Ints, num_robots: int) -> NDArray[np.int8]:
    """Return the action masks of each of several robots, int8 `[states, robots, 5]`."""
    return robot_masks(masks_at(state_info, states, NUM_ACTIONS), num_robots)


def robot_masks(masks: NDArray[np.int8], num_robots: int) -> NDArray[np.int8]:
    """Return masks with a bit for each robot as a mask of each, int8 `[…, robots, 5]`."""
    split: NDArray[np.int8] = masks[..., None, :] >> np.arange(num_robots, dtype=np.int8)[:, None]
    return split & np.int8(1)


ALWAYS = 2.0
"""A threshold that no draw reaches."""

NO_LIMIT = 2**62
"""A number of steps that no episode reaches."""


@dataclass(frozen=True, eq=False)
class Tables:
    """Levels as engines read them, one after the other.

    A state here is the state in its level's `Mdp`, plus the level's `offset`. Stepping looks up
    row `state * num_actions + action`. Where an action has one outcome, the outcome has the row's
    number. Where it has several, the row is stochastic: its `next_state` is a negative number, with
    which `first` and `threshold` are indexed from their ends. Its outcomes
    follow one another from `first[number]` on, and a draw selects the first one for which
    `threshold[number]` is above it. One more row, `idle_row`, is for environments that do not act
    in a step.

    Attributes:
        num_actions: how many actions there are: 5, or 9 with eight moves; without stay, one less;
            with turning, 3; of several robots, those of all together.
        next_state: intp `[outcomes]`; negative at stochastic rows.
        reward: float64 `[outcomes]`.
        outcome_info: uint64 `[outcomes]`: the info word after this outcome.
        first: intp `[stochastic rows]`.
        threshold: float64 `[stochastic rows, most outcomes]`: cumulated probabilities, `ALWAYS`
            from a row's last outcome on.
        state_info: uint64 `[states]`: the info word at reset, which has the action mask alone.
        held: bool `[states, items]`: whether each item is held; of a level with fewer items than
            another, the last ones never are.
        offset: intp `[levels + 1]`: where each level's states begin.
        starts: intp `[starts]`: the start states, level by level.
        first_start: intp `[levels + 1]`: where each level's starts begin.
        limit: int64 `[levels]`: the time limit of episodes, in steps.
        draws_levels: whether each episode draws its level.
        has_items: bool `[levels]`: whether a level has items.
        has_movers: bool `[levels]`: whether it has movers.
        tells_hits: whether engines write which environments were hit.
    """

    num_actions: int
    next_state: Ints
    reward: Floats
    outcome_info: Words
    first: Ints
    threshold: Floats
    state_info: Words
    held: Flags
    offset: Ints
    starts: Ints
    first_start: Ints
    limit: NDArray[np.int64]
    draws_levels: bool
    has_items: Flags
    has_movers: Flags
    tells_hits: bool

    @property
    def idle_row(self) -> int:
        """The row in which nothing happens."""
        return self.state_info.size * self.num_actions

    @property
    def mask_width(self) -> int:
        """How many entries a mask has: of the joint actions of several robots, one robot's."""
        return self.num_actions if self.num_actions <= MOST_ACTIONS else NUM_ACTIONS

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

    def starting_at(self, starts: Sequence[Sequence[int]]) -> Tables:
        """Return tables with other starts, for each level one or more in its own numbering."""
        count = [len(each) for each in starts]
        states = np.repeat(self.offset[:-1], count) + np.concatenate(starts)
        return replace(
            self, starts=states.astype(np.intp), first_start=np.cumsum([0, *count]).astype(np.intp)
        )


@dataclass(frozen=True, slots=True)
class Part:
    """One level, with its own numbering of states.

    Outcomes are `[rows, outcomes]`; each row has `count` of them, then padding.

    Attributes:
        count: intp `[rows]`.
        threshold: float64 `[rows, outcomes]`: cumulated probabilities.
        columns: the outcomes' `next_state`, `reward` and `outcome_info`.
        state_info: uint64 `[states]`.
        held: bool `[states, items]`.
        starts: intp `[starts]`.
        has_items: whether the level has items.
        has_movers: whether it has movers.
    """

    count: Ints
    threshold: Floats
    columns: dict[str, NDArray[Any]]
    state_info: Words
    held: Flags
    starts: Ints
    has_items: bool
    has_movers: bool

    @property
    def is_stochastic(self) -> Flags:
        """Which outcomes belong to rows with more than one."""
        number = np.arange(self.threshold.shape[1])
        return (number < self.count[:, None]) & (self.count > 1)[:, None]


def part_of(level: Level, mdp: Mdp, first_action: int) -> Part:
    """Return a level as a part of tables.

    Args:
        level: the level.
        mdp: its exact tables, with or without turning.
        first_action: the action that becomes number 0; 1 leaves `stay` out.
    """
    rows = (slice(None), slice(first_action, None))
    width = mdp.probability.shape[2]
    probability = mdp.probability[rows].reshape(-1, width)
    count = np.count_nonzero(probability, axis=1)
    threshold = np.cumsum(probability, axis=1)
    # A row's last outcome takes the rounding error of the sum.
    threshold[np.arange(1, width + 1) >= count[:, None]] = ALWAYS
    next_state = mdp.next_state[rows]
    events = events_of(mdp)[rows]
    masks = masks_of_robots(mdp) if level.robots else mdp.action_mask[:, first_action:]
    num_actions = masks.shape[1]
    state_info = np.zeros(mdp.num_states, info_dtype(num_actions))
    is_wide = num_actions > NUM_ACTIONS
    state_info["mask"] = masks @ (1 << np.arange(num_actions)) if is_wide else masks
    info = state_info[next_state]
    end = TERMINAL * mdp.terminal[rows].view(np.uint8)
    if level.movers:
        end += HIT * hits_of(level, mdp)[rows].view(np.uint8)
    info["end"] = end
    info["reached"] = events == Event.REACHED
    info["skidded"] = events == Event.SKIDDED
    columns = {
        "next_state": next_state.astype(np.intp),
        "reward": mdp.reward[rows],
        "outcome_info": info.view(np.uint64),
    }
    return Part(
        count=count,
        threshold=threshold,
        columns={name: column.reshape(-1, width) for name, column in columns.items()},
        state_info=state_info.view(np.uint64),
        held=_held(level, mdp),
        starts=mdp.starts,
        has_items=bool(level.items),
        has_movers=bool(level.movers),
    )


def masks_of_robots(mdp: Mdp) -> NDArray[np.int8]:
    """Return for each state and action the robots that can take it, as bits, int8 `[states, 5]`."""
    joint = mdp.action_mask.reshape(-1, *[NUM_ACTIONS] * mdp.num_robots)
    others = [{*range(mdp.num_robots)} - {robot} for robot in range(mdp.num_robots)]
    masks = (joint.max(axis=tuple(1 + each for each in other)) for other in others)
    found: NDArray[np.int8] = sum(mask << robot for robot, mask in enumerate(masks))
    return found


def _held(level: Level, mdp: Mdp) -> Flags:
    """Return which items are held in each state, bool `[states, items]`."""
    held = np.zeros((mdp.num_configurations, len(level.items)), np.bool_)
    if level.items:
        places = [len(item.places) for item in level.items]
        held[:] = mdp.configurations[:, level.things().items] == places
    return np.repeat(held, mdp.cells * mdp.headings, axis=0)


def build_tables(
    parts: Sequence[Part], limits: Sequence[int], draws_levels: bool = False
) -> Tables:
    """Return the tables of levels.

    Args:
        parts: the levels.
        limits: the time limit of each level.
        draws_levels: whether each episode draws its level.
    """
    offset = np.cumsum([0, *(part.state_info.size for part in parts)])
    idle_row = sum(part.count.size for part in parts)
    idle = np.zeros(1, np.uint64)
    # First the outcomes with their rows' numbers, then the idle one, then those of stochastic rows.
    columns = {
        name: np.concatenate(
            [
                *(column[:, 0] for column in numbered),
                idle.view(numbered[0].dtype),
                *(column[part.is_stochastic] for column, part in zip(numbered, parts, strict=True)),
            ]
        )
        for name, numbered in _numbered(parts, offset).items()
    }
    count = np.concatenate([part.count for part in parts])
    stochastic = np.flatnonzero(count > 1)
    columns["next_state"][stochastic] = np.arange(-stochastic.size, 0)
    count = count[stochastic]
    threshold = np.full((count.size, count.max(initial=1)), ALWAYS)
    done = 0
    for part in parts:
        rows = part.threshold[part.count > 1, : threshold.shape[1]]
        threshold[done : done + len(rows), : rows.shape[1]] = rows
        done += len(rows)
    held = np.zeros((offset[-1], max(part.held.shape[1] for part in parts)), np.bool_)
    for part, base in zip(parts, offset, strict=False):
        held[base : base + len(part.held), : part.held.shape[1]] = part.held
    return Tables(
        num_actions=idle_row // int(offset[-1]),
        **columns,
        first=idle_row + 1 + np.cumsum(count) - count,
        threshold=threshold,
        state_info=np.concatenate([part.state_info for part in parts]),
        held=held,
        offset=offset.astype(np.intp),
        starts=np.concatenate(
            [part.starts + base for part, base in zip(parts, offset, strict=False)]
        ),
        first_start=np.cumsum([0, *(part.starts.size for part in parts)]).astype(np.intp),
        limit=np.array(limits, np.int64),
        draws_levels=draws_levels,
        has_items=np.array([part.has_items for part in parts]),
        has_movers=np.array([part.has_movers for part in parts]),
        tells_hits=any(part.has_movers for part in parts),
    )


def _numbered(parts: Sequence[Part], offset: Ints) -> dict[str, list[NDArray[Any]]]:
    """Return the outcomes of levels by their names, next states in the numbering of tables."""
    return {
        name: [
            part.columns[name] + base if name == "next_state" else part.columns[name]
            for part, base in zip(parts, offset, strict=False)
        ]
        for name in ("next_state", "reward", "outcome_info")
    }


# -- slots -----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Span:
    """The part of a slot in the arrays of `Tables`, by what the arrays are indexed with."""

    states: slice
    rows: slice
    stochastic: slice
    outcomes: slice
    starts: slice
    level: int


@dataclass(frozen=True, slots=True)
class Room:
    """The capacity of tables with slots.

    Attributes:
        slots: the number of levels.
        states: the most states of a level.
        starts: the most starts of a level.
        items: the most items of a level.
        stochastic: the most stochastic rows of a level.
        outcomes: the most outcomes of such a row.
    """

    slots: int
    states: int
    starts: int
    items: int = 0
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
            # Those of all slots follow one another without gaps.
            starts=slice(None),
            level=slot,
        )


def _part(slot: int, size: int, base: int = 0) -> slice:
    return slice(base + slot * size, base + (slot + 1) * size)


def empty_tables(room: Room, num_actions: int, tells_hits: bool = False) -> Tables:
    """Return tables whose slots are filled by `write_level`.

    They always have room for stochastic rows, so that `most_draws` never changes.

    Args:
        room: their capacity.
        num_actions: how many actions there are.
        tells_hits: whether levels can have movers.
    """
    num_states = room.slots * room.states
    idle_row, stochastic = num_states * num_actions, room.slots * room.stochastic
    num_outcomes = idle_row + 1 + stochastic * room.outcomes
    return Tables(
        num_actions=num_actions,
        next_state=np.zeros(num_outcomes, np.intp),
        reward=np.zeros(num_outcomes),
        outcome_info=np.zeros(num_outcomes, np.uint64),
        first=idle_row + 1 + room.outcomes * np.arange(stochastic, dtype=np.intp),
        threshold=np.full((stochastic, room.outcomes), ALWAYS),
        state_info=np.zeros(num_states, np.uint64),
        held=np.zeros((num_states, room.items), np.bool_),
        offset=room.states * np.arange(room.slots + 1, dtype=np.intp),
        starts=np.zeros(room.slots * room.starts, np.intp),
        # An empty slot has one start, as most levels have.
        first_start=np.arange(room.slots + 1, dtype=np.intp),
        limit=np.full(room.slots, NO_LIMIT, np.int64),
        draws_levels=False,
        has_items=np.zeros(room.slots, np.bool_),
        has_movers=np.zeros(room.slots, np.bool_),
        tells_hits=tells_hits,
    )


def needed(part: Part) -> tuple[int, int]:
    """Return how many stochastic rows a level has, and the most outcomes of one of them."""
    return int(np.count_nonzero(part.count > 1)), part.threshold.shape[1]


def write_part(tables: Tables, span: Span, part: Part, limit: int) -> None:
    """Write a level into a slot.

    Args:
        tables: the tables that `empty_tables` returned.
        span: the part of the slot.
        part: the level; there must be room for it.
        limit: the time limit of the level.
    """
    base, num_rows, num_states = span.states.start, part.count.size, part.state_info.size
    is_stochastic = part.count > 1
    count, width = int(np.count_nonzero(is_stochastic)), part.threshold.shape[1]
    threshold = tables.threshold[span.stochastic]
    for name, column in part.columns.items():
        array = getattr(tables, name)
        shift = base if name == "next_state" else 0
        array[span.rows][:num_rows] = column[:, 0] + shift
        if count:
            further = array[span.outcomes].reshape(threshold.shape)
            further[:count, :width] = column[is_stochastic] + shift
    begin = span.stochastic.start - tables.first.size
    tables.next_state[span.rows][:num_rows][is_stochastic] = np.arange(begin, begin + count)
    threshold.fill(ALWAYS)
    threshold[:count, :width] = part.threshold[is_stochastic]
    tables.state_info[span.states][:num_states] = part.state_info
    held = tables.held[span.states]
    held.fill(0)
    held[:num_states, : part.held.shape[1]] = part.held
    _write_starts(tables, span.level, part.starts + base)
    tables.limit[span.level] = limit
    tables.has_items[span.level], tables.has_movers[span.level] = part.has_items, part.has_movers


def _write_starts(tables: Tables, slot: int, starts: Ints) -> None:
    """Put the starts of a level between those of the slots around it."""
    begin, end = tables.first_start[slot : slot + 2].tolist()
    if more := starts.size - (end - begin):
        after = tables.starts[end : tables.first_start[-1]].copy()
        tables.starts[end + more : end + more + after.size] = after
        tables.first_start[slot + 1 :] += more
    tables.starts[begin : begin + starts.size] = starts
