"""States: which ones episodes reach, and what they and their configurations are in words."""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.language.kinds import NEEDED
from babyrobot_levels.mdp.configurations import Configuration, Things
from babyrobot_levels.mdp.graph import Graph, Successors, counts
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.mdp.tables import ALL, Flags, Mdp, parts_of
from babyrobot_levels.text import budget
from babyrobot_levels.text.words import did_you_mean, listed

MAX_LISTED = 10
"""How many sets of held things an error lists."""


def initial_configuration(level: GridWorld) -> int:
    """Return the number of the first configuration in which an episode can begin.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """
    mdp = level.compile()
    return mdp.configuration(int((mdp.start > 0).argmax()))


def configuration_with(level: GridWorld, names: Iterable[str]) -> int:
    """Return the first configuration in which exactly some things are held or on.

    If there is one in which all movers stand as at reset, it is the first of those. Configurations
    in which an episode can go on come before those in which it is over.

    Args:
        level: the level.
        names: the names of the things; none for "nothing is held or on".

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
        ValueError: a name is not that of such a thing, or no episode comes to this.
    """
    wanted, known = frozenset(names), (*level.things().needed,)
    for name in sorted(wanted.difference(known)):
        if not known:
            none = listed([f"no {kind.plural}" for kind in NEEDED])
            raise ValueError(f"the level has no {name!r}: it has {none}")
        hint = did_you_mean(name, known) or f"; it has {listed(known)}"
        one = listed([kind.noun for kind in NEEDED], "or")
        raise ValueError(f"the level has no {one} {name!r}{hint}")
    found = held_sets(level)
    for names, number in found.items():
        if wanted == {*names}:
            return number
    texts = [",".join(names) or "nothing" for names in found]
    more = ["…"] if len(texts) > MAX_LISTED else []
    raise ValueError(
        f"in no episode exactly {listed(sorted(wanted)) or 'nothing'} is held or on; possible "
        f"are: {'; '.join(texts[:MAX_LISTED] + more)}"
    )


def held_sets(level: GridWorld) -> dict[tuple[str, ...], int]:
    """Return all that can be held or on at the same time, each with its first configuration.

    Which one that is, see `configuration_with`. Names are in the order of the level, and fewer
    come before more.
    """
    things, mdp = level.things(), level.compile()
    over = np.all(mdp.is_terminal.reshape(mdp.num_configurations, -1), axis=1)
    begins = things.begins()[things.static :]
    met_with = cache(lambda *static: things.met(static))
    found: dict[frozenset[str], tuple[bool, bool, int]] = {}
    for number, values in enumerate(mdp.configurations.tolist()):
        movers = zip(values[things.static :], begins, strict=True)
        key = bool(over[number]), not all(at in first for at, first in movers), number
        met = met_with(*values[: things.static])
        found[met] = min(found.get(met, key), key)
    known = (*things.needed,)
    order = sorted(found, key=lambda met: (len(met), [name in met for name in known]))
    return {tuple(name for name in known if name in met): found[met][2] for met in order}


def shown_configurations(level: GridWorld, most: int) -> tuple[dict[str, int], int]:
    """Return a configuration for each set of held things, and how many of them are left out.

    The one in which episodes begin comes first. Each has its set in words: `key, lever on`.
    """
    start, things, rows = (
        initial_configuration(level),
        level.things(),
        level.compile().configurations,
    )
    found: dict[str, int] = {}
    for number in (start, *held_sets(level).values()):
        told = things.told(rows[number].tolist())
        words = [n if state == "held" else f"{n} {state}" for state in told for n in told[state]]
        found.setdefault(", ".join(words) or "nothing", number)
    return dict(islice(found.items(), most)), max(0, len(found) - most)


def state_text(things: Things, mdp: Mdp, state: int) -> str:
    """Return a state as words: its cell, and what is held and on: `[3, 1] while key is held`.

    Args:
        things: the things of the level.
        mdp: its tables, or those of a robot that turns.
        state: the number of the state in these tables.
    """
    x, y = mdp.cell(state)
    heading = f" looking {SIDES[mdp.heading(state)]}" if mdp.headings > 1 else ""
    condition = things.condition(mdp.configurations[mdp.configuration(state)].tolist())
    return f"[{x}, {y}]{heading}{condition and ' ' + condition}"


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

    steps: array[int]
    on: bytes
    to_exit: array[int]
    to_end: array[int]
    graph: Graph

    @property
    def successors(self) -> Successors:
        """The other states to which one step can lead."""
        return self.graph.successors

    def reached(self, state: int) -> bool:
        """Tell whether an episode can come to a state."""
        return self.steps[state] >= 0

    def from_some(self, states: Iterable[int]) -> array[int]:
        """Return for each state the fewest steps in which it can be reached from some others."""
        return counts(self.graph.distances(states))


def occurring(mdp: Mdp) -> NDArray[np.bool_]:
    """Return which states episodes come to, in the shape of the states."""
    return (transitions(mdp).distances(np.flatnonzero(mdp.start)) >= 0).reshape(mdp.shape)


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
    to_exit = to_end = backwards.distances(exits)
    if hits.size:
        # One more node, to which every hit that ends an episode leads.
        source = np.append(graph.source, hits.astype(np.int32))
        target = np.append(graph.target, np.full(hits.size, mdp.num_states, np.int32))
        more = Graph(mdp.num_states + 1, target, source)
        to_end = more.distances(np.append(ends, mdp.num_states))[:-1]
    elif not np.array_equal(ends, exits):
        to_end = backwards.distances(ends)
    on = (steps >= 0) & ~mdp.is_terminal
    return Reach(counts(steps), on.tobytes(), counts(to_exit), counts(to_end), graph)


def exit_states(level: GridWorld, mdp: Mdp) -> NDArray[np.bool_]:
    """Return in which states the robot stands on an open exit, or all is covered, `[states]`.

    Args:
        level: the level.
        mdp: its tables, or those of a robot that turns.
    """
    if not level.has_things:
        is_exit = np.zeros(mdp.cells, bool)
        is_exit[[y * mdp.width + x for x, y in level.exits]] = True
        return np.tile(is_exit, mdp.headings) if mdp.headings > 1 else is_exit
    things = level.things()
    if level.robots:
        return _arrived_states(level, mdp)
    # Movers change nothing about exits and targets.
    static, which = np.unique(mdp.configurations[:, : things.static], axis=0, return_inverse=True)
    cells = np.zeros((len(static), mdp.cells), bool)
    free = ~level.grid().blocked.ravel()
    for row, values in zip(cells, static.tolist(), strict=True):
        if things.is_solved(values):
            row[:] = free
        elif things.exit_is_open(values):
            row[[y * mdp.width + x for x, y in things.exits(values)]] = True
    return np.repeat(cells[which.ravel()], mdp.headings, axis=0).ravel()


def has_succeeded(level: GridWorld, now: Configuration) -> bool:
    """Return whether several robots have done what they are to do."""
    if level.ends_covered:
        return now.is_solved
    if level.team.ends == "first":
        return any(now.arrived)
    robots = zip(level.robots, now.arrived, strict=True)
    arrived = [has_arrived for robot, has_arrived in robots if level.exits_of(robot)]
    return bool(arrived) and all(arrived)


def _arrived_states(level: GridWorld, mdp: Mdp) -> NDArray[np.bool_]:
    """Return in which states several robots have done what they are to do, `[states]`."""
    things = level.things()
    arrived = np.stack(
        [
            mdp.configurations[:, column] >= things[column].first_arrived
            for column in range(*things.of_kind("robot").indices(len(things)))
        ],
        axis=1,
    )
    has_exit = [bool(level.exits_of(robot)) for robot in level.robots]
    done: Flags
    if level.ends_covered:
        done = np.all(mdp.configurations[:, things.of_kind("target")], axis=1)
    elif level.team.ends == "first":
        done = np.any(arrived, axis=1)
    else:
        done = np.all(arrived[:, has_exit], axis=1) & any(has_exit)
    cells = np.tile(~level.grid().blocked.ravel(), (len(done), 1))
    return (cells & done[:, None]).ravel()


def ends_by_hit(mdp: Mdp, part: slice = ALL) -> NDArray[np.bool_]:
    """Return which outcomes end the episode in a state in which others go on.

    They are hits, `[states, actions, outcomes]`, of some of the states.
    """
    happens = mdp.terminal[part] & (mdp.probability[part] > 0)
    return happens & ~mdp.is_terminal[mdp.next_state[part]]


def transitions(mdp: Mdp) -> Graph:
    """Return the graph of all transitions from one state to another, each pair once."""
    budget.spend(10 * mdp.probability.size)
    # Bytes grow where they are: arrays put together would be there twice.
    sources, targets = bytearray(), bytearray()
    for part in parts_of(mdp.num_states):
        source, target = _moves(mdp, part)
        sources += source.tobytes()
        targets += target.tobytes()
    return Graph(mdp.num_states, np.frombuffer(sources, np.int32), np.frombuffer(targets, np.int32))


def _moves(mdp: Mdp, part: slice) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Return the pairs of a graph that begin in some states."""
    states = np.arange(part.start, part.stop, dtype=np.int32)[:, None]
    happens = (mdp.probability[part] > 0) & ~mdp.is_terminal[part, None, None]
    if mdp.configurations.shape[1]:
        happens &= ~ends_by_hit(mdp, part)
    targets = np.where(happens, mdp.next_state[part], states[:, :, None]).reshape(len(states), -1)
    targets.sort(axis=1)
    moves = targets != states
    moves[:, 1:] &= targets[:, 1:] != targets[:, :-1]
    return np.repeat(states.ravel(), moves.sum(axis=1)), targets[moves]


def situation(level: GridWorld, number: int) -> dict[str, Any]:
    """Return what each thing of a level is in a configuration, by name.

    Items are `"held"`, `"lies"` in their only place, or the cell of those in which they may lie;
    boxes, movers and a drawn exit are the cells in which they are; others are `"on"` or `"off"`,
    `"covered"` or `"not covered"`.
    """
    things, values = level.things(), level.compile().configurations[number].tolist()
    states = [thing.states[value] for thing, value in zip(things, values, strict=True)]
    told = [state if isinstance(state, str) else list(state) for state in states]
    return dict(zip(things.names, told, strict=True))


def situation_words(things: Mapping[str, Any]) -> str:
    """Return a situation in words, without what goes without saying: "key held, bat at [2, 4]"."""
    met = [kind.need.met for kind in NEEDED]
    states = [f"{name} {value}" for name, value in things.items() if value in met]
    return ", ".join([*states, *_places(things)])


def configuration_words(level: GridWorld, number: int) -> str:
    """Return a configuration in words: `while key is held, with bat at [2, 4]`."""
    condition = level.things().condition(level.compile().configurations[number].tolist())
    places = listed(_places(situation(level, number)))
    return ", ".join(filter(None, [condition, places and f"with {places}"]))


def _places(things: Mapping[str, Any]) -> list[str]:
    return [
        f"{name} at [{place[0]}, {place[1]}]"
        for name, place in things.items()
        if isinstance(place, list)
    ]


def told(level: GridWorld, mdp: Mdp, state: int) -> str:
    """Return a state in words, with all that distinguishes it from others.

    Args:
        level: the level.
        mdp: its tables, or those of a robot that turns.
        state: the number of the state in these tables.
    """
    things = situation(level, mdp.configuration(state))
    return ", ".join([state_text(level.things(), mdp, state), *_places(things)])
