"""The tables of a level with several robots: a search over the joint states that occur."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.mdp.actions import NUM_ACTIONS
from babyrobot_levels.mdp.compiler.assembly import assembled
from babyrobot_levels.mdp.compiler.layers import TooManyStates
from babyrobot_levels.mdp.compiler.robots import Part, Robots
from babyrobot_levels.mdp.configurations import MAX_WIDE_STATES
from babyrobot_levels.mdp.graph import differs
from babyrobot_levels.mdp.tables import FREE, Ints, Mdp
from babyrobot_levels.text import budget
from babyrobot_levels.text.diagnostics import Issue, Key
from babyrobot_levels.text.errors import UnplayableError

SAMPLES = 16
"""Of how many states all joint actions are taken, to see how many outcomes they have."""


MOST = NUM_ACTIONS * MAX_WIDE_STATES
"""The most states times joint actions times outcomes of one: the tables keep that room."""


def exceed(robots: Robots, most: float = MOST) -> bool:
    """Return whether tables are surely larger than allowed, which takes little time to find out.

    Only one robot moves at a time, so that not all of the configurations are found that occur: if
    it is False, they may be too large all the same.

    Args:
        robots: the robots.
        most: how many states times joint actions times outcomes of one there may be.
    """
    if robots.num_states * robots.num_actions <= most:
        return False
    own = NUM_ACTIONS ** np.arange(robots.num_robots - 1, -1, -1)[:, None] * np.arange(NUM_ACTIONS)
    enough = most // (robots.cells * robots.num_actions)
    begins = np.unique(robots.begins)
    if len(set(begins // robots.cells)) > enough:
        return True
    # The first robot walks: configurations do not tell where it is, but what it has changed.
    states = waiting = begins
    while waiting.size and states.size <= robots.cells * enough:
        waiting = np.setdiff1d(_following(robots, waiting, own[0]), states)
        states = np.union1d(states, waiting)
    known, first = np.unique(states // robots.cells, return_index=True)
    waiting = found = states[first]
    while waiting.size and known.size <= enough:
        states = _following(robots, waiting, own[1:].ravel())
        configurations, first = np.unique(states // robots.cells, return_index=True)
        waiting = states[first[~np.isin(configurations, known)]]
        known, found = np.union1d(known, configurations), np.union1d(found, waiting)
    width = 1
    for part in robots.steps(found[:: max(1, found.size // SAMPLES)]):
        width = max(width, _width(part))
    return known.size * width > enough


def _following(robots: Robots, states: Ints, actions: Ints) -> Ints:
    """Return the states to which some joint actions lead, and in which episodes go on."""
    parts = robots.steps(states, actions)
    return np.unique(np.concatenate([part.following[~part.terminal] for part in parts]))


def _width(part: Part) -> int:
    """Return how many outcomes a joint action has at most."""
    return int(np.unique(part.row, return_counts=True)[1].max(initial=1))


class JointTables:
    """All joint states that episodes can come to, in a level with several robots, as tables.

    Args:
        robots: the robots.

    Raises:
        TooManyStates: there are more states than the bound.
    """

    def __init__(self, robots: Robots):
        self.robots, self.size, self.actions = robots, robots.cells, robots.num_actions
        self.parts: list[Part] = []
        most = NUM_ACTIONS * min(MAX_WIDE_STATES, budget.entries())
        if exceed(robots, most):
            raise TooManyStates
        self.keys = self._search(most)

    def _search(self, most: float) -> Ints:
        """Take all steps, part by part; return the numbers of all states, in rising order."""
        known = np.unique(self.robots.begins)
        waiting, ended, outcomes = known, known[:0], 0
        while waiting.size:
            found = []
            for part in self.robots.steps(waiting):
                self.parts.append(part)
                outcomes += part.row.size
                if outcomes > most:
                    raise TooManyStates
                found.append(np.unique(part.following[~part.terminal]))
                ended = np.union1d(ended, part.following[part.terminal])
            waiting = np.setdiff1d(np.concatenate(found), known)
            known = np.union1d(known, waiting)
            # The tables have a row for each cell of each configuration, and each joint action.
            configurations = np.unique(known // self.size).size
            if configurations * self.size * self.actions > most:
                raise TooManyStates
        return np.union1d(known, ended)

    @cached_property
    def _numbering(self) -> tuple[NDArray[np.int16], Ints, Ints]:
        """Return the configurations, the places of `keys` without cells, and their numbers."""
        places = np.unique(self.keys // self.size)
        rows = self.robots.configurations[places]
        order = np.lexsort(rows.T[::-1])
        number = np.empty(order.size, np.int64)
        number[order] = np.arange(order.size)
        return rows[order], places, number

    @property
    def num_states(self) -> int:
        """How many states the tables have."""
        return len(self._numbering[0]) * self.size

    def _states(self, keys: Ints) -> Ints:
        """Return the numbers that joint states have in the tables."""
        _, places, number = self._numbering
        states: Ints = number[np.searchsorted(places, keys // self.size)] * self.size
        return states + keys % self.size

    def tables(self) -> Mdp:
        """Return the tables.

        Raises:
            UnplayableError: they need more room than those of any level may.
            OverBudgetError: they need more than they may here.
        """
        count, width = self.num_states, 1
        for part in self.parts:
            width = max(width, _width(part))
        self._check_room(count, width)
        shape = count, self.actions, width
        probability, reward = np.zeros(shape), np.zeros(shape)
        next_state, terminal = np.zeros(shape, np.int32), np.zeros(shape, bool)
        shares = np.zeros((*shape, self.robots.num_robots))
        over = np.ones(count, bool)
        obstruction = np.full((count, self.actions), FREE, np.int8)
        intended = np.repeat(np.arange(count, dtype=np.int32)[:, None], self.actions, axis=1)
        for part in self.parts:
            states = self._states(part.states)
            over[states] = False
            obstruction[states] = part.obstruction
            there = (states - states % self.size)[:, None] + part.intended
            intended[states] = np.where(part.intended < 0, count - 1 - part.intended, there)
            state, action = np.divmod(part.row, self.actions)
            row = self._states(state) * self.actions + action
            following = self._states(part.following)
            order = part.order(row, following)
            row = row[order]
            begin = np.flatnonzero(differs(row))
            slot = np.arange(row.size) - np.repeat(begin, np.diff(np.append(begin, row.size)))
            place = row * width + slot
            probability.reshape(-1)[place] = part.probability[order]
            next_state.reshape(-1)[place] = following[order]
            reward.reshape(-1)[place] = part.total[order]
            terminal.reshape(-1)[place] = part.terminal[order]
            shares.reshape(-1, self.robots.num_robots)[place] = part.shares[order]
        start = np.zeros(count)
        weights = np.array(self.robots.weights) / sum(self.robots.weights)
        np.add.at(start, self._states(self.robots.begins), weights)
        return assembled(
            self.robots.grid,
            start=start,
            over=over,
            intended=intended,
            obstruction=obstruction,
            tables={
                "probability": probability,
                "next_state": next_state,
                "reward": reward,
                "terminal": terminal,
            },
            configurations=self._numbering[0],
            drawn=self.robots.drawn,
            shares=shares,
        )

    def _check_room(self, states: int, width: int) -> None:
        """Check that the tables do not need too much room."""
        budget.check_tables(states, width, self.actions)
        if states * self.actions // NUM_ACTIONS * width <= MAX_WIDE_STATES:
            return
        message = (
            f"the tables are too large: {states:,} joint states, {self.actions} joint actions, "
            f"and {width} outcomes of one; "
            f"together at most {NUM_ACTIONS * MAX_WIDE_STATES:,} are allowed"
        )
        help_text = "use fewer robots, a smaller level, or less that happens by chance"
        raise UnplayableError([Issue("BR404", Key(("robots",)), message, help_text)])
