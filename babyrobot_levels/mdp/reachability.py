"""Which cells the robot can come to, and from which he can still get out, by the tables."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.tables import Mdp

MANY = 50_000
"""From so many states on, ways are counted with SciPy: fewer take no longer than its import."""


@dataclass(frozen=True, slots=True)
class Reach:
    """What can happen in a level, one entry for each state.

    Attributes:
        steps: the fewest steps in which the robot can be there, -1 where he never is.
        on: 1 where he can stand and has to go on: reached, and the episode is not over.
        to_exit: the fewest steps in which an exit can be reached from there, -1 where none can.
        to_end: the same for exits and cells that end the episode.
        ways: the other states to which one step can lead, with any probability.
    """

    steps: list[int]
    on: bytes
    to_exit: list[int]
    to_end: list[int]
    ways: Ways

    @property
    def ahead(self) -> Sequence[Sequence[int]]:
        """The other states to which one step can lead."""
        return self.ways.ahead

    def reached(self, state: int) -> bool:
        """Tell whether the robot can come to a state."""
        return self.steps[state] >= 0

    def from_some(self, states: Iterable[int]) -> list[int]:
        """Return for each state the fewest steps in which it can be reached from some others."""
        return self.ways.distances(states)


class Ways:
    """Which states lead to which others.

    Args:
        origins: where each step begins.
        targets: where it ends.
        count: the number of states.
    """

    def __init__(
        self, origins: NDArray[np.signedinteger], targets: NDArray[np.signedinteger], count: int
    ):
        self.origins, self.targets, self.count = origins, targets, count

    @cached_property
    def ahead(self) -> Sequence[Sequence[int]]:
        """The targets of each origin, as lists; of many, those that are asked for."""
        order = np.argsort(self.origins, kind="stable")
        bounds = np.searchsorted(self.origins[order], np.arange(self.count + 1)).tolist()
        if self.count >= MANY:
            return _Rows(self.targets[order], bounds)
        ahead = self.targets[order].tolist()
        return [ahead[first:last] for first, last in pairwise(bounds)]

    def back(self) -> Ways:
        """Return the same steps from their ends to their beginnings."""
        return Ways(self.targets, self.origins, self.count)

    def distances(self, sources: Iterable[int]) -> list[int]:
        """Return for each state the fewest steps from a source, -1 where none leads there."""
        if self.count >= MANY:
            from babyrobot_levels.analysis.solver import graphs

            roots = np.unique(np.fromiter(sources, np.intp))
            found = graphs.distances(self.count, self.origins, self.targets, roots)
            found[found > self.count] = -1
            counted: list[int] = found.tolist()
            return counted
        steps = [-1] * self.count
        ahead, waiting = self.ahead, deque(sources)
        for state in waiting:
            steps[state] = 0
        while waiting:
            state = waiting.popleft()
            for other in ahead[state]:
                if steps[other] < 0:
                    steps[other] = steps[state] + 1
                    waiting.append(other)
        return steps


class _Rows(Sequence[Sequence[int]]):
    """A list of lists that is kept as two: of all their values, and of where each begins."""

    def __init__(self, values: NDArray[np.signedinteger], bounds: list[int]):
        self.values, self.bounds = values, bounds

    def __len__(self) -> int:
        return len(self.bounds) - 1

    def __getitem__(self, row: Any) -> Any:
        return self.values[self.bounds[row] : self.bounds[row + 1]].tolist()


def reach_of(level: Level, mdp: Mdp) -> Reach:
    """Return what can happen in a level, or in a variant of it.

    Args:
        level: the level.
        mdp: its tables, or those of a variant with the same grid and exits.
    """
    width = mdp.width
    ways = Ways(*_moves(mdp), mdp.num_states)
    back = ways.back()
    steps = ways.distances(mdp.start.nonzero()[0].tolist())
    over, blocked = mdp.over.tolist(), level.grid().blocked_cells
    exits = sorted(y * width + x for x, y in level.exits)
    ends = [state for state, ended in enumerate(over) if ended and not blocked[state]]
    to_exit = back.distances(exits)
    return Reach(
        steps,
        bytes(count >= 0 and not ended for count, ended in zip(steps, over, strict=True)),
        to_exit,
        to_exit if ends == exits else back.distances(ends),
        ways,
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
