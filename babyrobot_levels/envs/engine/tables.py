"""What stepping reads of levels: one flat list of outcomes, one look-up a step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.mdp.actions import NUM_ACTIONS
from babyrobot_levels.mdp.tables import GLASS, REFUSED, Mdp

Ints = NDArray[np.intp]
Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Words = NDArray[np.uint64]


def signs_of(num_actions: int) -> np.dtype[np.void]:
    """Return the dtype of a word: what is said of a robot, in eight bytes that move as one.

    `mask`, int8 `[actions]`: what is possible where it stands; `reached` and `skidded`, bool:
    whether it came where its action leads, and whether chance took it somewhere else.
    """
    return np.dtype(
        {
            "names": ["mask", "reached", "skidded"],
            "formats": [(np.int8, (num_actions,)), np.bool_, np.bool_],
            "offsets": [0, 6, 7],
            "itemsize": 8,
        }
    )


def masks_at(standing: Words, states: Ints, num_actions: int) -> NDArray[np.int8]:
    """Return the possible actions in states, int8 `[states, num_actions]`, as a new array.

    Args:
        standing: what `Tables` has under this name.
        states: the states, in the numbering of the tables.
        num_actions: how many actions there are.
    """
    masks: NDArray[np.int8] = standing.take(states).view(signs_of(num_actions))["mask"]
    return masks


ALWAYS = 2.0
"""A threshold that no draw reaches."""

NO_LIMIT = 2**62
"""A number of steps that no episode has."""


@dataclass(frozen=True, eq=False)
class Tables:
    """Levels, one after the other, as engines read them.

    A robot's state is its number in its level, `y * width + x`, plus the level's `offset`. Row
    `state * num_actions + action` is where stepping looks: if only one thing can come of it, the
    outcome has the row's number. Of rows that leave something to chance, `chance` tells the
    number; their outcomes follow one another from `first[number]` on, and a draw means the first
    one in whose place `threshold[number]` is above it. One row more, `rest`, is for robots that do
    not act in a step.

    Attributes:
        num_actions: how many actions there are, 5 or, without stay, 4.
        next_state: intp `[outcomes]`.
        reward: float64 `[outcomes]`.
        arrival: uint64 `[outcomes]`: the word of having come there so.
        chance: intp `[rows]`: the number of what is left to chance, -1 where nothing is.
        first: intp `[chances]`.
        threshold: float64 `[chances, most outcomes]`: cumulated probabilities, `ALWAYS` from a
            row's last outcome on.
        over: bool `[states]`: whether the episode is over there.
        standing: uint64 `[states]`: the word of standing there, the mask alone.
        offset: intp `[levels + 1]`: where each level's states begin.
        starts: intp `[starts]`: the states at which episodes begin, level by level.
        first_start: intp `[levels + 1]`: where each level's starts begin.
        limit: int64 `[levels]`: after how many steps an episode is cut off.
        draws_levels: whether each episode draws the level that it is played in.
    """

    num_actions: int
    next_state: Ints
    reward: Floats
    arrival: Words
    chance: Ints
    first: Ints
    threshold: Floats
    over: Flags
    standing: Words
    offset: Ints
    starts: Ints
    first_start: Ints
    limit: NDArray[np.int64]
    draws_levels: bool

    @property
    def rest(self) -> int:
        """The row in which nothing happens."""
        return self.chance.size - 1

    @property
    def draws_starts(self) -> bool:
        """Whether there is a level with more than one start."""
        return self.starts.size > self.limit.size

    @property
    def draws_to_begin(self) -> int:
        """How many draws it takes to begin an episode: one for the level, one for the start."""
        return int(self.draws_levels) + int(self.draws_starts)

    @property
    def most_draws(self) -> int:
        """How many draws a step takes at most, the beginning of the next episode included."""
        return int(self.first.size > 0) + self.draws_to_begin

    def beginning_at(self, starts: Ints) -> Tables:
        """Return tables of levels that begin at one state each, numbered as in that level alone."""
        first_start = np.arange(starts.size + 1)
        return replace(self, starts=self.offset[:-1] + starts, first_start=first_start)


def build_tables(
    mdps: Sequence[Mdp], limits: Sequence[int], first_action: int, draws_levels: bool = False
) -> Tables:
    """Return the tables of levels.

    Args:
        mdps: the levels' exact tables.
        limits: after how many steps an episode is cut off, for each level.
        first_action: the action that becomes number 0: 1 leaves `stay` out.
        draws_levels: whether each episode draws the level that it is played in.
    """
    offset = np.cumsum([0, *(mdp.num_states for mdp in mdps)])
    num_actions = NUM_ACTIONS - first_action
    parts = [outcomes_of(mdp, first_action, base) for mdp, base in zip(mdps, offset, strict=False)]
    rest = int(offset[-1]) * num_actions
    nothing = np.zeros(1, np.uint64)
    # First the outcomes that have their rows' numbers, then that of `rest`, then those of chance.
    columns = {
        name: np.concatenate(
            [
                *(part.columns[name][:, 0] for part in parts),
                nothing.view(parts[0].columns[name].dtype),
                *(part.columns[name][part.is_chance] for part in parts),
            ]
        )
        for name in ("next_state", "reward", "arrival")
    }
    count = np.concatenate([*(part.count for part in parts), [1]])
    chance = np.where(count > 1, np.cumsum(count > 1) - 1, -1)
    count = count[count > 1]
    threshold = np.full((count.size, count.max(initial=1)), ALWAYS)
    done = 0
    for part in parts:
        rows = part.threshold[part.count > 1, : threshold.shape[1]]
        threshold[done : done + len(rows), : rows.shape[1]] = rows
        done += len(rows)
    starts = [np.flatnonzero(mdp.start) + base for mdp, base in zip(mdps, offset, strict=False)]
    standing = np.concatenate([words_of(mdp.possible[:, first_action:]) for mdp in mdps])
    return Tables(
        num_actions=num_actions,
        **columns,
        chance=chance.astype(np.intp),
        first=rest + 1 + np.cumsum(count) - count,
        threshold=threshold,
        over=np.concatenate([mdp.over for mdp in mdps]),
        standing=standing,
        offset=offset.astype(np.intp),
        starts=np.concatenate(starts).astype(np.intp),
        first_start=np.cumsum([0, *map(len, starts)]).astype(np.intp),
        limit=np.array(limits, np.int64),
        draws_levels=draws_levels,
    )


@dataclass(frozen=True, slots=True)
class Outcomes:
    """A level's outcomes, `[rows, outcomes]`, of which each row has `count` and then nothing."""

    count: Ints
    threshold: Floats
    columns: dict[str, NDArray[Any]]

    @property
    def is_chance(self) -> Flags:
        """Which outcomes are those of rows that have more than one."""
        number = np.arange(self.threshold.shape[1])
        return (number < self.count[:, None]) & (self.count > 1)[:, None]


def outcomes_of(mdp: Mdp, first_action: int, base: int) -> Outcomes:
    """Return a level's outcomes, its states numbered from `base` on."""
    rows = (slice(None), slice(first_action, None))
    width = mdp.probability.shape[2]
    probability = mdp.probability[rows].reshape(-1, width)
    count = np.count_nonzero(probability, axis=1)
    threshold = np.cumsum(probability, axis=1)
    # A row's last outcome takes what rounding leaves over.
    threshold[np.arange(1, width + 1) >= count[:, None]] = ALWAYS
    next_state = mdp.next_state[rows]
    target = mdp.target[rows][..., None]
    hindered = mdp.hindered[rows][..., None]
    is_start = mdp.start > 0
    at_target = (next_state == target) | ((target == mdp.num_states) & is_start[next_state])
    signs = np.zeros(next_state.shape, signs_of(NUM_ACTIONS - first_action))
    signs["mask"] = mdp.possible[next_state, first_action:]
    signs["reached"] = at_target & (hindered != REFUSED)
    signs["skidded"] = ~at_target & (hindered != GLASS)
    columns = {
        "next_state": next_state.astype(np.intp) + base,
        "reward": mdp.reward[rows],
        "arrival": signs.view(np.uint64),
    }
    columns = {name: column.reshape(-1, width) for name, column in columns.items()}
    return Outcomes(count, threshold, columns)


def words_of(masks: NDArray[np.int8]) -> Words:
    """Return the words of standing where these actions are possible, int8 `[states, actions]`."""
    signs = np.zeros(len(masks), signs_of(masks.shape[1]))
    signs["mask"] = masks
    return signs.view(np.uint64)
