"""Which states an episode can reach, and from which it can still end, by the tables."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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
        to_end: the same for all ways to end the episode: exits, cells that end it, and hits.
        graph: the other states to which one step can lead, with any probability. A step that
            ends the episode in a state in which others go on is not part of it.
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
        mdp: its tables, those of a robot that turns, or those of a variant with the same grid,
            things and exits.
    """
    graph = transitions(mdp)
    backwards = graph.reversed()
    steps = graph.distances(np.flatnonzero(mdp.start))
    exits = np.flatnonzero(exit_states(level, mdp))
    free = ~level.grid().blocked.ravel()
    ends = np.flatnonzero(mdp.is_terminal.reshape(-1, mdp.cells) & free)
    hits = np.flatnonzero(ends_by_hit(mdp).any(axis=(1, 2))) if level.movers else exits[:0]
    to_exit = backwards.distances(exits).tolist()
    to_end = to_exit
    if hits.size:
        # One more node, to which every hit that ends an episode leads.
        source = np.append(graph.source, hits.astype(np.int32))
        target = np.append(graph.target, np.full(hits.size, mdp.num_states, np.int32))
        more = Graph(mdp.num_states + 1, target, source)
        to_end = more.distances(np.append(ends, mdp.num_states)).tolist()[:-1]
    elif not np.array_equal(ends, exits):
        to_end = backwards.distances(ends).tolist()
    return Reach(
        steps.tolist(),
        ((steps >= 0) & ~mdp.is_terminal).tobytes(),
        to_exit,
        to_end,
        graph,
    )


def exit_states(level: GridWorld, mdp: Mdp) -> NDArray[np.bool_]:
    """Return in which states the robot stands on an exit that is open, `[states]`.

    Args:
        level: the level.
        mdp: its tables, or those of a robot that turns.
    """
    if not level.has_things:
        is_exit = np.zeros(mdp.cells, bool)
        is_exit[[y * mdp.width + x for x, y in level.exits]] = True
        return np.tile(is_exit, mdp.headings) if mdp.headings > 1 else is_exit
    things = level.things()
    # Movers change nothing about exits.
    static, which = np.unique(mdp.configurations[:, : things.static], axis=0, return_inverse=True)
    cells = np.zeros((len(static), mdp.cells), bool)
    for row, values in zip(cells, static.tolist(), strict=True):
        if things.exit_is_open(values):
            row[[y * mdp.width + x for x, y in things.exits(values)]] = True
    return np.repeat(cells[which.ravel()], mdp.headings, axis=0).ravel()


def ends_by_hit(mdp: Mdp) -> NDArray[np.bool_]:
    """Return which outcomes end the episode in a state in which others go on.

    They are hits, `[states, actions, outcomes]`.
    """
    happens = mdp.terminal & (mdp.probability > 0)
    return happens & ~mdp.is_terminal[mdp.next_state]


def transitions(mdp: Mdp) -> Graph:
    """Return the graph of all transitions from one state to another, each pair once."""
    states = np.arange(mdp.num_states, dtype=np.int32)[:, None]
    happens = (mdp.probability > 0) & ~mdp.is_terminal[:, None, None]
    if mdp.configurations.shape[1]:
        happens &= ~ends_by_hit(mdp)
    targets = np.where(happens, mdp.next_state, states[:, :, None]).reshape(mdp.num_states, -1)
    targets.sort(axis=1)
    moves = targets != states
    moves[:, 1:] &= targets[:, 1:] != targets[:, :-1]
    source = np.repeat(states.ravel(), moves.sum(axis=1))
    return Graph(mdp.num_states, source, targets[moves])
