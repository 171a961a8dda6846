"""The ways of telling a policy, read into one table of probabilities."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from babyrobot_levels.analysis.solver.model import Flags, Floats
from babyrobot_levels.analysis.solver.results import num_actions
from babyrobot_levels.mdp.actions import NUM_ACTIONS, HasPolicy, unwrapped_policy
from babyrobot_levels.mdp.tables import Mdp
from babyrobot_levels.text.words import did_you_mean

Policy = str | ArrayLike | Callable[[int, int], int] | HasPolicy
"""How a policy can be told; see `read_policy`."""

WORDS = ("random", "uniform")


def read_policy(policy: Any, mdp: Mdp, actions: str) -> Floats:
    """Return a policy as probabilities, `[states, actions]`; zeros where the episode is over.

    Args:
        policy: one of

            - `"random"`: all actions that are possible where the robot stands, evenly, as
              `env.action_space.sample()` draws them; where none is (a cell shut in, without
              `stay`), all of them;
            - `"uniform"`: all actions evenly, also those that a wall refuses;
            - an array of ints `[height, width]`: an action for each cell;
            - an array `[height, width, actions]` or `[states, actions]` of probabilities;
            - a function that is called with `x, y` and returns an action;
            - a `Solution`, or a `Sweep` of learning, whose policy it is.
        mdp: the level's tables.
        actions: the set of actions that the policy's numbers mean, `"all"` or `"moves"`.

    Raises:
        ValueError: it is none of these, or does not fit the level.
    """
    count = num_actions(actions)
    if isinstance(policy, str):
        return _in_words(policy, mdp, count)
    policy, first_action = unwrapped_policy(policy)
    first = 0 if first_action is None else first_action - (NUM_ACTIONS - count)
    if callable(policy):
        policy = _called(policy, mdp)
    table = np.asarray(policy)
    if table.shape == (mdp.height, mdp.width):
        return _chosen(table.ravel(), mdp, count, first)
    if table.shape in ((mdp.height, mdp.width, count), (mdp.num_states, count)):
        return _weighed(table.reshape(-1, count), mdp)
    raise ValueError(
        f"a policy for this level and actions={actions!r} is an array "
        f"[{mdp.height}, {mdp.width}] of actions, or an array [{mdp.height}, {mdp.width}, {count}] "
        f"or [{mdp.num_states}, {count}] of probabilities, not one of shape {list(table.shape)}"
    )


def _in_words(word: str, mdp: Mdp, count: int) -> Floats:
    if word not in WORDS:
        known = " or ".join(map(repr, WORDS))
        raise ValueError(
            f"a policy in a word is {known}, not {word!r}{did_you_mean(word, WORDS)}; "
            "the best one is what `brl.solve(level)` returns"
        )
    weights = np.ones((mdp.num_states, count))
    if word == "random":
        possible = mdp.possible[:, -count:]
        weights = np.where(possible.any(axis=1, keepdims=True), possible, weights)
    even: Floats = weights / weights.sum(axis=1, keepdims=True)
    even[mdp.over] = 0.0
    return even


def _called(function: Callable[[int, int], Any], mdp: Mdp) -> Any:
    table = np.zeros((mdp.height, mdp.width), np.int64)
    for state in np.flatnonzero(~mdp.over).tolist():
        y, x = divmod(state, mdp.width)
        action = function(x, y)
        try:
            table[y, x] = operator.index(action)
        except TypeError:
            raise ValueError(f"the policy's action at [{x}, {y}] is {action!r}") from None
    return table


def _chosen(table: np.ndarray[Any, Any], mdp: Mdp, count: int, first: int) -> Floats:
    """Return the probabilities of a policy that names actions, of which `first` is number 0."""
    if not np.issubdtype(table.dtype, np.integer):
        raise ValueError("a policy [height, width] is an array of whole numbers, the actions")
    states = np.flatnonzero(~mdp.over)
    chosen = table[states].astype(np.int64) + first
    wrong = (chosen < 0) | (chosen >= count)
    if wrong.any():
        raise ValueError(
            f"the policy's action at {_cell(states, wrong, mdp)} is {table[states][wrong][0]}; "
            f"here, the actions are {-first} to {count - 1 - first}"
        )
    weights = np.zeros((mdp.num_states, count))
    weights[states, chosen] = 1.0
    return weights


def _weighed(table: np.ndarray[Any, Any], mdp: Mdp) -> Floats:
    states = np.flatnonzero(~mdp.over)
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
