"""What solving, evaluating and simulating answer."""

from __future__ import annotations

import operator
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from babyrobot_levels.analysis.solver.model import Flags, Floats, Ints
from babyrobot_levels.mdp.actions import NUM_ACTIONS, Action

ACTION_SETS = {"all": Action.STAY, "moves": Action.NORTH}
"""The sets of actions, and the action that is number 0 of each."""


class ReadOnly:
    """Makes the arrays of a frozen dataclass read-only."""

    def __post_init__(self) -> None:
        for value in vars(self).values():
            if isinstance(value, np.ndarray):
                value.flags.writeable = False


@dataclass(frozen=True, eq=False)
class Evaluation(ReadOnly):
    """What a policy is worth. All arrays are read-only.

    Actions are numbered as in an environment made with the same `actions`: 0 stay, 1 north,
    2 east, 3 south, 4 west with `"all"`, and 0 north, 1 east, 2 south, 3 west with `"moves"`.
    Adding `first_action` makes either a `brl.Action`.

    Attributes:
        values: the expected return from each cell, float64 `[height, width]`: 0 where the episode
            is over, nan at blocked cells. Without a discount it may be inf or -inf.
        action_values: the same if an action is taken first, float64 `[height, width, actions]`.
        expected_return: the expected return from the level's starts.
        expected_steps: the expected number of steps from the starts to the end of the episode;
            inf if the episode may go on for ever, or for more than 10^10 steps. A level's
            `max_steps` plays no part.
        exit_probability: the probability of reaching an exit from the starts; nan where episodes
            are too long to tell (more than 10^10 steps on average).
        discount: the factor by which each further reward counts less.
        actions: `"all"` or `"moves"`.
    """

    values: Floats
    action_values: Floats
    expected_return: float
    expected_steps: float
    exit_probability: float
    discount: float
    actions: str

    @property
    def first_action(self) -> int:
        """The `brl.Action` that is number 0 here: 0 with `"all"`, 1 with `"moves"`."""
        return int(ACTION_SETS[self.actions])

    @property
    def unbounded(self) -> Flags:
        """Where the return is inf, bool `[height, width]`: a loop that pays can be reached."""
        return np.isposinf(self.values)

    @property
    def endless(self) -> Flags:
        """Where the return is -inf, bool `[height, width]`: it may go on costing for ever."""
        return np.isneginf(self.values)

    def __repr__(self) -> str:
        return (
            f"<{type(self).__name__} expected_return={self.expected_return:.6g} "
            f"expected_steps={self.expected_steps:.6g} "
            f"exit_probability={self.exit_probability:.6g} discount={self.discount:g}>"
        )


@dataclass(frozen=True, eq=False, repr=False)
class Solution(Evaluation):
    """The best that can be done in a level: an `Evaluation` of an optimal policy, and more.

    Attributes:
        greedy: all actions whose values are the best but for a part in 10^9, bool
            `[height, width, actions]`; none at blocked cells and where the episode is over.
        policy: one optimal action for each cell, int64 `[height, width]`; -1 at blocked cells and
            where the episode is over. Among equally good ways it takes one that surely ends, and
            of these a shortest. Following any of the greedy actions may be worth less: where
            there is no discount and a step costs nothing, they may lead round in circles.
        method: how it was found.
        iterations: how many policies were evaluated on the way.
        residual: the largest violation of Bellman's equation among finite values.
    """

    greedy: Flags
    policy: Ints
    method: str
    iterations: int
    residual: float


@dataclass(frozen=True, eq=False)
class Simulation(ReadOnly):
    """Trial runs of a policy. All arrays are read-only.

    Attributes:
        returns: the (discounted) sum of the rewards of each episode, float64 `[episodes]`.
        steps: the number of steps of each episode, int64 `[episodes]`.
        at_exit: which episodes ended on an exit, bool `[episodes]`.
        cut: which episodes were cut off by the limit before they ended, bool `[episodes]`.
        max_steps: the limit.
        discount: the factor by which each further reward counted less.
    """

    returns: Floats
    steps: Ints
    at_exit: Flags
    cut: Flags
    max_steps: int
    discount: float

    @property
    def mean(self) -> float:
        """The mean of the returns."""
        return float(self.returns.mean())

    @property
    def standard_error(self) -> float:
        """The standard error of `mean`; nan for a single episode."""
        if self.returns.size < 2:
            return float("nan")
        return float(self.returns.std(ddof=1) / np.sqrt(self.returns.size))

    @property
    def exit_rate(self) -> float:
        """The share of the episodes that ended on an exit."""
        return float(self.at_exit.mean())

    @property
    def truncated(self) -> int:
        """How many episodes were cut off by the limit before they ended."""
        return int(self.cut.sum())

    def __repr__(self) -> str:
        return (
            f"<Simulation of {self.returns.size} episodes: mean={self.mean:.6g} "
            f"standard_error={self.standard_error:.3g} exit_rate={self.exit_rate:.6g} "
            f"truncated={self.truncated}>"
        )


def check_actions(actions: str) -> int:
    """Return the action that is number 0 of a set of actions.

    Raises:
        ValueError: there is no such set.
    """
    if actions not in ACTION_SETS:
        raise ValueError(f"actions must be 'all' or 'moves', not {actions!r}")
    return int(ACTION_SETS[actions])


def check_discount(discount: float | None, default: float) -> float:
    """Return the discount that counts.

    Raises:
        ValueError: it is not above 0 and at most 1.
    """
    if discount is None:
        return float(default)
    # Numbers of all kinds are compared; what is none cannot be.
    with suppress(TypeError):
        if 0 < discount <= 1:
            return float(discount)
    raise ValueError(f"discount must be above 0 and at most 1, not {discount!r}")


def check_seed(seed: int | None) -> int | None:
    """Return a seed as an int, None for None.

    Raises:
        ValueError: it is no whole number from 0 on.
    """
    if seed is None:
        return None
    with suppress(TypeError):
        if operator.index(seed) >= 0:
            return operator.index(seed)
    raise ValueError(f"seed must be a whole number from 0 on, not {seed!r}")


def num_actions(actions: str) -> int:
    """Return how many actions a set has."""
    return NUM_ACTIONS - check_actions(actions)
