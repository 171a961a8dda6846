"""The table at the end of the other examples: what was learned, compared with the optimum."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

import babyrobot_levels as brl

LEAST = 1e-9
"""Differences up to this are rounding errors."""


def print_comparison(level: brl.Level, learned: Mapping[str, Any], actions: str = "all") -> None:
    """Print the exact expected returns of policies, with random moves and the optimum.

    The share of the optimum is (policy - random) / (optimum - random): 0 % for random moves, 100 %
    for an optimal policy. Returns can be negative, so a plain quotient would not be useful. There
    is no share if random moves are optimal, or if the policy may never end.

    Args:
        level: the level.
        learned: by their names, policies, as `brl.evaluate` takes them, or mean returns of trials.
        actions: `"all"` or `"moves"`, as in the environment.
    """
    policies = {"random moves": "random", **learned, "optimum": brl.solve(level, actions=actions)}
    returns = {name: return_of(policy, level, actions) for name, policy in policies.items()}
    print_shares(f"{level.name}: expected return", "exactly", returns)


def print_mean_comparison(
    levels: Sequence[brl.Level], learned: Mapping[str, Any], steps: int, actions: str = "all"
) -> None:
    """Print the mean returns of policies in several levels, with random moves and the optimum.

    Args:
        levels: the levels; one episode is played in each.
        learned: lists of policies, one for each level, by their names.
        steps: the time limit of the episodes.
        actions: `"all"` or `"moves"`.
    """
    optimum = np.array([brl.solve(each, actions=actions).expected_return for each in levels])
    returns = {"random moves": returns_in(levels, "random", steps, actions)}
    for name, policies in learned.items():
        returns[name] = returns_in(levels, policies, steps, actions)
        print(f"{name}: optimal in {(returns[name] >= optimum - LEAST).mean():.1%} of the levels")
    means = {name: each.mean() for name, each in {**returns, "optimum": optimum}.items()}
    print_shares(f"{len(levels)} levels: mean return", f"{steps} steps", means)


def print_teams(level: brl.Level, learned: Mapping[str, Any], discount: float) -> None:
    """Print the exact returns of teams, and what each robot could get more if it alone changed.

    Args:
        level: a level with several robots.
        learned: by their names, policies of all robots, as `brl.score_team` takes them.
        discount: the factor by which each further reward counts less.
    """
    scores = {name: brl.score_team(level, each, discount) for name, each in learned.items()}
    random = brl.score_team(level, "random", discount)
    returns = {name: each.expected_return for name, each in scores.items()}
    returns = {"random moves": random.expected_return, **returns, "optimum": random.best_return}
    print_shares(f"{level.name}: return of the team, discount {discount:g}", "exactly", returns)
    for name, score in scores.items():
        regrets = ", ".join(f"{each.name} {each.regret:.3f}" for each in score.robots)
        print(f"regrets, {name}: {regrets}")


def print_shares(title: str, heading: str, returns: Mapping[str, float]) -> None:
    """Print returns, and how they share the way from random moves to the optimum."""
    worst, best = returns["random moves"], returns["optimum"]
    wide = max(len(title), *map(len, returns))
    print(f"\n{title:{wide}}  {heading:>12}  share of the optimum")
    for name, value in returns.items():
        share = "-"
        # The return of a policy that may never end is -inf.
        if LEAST < best - worst < math.inf and math.isfinite(value):
            share = f"{(value - worst) / (best - worst):.2%}"
        print(f"{name:{wide}}  {value:12.4f}  {share:>20}")


def returns_in(
    levels: Sequence[brl.Level], policies: Any, steps: int, actions: str
) -> NDArray[np.float64]:
    """Return the return of an episode in each level, float64 `[levels]`."""
    data = brl.rollout(
        levels, policies, len(levels), steps, seed=0, actions=actions, max_episode_steps=steps
    )
    over = data.terminations | data.truncations
    # Until the end of the first episode, and with the step that ends it.
    is_first = np.cumsum(over, axis=0) == over
    return np.asarray((data.rewards * is_first).sum(axis=0))


def return_of(policy: Any, level: brl.Level, actions: str) -> float:
    """Return the expected return of a policy, nan if it is undefined or cannot be computed."""
    if isinstance(policy, float):
        return policy
    with warnings.catch_warnings():
        # What has been learned may never end: its return, -inf, is in the table.
        warnings.simplefilter("ignore", RuntimeWarning)
        try:
            return brl.evaluate(level, policy, actions=actions).expected_return
        except ArithmeticError:
            return math.nan


def actions_in_cells(
    level: brl.Level, act: Callable[[Any], Any], **kwargs: Any
) -> NDArray[np.int64]:
    """Return the action in each cell of a level without things, `[height, width]`.

    Args:
        level: the level.
        act: a function that returns the action at an observation.
        kwargs: the arguments of the environment.
    """
    env = level.make(**kwargs)
    width, height = level.size
    actions = np.zeros((height, width), np.int64)
    for y, x in np.ndindex(height, width):
        try:
            observation, _ = env.reset(options={"start": [x, y]})
        except ValueError:
            # The robot cannot stand there, or the episode would be over.
            continue
        actions[y, x] = act(observation)
    return actions
