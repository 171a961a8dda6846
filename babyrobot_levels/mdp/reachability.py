"""Which states an episode can reach, and from which it can still end, by the tables."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from babyrobot_levels.mdp.graph import Graph, Successors
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.mdp.tables import Mdp


@dataclass(frozen=True, slots=True)
class Reach:
    """What can happen in a level, one entry for each state.

    Attributes:
        steps: the fewest steps in which a state can be reached, -1 where it never is.
        on: 1 where an episode can be and goes on: reached, and not terminal.
        to_exit: the fewest steps in which an exit can be reached from there, -1 where none can.
        to_end: the same for exits and cells that end the episode.
        graph: the other states to which one step can lead, with any probability.
    """

    steps: list[int]
    on: bytes
    to_exit: list[int]
    to_end: list[int]
    graph: Graph

    @property
    def successors(self) -> Successors:
        """The other states to which one step can lead."""
        return self.graph.successors

    def reached(self, state: int) -> bool:
        """Tell whether an episode can come to a state."""
        return self.steps[state] >= 0

    def from_some(self, states: Iterable[int]) -> list[int]:
        """Return for each state the fewest steps in which it can be reached from some others."""
        found: list[int] = self.graph.distances(states).tolist()
        return found


def reach_of(level: GridWorld, mdp: Mdp) -> Reach:
    """Return what can happen in a level, or in a variant of it.

    Args:
        level: the level.
        mdp: its tables, or those of a variant with the same grid and exits.
    """
    width = mdp.width
    graph = transitions(mdp)
    backwards = graph.reversed()
    steps = graph.distances(np.flatnonzero(mdp.start)).tolist()
    over, blocked = mdp.is_terminal.tolist(), level.grid().blocked_cells
    exits = sorted(y * width + x for x, y in level.exits)
    ends = [state for state, ended in enumerate(over) if ended and not blocked[state]]
    to_exit = backwards.distances(exits).tolist()
    return Reach(
        steps,
        bytes(count >= 0 and not ended for count, ended in zip(steps, over, strict=True)),
        to_exit,
        to_exit if ends == exits else backwards.distances(ends).tolist(),
        graph,
    )


def transitions(mdp: Mdp) -> Graph:
    """Return the graph of all transitions from one state to another, each pair once."""
    states = np.arange(mdp.num_states, dtype=np.int32)[:, None]
    happens = (mdp.probability > 0) & ~mdp.is_terminal[:, None, None]
    targets = np.where(happens, mdp.next_state, states[:, :, None]).reshape(mdp.num_states, -1)
    targets.sort(axis=1)
    moves = targets != states
    moves[:, 1:] &= targets[:, 1:] != targets[:, :-1]
    return Graph(mdp.num_states, moves.nonzero()[0], targets[moves])
