"""The states of a level, and policies in all forms, read into one table of probabilities."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from babyrobot_levels import mdp as room
from babyrobot_levels.analysis.solver.model import (
    Model,
    build_model,
    largest_reward,
    places,
    too_large_to_add_up,
)
from babyrobot_levels.analysis.solver.results import (
    TURNS,
    EpisodeTooLongError,
    UndefinedReturnError,
    action_names,
    check_actions,
)
from babyrobot_levels.mdp.actions import NUM_MOVES, HasPolicy, unwrapped_policy
from babyrobot_levels.mdp.configurations import Things
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.mdp.states import exit_states, state_text
from babyrobot_levels.mdp.tables import Flags, Floats, Ints, Mdp
from babyrobot_levels.text import budget
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.words import BEST, NAMED, RANDOM, did_you_mean, is_agent

Policy = str | PathLike[str] | Mapping[str, Any] | ArrayLike | Callable[..., Any] | HasPolicy
"""The forms of a policy; see `read_policy`."""


MAX_NAME = 100
"""The most characters that are shown of what is no name of an action."""


def looks_like_moves(policy: Any, axes: int) -> bool:
    """Return whether a policy is a plain array of actions that could be meant without stay.

    Args:
        policy: the policy.
        axes: how many axes an array over states has.
    """
    if isinstance(policy, str) or callable(policy) or hasattr(policy, "first_action"):
        return False
    table = np.asarray(policy)
    return table.ndim == axes and table.dtype.kind in "iu" and bool((table < NUM_MOVES).all())


def read_policy(policy: Any, space: StateSpace) -> Floats:
    """Return a policy as probabilities, `[states, actions]`; zeros at terminal states.

    Args:
        policy: one of

            - `"best"`: an optimal policy without a limit of steps;
            - `"random"`: all actions that are possible where the robot stands, evenly, as
              `env.action_space.sample()` draws them; where none is (an enclosed cell, without
              `stay`), all of them;
            - `"uniform"`: all actions evenly, also those that a wall refuses;
            - an array `[height, width]` or `[states]` of ints, or of names such as `"north"`: an
              action for each cell;
            - an array `[height, width, actions]` or `[states, actions]` of probabilities;
            - a `Solution`, or a `Sweep` of learning, or the `policy` of one;
            - another agent without memory that `brl.score` takes: a function from an observation
              of the position to an action, the name of a file, a model.

            In a level with things, arrays have an axis of configurations before height. A robot
            that turns has an axis of headings before height.
        space: the level's states. The set of actions numbers those of a policy that does not
            carry its own set.

    Raises:
        TypeError: it is none of these.
        ValueError: it does not fit the level.
    """
    mdp, actions, things = space.mdp, space.actions, space.level.things()
    count = space.num_actions
    if isinstance(policy, str) and policy in NAMED:
        return _named(policy, space)
    own = getattr(policy, "actions", None)
    policy, first_action = unwrapped_policy(policy)
    first = check_actions(actions) if first_action is None else first_action
    if first_action is not None and (own == TURNS) != (actions == TURNS):
        raise ValueError(
            f"the policy is one for actions={own!r}, not for actions={actions!r}; "
            f"give actions={own!r}"
        )
    if is_agent(policy) or isinstance(policy, str | PathLike | Mapping):
        policy = room.public("policy_table")(space.level, policy, actions=actions)
    table, shape = np.asarray(policy), mdp.shape
    if table.dtype.kind == "U" and table.size == mdp.num_states:
        table = _numbered(table, action_names(actions, mdp)[first:])
    if table.shape in (shape, (mdp.num_states,)):
        return _chosen(table.ravel(), space, first, things)
    if table.shape in ((*shape, count), (mdp.num_states, count)):
        return _weighed(table.reshape(-1, count), mdp, things)
    given = f"one of shape {list(table.shape)}" if table.ndim else repr(table.item())[:MAX_NAME]
    message = (
        f"a policy for this level and actions={actions!r} is an array {list(shape)} of actions, or "
        f"an array {[*shape, count]} or {[mdp.num_states, count]} of probabilities, not {given}"
    )
    other, others = ("moves", count - 1) if actions == "all" else ("all", count + 1)
    if actions != TURNS and table.shape in ((*shape, others), (mdp.num_states, others)):
        message += f"; {others} probabilities for each cell need actions={other!r}"
    if shape[-1] != shape[-2] and table.shape == (*shape[:-2], shape[-1], shape[-2]):
        message += "; rows come first: policy[y, x]"
    if table.shape[1:] == shape:
        message += f": these are {len(table)} arrays, give the policy alone"
    raise ValueError(message)


def _numbered(table: np.ndarray[Any, Any], names: Sequence[str]) -> np.ndarray[Any, Any]:
    """Return an array of the names of actions as one of numbers.

    Raises:
        ValueError: there is no such action.
    """
    for name in dict.fromkeys(table.ravel().tolist()):
        if name.lower() not in names:
            name = name[:MAX_NAME]
            raise ValueError(
                f"{name!r} is none of the actions {', '.join(names)}, or of their numbers 0 to "
                f"{len(names) - 1}{did_you_mean(name, names)}"
            )
    numbers: np.ndarray[Any, Any] = np.array(
        [names.index(name.lower()) for name in table.ravel().tolist()], np.int64
    )
    return numbers.reshape(table.shape)


def _named(name: str, space: StateSpace) -> Floats:
    mdp, count = space.mdp, space.num_actions
    if name == BEST:
        best = room.public("solve")(space.level, space.discount, actions=space.actions)
        return read_policy(best, space)
    weights = np.ones((mdp.num_states, count))
    if name == RANDOM:
        possible = mdp.action_mask[:, -count:]
        weights = np.where(possible.any(axis=1, keepdims=True), possible, weights)
    even: Floats = weights / weights.sum(axis=1, keepdims=True)
    even[mdp.is_terminal] = 0.0
    return even


def _chosen(table: np.ndarray[Any, Any], space: StateSpace, first: int, things: Things) -> Floats:
    """Return the probabilities of a policy given by actions, of which `first` is number 0."""
    mdp, actions = space.mdp, space.actions
    if not np.issubdtype(table.dtype, np.integer):
        axes = ["configurations"] * bool(things.names) + ["headings"] * (mdp.headings > 1)
        shape = ", ".join([*axes, "height", "width"])
        raise ValueError(
            f"a policy [{shape}] is an array of actions, integers or names, not of values such as "
            f"{repr(table.tolist()[0])[:MAX_NAME]}"
        )
    count, names = space.num_actions, action_names(actions, mdp)
    states = np.flatnonzero(~mdp.is_terminal)
    chosen = table[states].astype(np.int64) + first - check_actions(actions)
    wrong = (chosen < 0) | (chosen >= count)
    if wrong.any():
        number, cell = int(table[states][wrong][0]), _place(states, wrong, mdp, things)
        if number >= 0 and number + first < len(names):
            raise ValueError(
                f"the policy's action at {cell} is {names[number + first]}, which "
                f"actions={actions!r} does not have"
            )
        known = ", ".join(f"{action} {name}" for action, name in enumerate(names[first:]))
        if mdp.num_robots > 1:
            known = f"0 {names[0]} to {count - 1} {names[-1]}"
        message = f"the policy's action at {cell} is {number}; actions={actions!r} has {known}"
        if actions == "moves" and 0 <= number <= count:
            message += "; if its action 0 is stay, give actions='all'"
        raise ValueError(message)
    weights = np.zeros((mdp.num_states, count))
    weights[states, chosen] = 1.0
    return weights


def _weighed(table: np.ndarray[Any, Any], mdp: Mdp, things: Things) -> Floats:
    states = np.flatnonzero(~mdp.is_terminal)
    weights = np.zeros(table.shape)
    weights[states] = table[states]
    total = weights[states].sum(axis=1)
    wrong = ~((weights[states] >= 0).all(axis=1) & (np.abs(total - 1) < 1e-6))
    if wrong.any():
        message = (
            f"the policy's probabilities at {_place(states, wrong, mdp, things)} are "
            f"{table[states][wrong][0].tolist()}; they must not be negative and add up to 1"
        )
        if wrong.all():
            message += "; of action values, give the largest ones: values.argmax(axis=-1)"
        raise ValueError(message)
    weights[states] /= total[:, None]
    return weights


def _place(states: Any, wrong: Flags, mdp: Mdp, things: Things) -> str:
    """Return the first of the wrong states as words."""
    return state_text(things, mdp, int(states[wrong][0]))


GRAPHS = 60
"""The steps of work for each outcome to find out what leads where."""


@dataclass(frozen=True, eq=False)
class StateSpace:
    """The tables of a level for a set of actions, and what its states are.

    Attributes:
        level: the level.
        mdp: its tables; with `actions="turns"`, those of a robot that turns.
        actions: `"all"`, `"moves"` or `"turns"`.
        discount: the discount of the policy `"best"`; None for the level's.
    """

    level: GridWorld
    mdp: Mdp
    actions: str
    discount: float | None = None

    @property
    def first_action(self) -> int:
        """The action of the tables that is number 0."""
        return check_actions(self.actions)

    @property
    def num_actions(self) -> int:
        """How many actions there are."""
        return self.mdp.num_actions - self.first_action

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

    @cached_property
    def largest_reward(self) -> float:
        """The largest reward of a step, or cost."""
        return largest_reward(self.mdp)

    @property
    def reached(self) -> Ints:
        """The states that go on, and in which episodes start or to which another one leads."""
        mdp = self.mdp
        goes_on = np.flatnonzero(~mdp.is_terminal)
        rows = goes_on, slice(self.first_action, None)
        following = mdp.next_state[rows]
        is_reached = mdp.start > 0
        is_elsewhere = following != goes_on[:, None, None]
        is_reached[following[(mdp.probability[rows] > 0) & is_elsewhere]] = True
        return np.flatnonzero(is_reached & ~mdp.is_terminal)

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
        """Return the model that solving works on.

        Raises:
            EpisodeTooLongError: rewards are too large to add up.
            OverBudgetError: there are more states than the budget at hand allows.
        """
        budget.spend(GRAPHS * self.mdp.probability.size)
        if reason := too_large_to_add_up(self.largest_reward):
            raise EpisodeTooLongError(reason)
        return build_model(self.mdp, self.exits, self.first_action)

    @cached_property
    def _over(self) -> Ints:
        """The states that a model leaves out."""
        return np.flatnonzero(self.mdp.is_terminal)

    @cached_property
    def _none(self) -> Floats:
        """What these have for a value."""
        return np.where(self.without_value[self._over], np.nan, 0.0)

    def spread(self, model: Model, values: Floats) -> Floats:
        """Return values of a model's states, `[n, …]`, as an array over all states.

        It is shaped as `mdp.shape`, then as the values of a state: 0 in terminal states, nan in
        states without value.
        """
        none = self._none.reshape(-1, *[1] * (values.ndim - 1))
        table: Floats = self.of_states(model, values, none)
        return table

    def of_states(self, model: Model, values: NDArray[Any], others: Any) -> NDArray[Any]:
        """Return the same with other values, one or one for each, for all other states."""
        table = np.empty((self.mdp.num_states, *values.shape[1:]), values.dtype)
        table[places(model.states)] = values
        table[self._over] = others
        return table.reshape(*self.mdp.shape, *values.shape[1:])

    def at_start(self, model: Model, values: Floats) -> float:
        """Return the expectation of values, `[n]`, over the starts; inf wins over -inf."""
        chances = self.mdp.start[places(model.states)]
        starts = np.flatnonzero(chances)
        expected = values[starts]
        if np.isposinf(expected).any():
            return float("inf")
        return float(chances[starts] @ expected)


def space_of(level: GridWorld, actions: str, discount: float | None = None) -> StateSpace:
    """Return the states of a level for a set of actions; the discount is that of `"best"`.

    Raises:
        LevelError: the maze has no seed yet, or several robots do not have these actions.
        ValueError: there is no such set of actions.
    """
    check_actions(actions)
    mdp = level.compile()
    if mdp.num_robots > 1 and actions != "all":
        raise LevelError(message=f"several robots have actions='all', not {actions!r}")
    own = mdp.turning(level.heading) if actions == TURNS else mdp
    return StateSpace(level, own, actions, discount)
