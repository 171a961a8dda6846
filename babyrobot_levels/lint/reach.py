"""Which cells the robot can come to, and from which he can still get out, by the tables."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.level import Level
from babyrobot_levels.mdp import Mdp


@dataclass(frozen=True, slots=True)
class Reach:
    """What can happen in a level, one entry for each state.

    Attributes:
        steps: the fewest steps in which the robot can be there, -1 where he never is.
        on: 1 where he can stand and has to go on: reached, and the episode is not over.
        to_exit: the fewest steps in which an exit can be reached from there, -1 where none can.
        to_end: the same for exits and cells that end the episode.
        ahead: the other states to which one step can lead, with any probability.
    """

    steps: list[int]
    on: bytes
    to_exit: list[int]
    to_end: list[int]
    ahead: list[list[int]]

    def reached(self, state: int) -> bool:
        """Tell whether the robot can come to a state."""
        return self.steps[state] >= 0

    def from_some(self, states: Iterable[int]) -> list[int]:
        """Return for each state the fewest steps in which it can be reached from some others."""
        return distances(states, self.ahead)


def reach_of(level: Level, mdp: Mdp) -> Reach:
    """Return what can happen in a level, or in a variant of it.

    Args:
        level: the level.
        mdp: its tables, or those of a variant with the same grid and exits.
    """
    width = mdp.width
    origins, targets = _moves(mdp)
    ahead = adjacency(origins, targets, mdp.num_states)
    back = adjacency(targets, origins, mdp.num_states)
    steps = distances(mdp.start.nonzero()[0].tolist(), ahead)
    over, blocked = mdp.over.tolist(), level.grid().blocked_cells
    exits = sorted(y * width + x for x, y in level.exits)
    ends = [state for state, ended in enumerate(over) if ended and not blocked[state]]
    to_exit = distances(exits, back)
    return Reach(
        steps,
        bytes(count >= 0 and not ended for count, ended in zip(steps, over, strict=True)),
        to_exit,
        to_exit if ends == exits else distances(ends, back),
        ahead,
    )


def _moves(mdp: Mdp) -> tuple[NDArray[np.intp], NDArray[np.int32]]:
    """Return origins and targets of all moves from one state to another, each pair once."""
    states = np.arange(mdp.num_states, dtype=np.int32)[:, None]
    happens = (mdp.probability > 0) & ~mdp.over[:, None, None]
    targets = np.where(happens, mdp.next_state, states[:, :, None]).reshape(mdp.num_states, -1)
    targets.sort(axis=1)
    moves = targets != states
    moves[:, 1:] &= targets[:, 1:] != targets[:, :-1]
    return moves.nonzero()[0], targets[moves]


def adjacency(
    origins: NDArray[np.integer], targets: NDArray[np.integer], count: int
) -> list[list[int]]:
    """Return the targets of each origin, as lists: they are several times faster to walk."""
    order = np.argsort(origins, kind="stable")
    bounds = np.searchsorted(origins[order], np.arange(count + 1)).tolist()
    ahead = targets[order].tolist()
    return [ahead[first:last] for first, last in pairwise(bounds)]


def distances(sources: Iterable[int], ahead: Sequence[Sequence[int]]) -> list[int]:
    """Return for each state the fewest steps from a source, -1 where none leads there."""
    steps = [-1] * len(ahead)
    waiting = deque(sources)
    for state in waiting:
        steps[state] = 0
    while waiting:
        state = waiting.popleft()
        for other in ahead[state]:
            if steps[other] < 0:
                steps[other] = steps[state] + 1
                waiting.append(other)
    return steps
