"""What stepping reads of levels: one flat list of outcomes, one look-up a step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.actions import NUM_ACTIONS
from babyrobot_levels.mdp import GLASS, REFUSED, Mdp

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


ALWAYS = 2.0
"""A threshold that no draw reaches."""

NO_LIMIT = 2**62
"""A number of steps that no episode has."""


@dataclass(frozen=True, eq=False)
class Tables:
    """Levels, one after the other, as engines read them.

    A robot's state is its number in its level, `y * width + x`, plus the level's `offset`. Row
    `state * num_actions + action` is where stepping looks: its first outcome has the row's number.
    While a draw is not below an outcome's `threshold`, `otherwise` says which one is next. One row
    more, `rest`, is for robots that do not act in a step.

    Attributes:
        num_actions: how many actions there are, 5 or, without stay, 4.
        next_state: intp `[outcomes]`.
        reward: float64 `[outcomes]`.
        arrival: uint64 `[outcomes]`: the word of having come there so.
        threshold: float64 `[outcomes]`: cumulated probability; `ALWAYS` for a row's last outcome.
        otherwise: intp `[outcomes]`.
        chancy: bool `[rows]`: whether there is more than one outcome.
        most_outcomes: how many there are at most.
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
    threshold: Floats
    otherwise: Ints
    chancy: Flags
    most_outcomes: int
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
        return self.chancy.size - 1

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
        return int(self.most_outcomes > 1) + self.draws_to_begin

    @property
    def masks(self) -> NDArray[np.int8]:
        """The possible actions, int8 `[states, num_actions]`."""
        masks: NDArray[np.int8] = self.standing.view(signs_of(self.num_actions))["mask"]
        return masks


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
    parts = [_outcomes(mdp, first_action, base) for mdp, base in zip(mdps, offset, strict=False)]
    rest = int(offset[-1]) * num_actions
    # First outcomes at their rows' numbers, then that of `rest`, then all others.
    columns = {
        name: np.concatenate(
            [
                *(part[name][:, 0] for part in parts),
                np.zeros(1, parts[0][name].dtype),
                *(part[name][:, 1:][part["real"][:, 1:]] for part in parts),
            ]
        )
        for name in ("next_state", "reward", "arrival", "threshold")
    }
    columns["threshold"][rest] = ALWAYS
    others = np.concatenate([*(part["real"].sum(axis=1) - 1 for part in parts), [0]])
    otherwise = np.arange(1, columns["reward"].size + 1)
    otherwise[: rest + 1] = rest + 1 + np.cumsum(others) - others
    starts = [np.flatnonzero(mdp.start) + base for mdp, base in zip(mdps, offset, strict=False)]
    standing = np.concatenate([_words(mdp.possible[:, first_action:]) for mdp in mdps])
    return Tables(
        num_actions=num_actions,
        **columns,
        otherwise=otherwise.astype(np.intp),
        chancy=others > 0,
        most_outcomes=int(others.max()) + 1,
        over=np.concatenate([mdp.over for mdp in mdps]),
        standing=standing,
        offset=offset.astype(np.intp),
        starts=np.concatenate(starts).astype(np.intp),
        first_start=np.cumsum([0, *map(len, starts)]).astype(np.intp),
        limit=np.array(limits, np.int64),
        draws_levels=draws_levels,
    )


def _outcomes(mdp: Mdp, first_action: int, base: int) -> dict[str, NDArray[Any]]:
    """Return a level's outcomes, `[rows, outcomes]` each; `real` says which there are."""
    columns = (slice(None), slice(first_action, None))
    width = mdp.probability.shape[2]
    probability = mdp.probability[columns]
    real = probability > 0
    last = real.sum(axis=2, keepdims=True) - 1
    threshold = np.cumsum(probability, axis=2)
    # A row's last outcome takes what rounding leaves over.
    threshold[np.arange(width) >= last] = ALWAYS
    next_state = mdp.next_state[columns]
    target = mdp.target[columns][..., None]
    hindered = mdp.hindered[columns][..., None]
    is_start = mdp.start > 0
    at_target = (next_state == target) | ((target == mdp.num_states) & is_start[next_state])
    signs = np.zeros(next_state.shape, signs_of(NUM_ACTIONS - first_action))
    signs["mask"] = mdp.possible[next_state, first_action:]
    signs["reached"] = at_target & (hindered != REFUSED)
    signs["skidded"] = ~at_target & (hindered != GLASS)
    outcomes = {
        "real": real,
        "next_state": next_state.astype(np.intp) + base,
        "reward": mdp.reward[columns],
        "arrival": signs.view(np.uint64),
        "threshold": threshold,
    }
    return {name: array.reshape(-1, width) for name, array in outcomes.items()}


def _words(masks: NDArray[np.int8]) -> Words:
    signs = np.zeros(len(masks), signs_of(masks.shape[1]))
    signs["mask"] = masks
    return signs.view(np.uint64)
