"""The states of a level as a robot with a set of actions has them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from babyrobot_levels.analysis.solver.model import Flags, Floats, Ints, Model, build_model
from babyrobot_levels.analysis.solver.results import TURNS, UndefinedReturnError, check_actions
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.mdp.reachability import exit_states
from babyrobot_levels.mdp.states import state_text
from babyrobot_levels.mdp.tables import Mdp


@dataclass(frozen=True, eq=False)
class StateSpace:
    """The tables of a level for a set of actions, and what its states are.

    Attributes:
        level: the level.
        mdp: its tables; with `actions="turns"`, those of a robot that turns.
        actions: `"all"`, `"moves"` or `"turns"`.
    """

    level: GridWorld
    mdp: Mdp
    actions: str

    @property
    def first_action(self) -> int:
        """The action of the tables that is number 0."""
        return check_actions(self.actions)

    @cached_property
    def exits(self) -> Flags:
        """In which states the robot stands on an open exit, `[states]`."""
        return exit_states(self.level, self.mdp)

    @cached_property
    def without_value(self) -> Flags:
        """Which states have no value, `[states]`.

        These are blocked cells, and in a level with things the pairs of configuration and cell
        that no episode reaches.
        """
        mdp = self.mdp
        blocked = self.level.grid().blocked.ravel()
        none = np.tile(blocked, mdp.num_states // blocked.size)
        if mdp.configurations.shape[1]:
            reached = ~mdp.is_terminal
            goes_on = np.flatnonzero(reached)
            reached[mdp.next_state[goes_on][mdp.probability[goes_on] > 0]] = True
            none |= ~reached
        return none

    def text(self, state: int) -> str:
        """Return a state as words, such as `[3, 1] while key is held`."""
        return state_text(self.level.things(), self.mdp, state)

    def cells(self, states: Ints) -> tuple[tuple[int, int], ...]:
        """Return the cells `(x, y)` of some states, each once."""
        return tuple(dict.fromkeys(map(self.mdp.cell, states.tolist())))

    def condition(self, states: Ints) -> str:
        """Return what is held and on in all of some states, as words; empty if it differs."""
        rows = self.mdp.configurations[np.unique(states // (self.mdp.cells * self.mdp.headings))]
        things = self.level.things()
        static = np.unique(rows[:, : things.static], axis=0).tolist()
        conditions = {things.condition(values) for values in static}
        return conditions.pop() if len(conditions) == 1 else ""

    def undefined_return(self, model: Model, unclear: Flags) -> UndefinedReturnError:
        """Return the error that names the first of the unclear states, `[n]`, of a model."""
        state = int(model.states[unclear.argmax()])
        return UndefinedReturnError(self.mdp.cell(state), self.text(state))

    def model(self) -> Model:
        """Return the model that solving works on."""
        return build_model(self.mdp, self.exits, self.first_action)

    def spread(self, model: Model, values: Floats) -> Floats:
        """Return values of a model's states, `[n, …]`, as an array over all states.

        It is shaped as `mdp.shape`, then as the values of a state: 0 in terminal states, nan in
        states without value.
        """
        states = np.where(self.without_value, np.nan, 0.0)
        more = values.shape[1:]
        table = np.repeat(states[:, None], int(np.prod(more)), axis=1)
        table[model.states] = values.reshape(model.size, -1)
        return table.reshape(*self.mdp.shape, *more)

    def at_start(self, model: Model, values: Floats) -> float:
        """Return the expectation of values, `[n]`, over the starts; inf wins over -inf."""
        chances = self.mdp.start[model.states]
        expected = values[chances > 0]
        if np.isposinf(expected).any():
            return float("inf")
        return float(chances[chances > 0] @ expected)


def space_of(level: GridWorld, actions: str) -> StateSpace:
    """Return the states of a level for a set of actions.

    Raises:
        LevelError: the maze has no seed yet.
        ValueError: there is no such set of actions.
    """
    check_actions(actions)
    mdp = level.compile()
    return StateSpace(level, mdp.turning(level.heading) if actions == TURNS else mdp, actions)
