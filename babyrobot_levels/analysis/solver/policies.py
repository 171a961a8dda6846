"""Policies in all forms that functions take, read into one table of probabilities."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from babyrobot_levels.analysis.solver.model import Flags, Floats
from babyrobot_levels.analysis.solver.results import num_actions
from babyrobot_levels.mdp.actions import NUM_ACTIONS, NUM_MOVES, Action, HasPolicy, unwrapped_policy
from babyrobot_levels.mdp.tables import Mdp
from babyrobot_levels.text.words import did_you_mean

Policy = str | ArrayLike | Callable[[int, int], int] | HasPolicy
"""The forms of a policy; see `read_policy`."""

NAMED = ("random", "uniform")


def looks_like_moves(policy: Any) -> bool:
    """Return whether a policy is a plain array of actions that could be meant without stay."""
    if isinstance(policy, str) or callable(policy) or hasattr(policy, "first_action"):
        return False
    table = np.asarray(policy)
    return table.ndim == 2 and table.dtype.kind in "iu" and bool((table < NUM_MOVES).all())


def read_policy(policy: Any, mdp: Mdp, actions: str) -> Floats:
    """Return a policy as probabilities, `[states, actions]`; zeros at terminal states.

    Args:
        policy: one of

            - `"random"`: all actions that are possible where the robot stands, evenly, as
              `env.action_space.sample()` draws them; where none is (an enclosed cell, without
              `stay`), all of them;
            - `"uniform"`: all actions evenly, also those that a wall refuses;
            - an array of ints `[height, width]`: an action for each cell;
            - an array `[height, width, actions]` or `[states, actions]` of probabilities;
            - a function that is called with `x, y` and returns an action;
            - a `Solution`, or a `Sweep` of learning, or the `policy` of one.
        mdp: the level's tables.
        actions: the set of actions, `"all"` or `"moves"`. It also numbers the actions of a policy
            that does not carry its own set.

    Raises:
        ValueError: it is none of these, or does not fit the level.
    """
    count = num_actions(actions)
    if isinstance(policy, str):
        return _named(policy, mdp, count)
    policy, first_action = unwrapped_policy(policy)
    first = NUM_ACTIONS - count if first_action is None else first_action
    if callable(policy):
        policy = _called(policy, mdp)
    table = np.asarray(policy)
    shape = (mdp.height, mdp.width)
    if table.shape == shape:
        return _chosen(table.ravel(), mdp, actions, first)
    if table.shape in ((*shape, count), (mdp.num_states, count)):
        return _weighed(table.reshape(-1, count), mdp)
    message = (
        f"a policy for this level and actions={actions!r} is an array {list(shape)} of actions, or "
        f"an array {[*shape, count]} or {[mdp.num_states, count]} of probabilities, "
        f"not one of shape {list(table.shape)}"
    )
    other, others = ("moves", NUM_MOVES) if actions == "all" else ("all", NUM_ACTIONS)
    if table.shape in ((*shape, others), (mdp.num_states, others)):
        message += f"; {others} probabilities for each cell need actions={other!r}"
    raise ValueError(message)


def _named(name: str, mdp: Mdp, count: int) -> Floats:
    if name not in NAMED:
        known = " or ".join(map(repr, NAMED))
        raise ValueError(
            f"a policy given by name is {known}, not {name!r}{did_you_mean(name, NAMED)}; "
            "the optimal one is `brl.solve(level)`"
        )
    weights = np.ones((mdp.num_states, count))
    if name == "random":
        possible = mdp.action_mask[:, -count:]
        weights = np.where(possible.any(axis=1, keepdims=True), possible, weights)
    even: Floats = weights / weights.sum(axis=1, keepdims=True)
    even[mdp.is_terminal] = 0.0
    return even


def _called(function: Callable[[int, int], Any], mdp: Mdp) -> Any:
    table = np.zeros((mdp.height, mdp.width), np.int64)
    for state in np.flatnonzero(~mdp.is_terminal).tolist():
        y, x = divmod(state, mdp.width)
        action = function(x, y)
        try:
            table[y, x] = operator.index(action)
        except TypeError:
            raise ValueError(f"the policy's action at [{x}, {y}] is {action!r}") from None
    return table


def _chosen(table: np.ndarray[Any, Any], mdp: Mdp, actions: str, first: int) -> Floats:
    """Return the probabilities of a policy given by actions, of which `first` is number 0."""
    if not np.issubdtype(table.dtype, np.integer):
        raise ValueError("a policy [height, width] is an array of integers, the actions")
    count = num_actions(actions)
    states = np.flatnonzero(~mdp.is_terminal)
    chosen = table[states].astype(np.int64) + first - (NUM_ACTIONS - count)
    wrong = (chosen < 0) | (chosen >= count)
    if wrong.any():
        number, cell = int(table[states][wrong][0]), _cell(states, wrong, mdp)
        if number >= 0 and number + first < NUM_ACTIONS:
            name = Action(number + first).name.lower()
            raise ValueError(
                f"the policy's action at {cell} is {name}, which actions={actions!r} does not have"
            )
        known = ", ".join(
            f"{action - first} {action.name.lower()}" for action in Action if action >= first
        )
        message = f"the policy's action at {cell} is {number}; actions={actions!r} has {known}"
        if actions == "moves" and 0 <= number < NUM_ACTIONS:
            message += "; if its action 0 is stay, give actions='all'"
        raise ValueError(message)
    weights = np.zeros((mdp.num_states, count))
    weights[states, chosen] = 1.0
    return weights


def _weighed(table: np.ndarray[Any, Any], mdp: Mdp) -> Floats:
    states = np.flatnonzero(~mdp.is_terminal)
    weights = np.zeros(table.shape)
    weights[states] = table[states]
    total = weights[states].sum(axis=1)
    wrong = ~((weights[states] >= 0).all(axis=1) & (np.abs(total - 1) < 1e-6))
    if wrong.any():
        raise ValueError(
            f"the policy's probabilities at {_cell(states, wrong, mdp)} are "
            f"{table[states][wrong][0].tolist()}; they must not be negative and add up to 1"
        )
    weights[states] /= total[:, None]
    return weights


def _cell(states: Any, wrong: Flags, mdp: Mdp) -> str:
    y, x = divmod(int(states[wrong][0]), mdp.width)
    return f"[{x}, {y}]"
