"""The table that the other examples end with: what was learned, beside the best that can be."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import babyrobot_levels as brl

LEAST = 1e-9
"""What is not above this is a difference by rounding."""


def print_comparison(level: brl.Level, learned: Mapping[str, Any], actions: str = "all") -> None:
    """Print what policies are worth in a level, exactly, between random moves and the optimum.

    The share of the optimum is (policy - random) / (optimum - random): 0 % for a policy that is
    worth what random moves are, 100 % for one that cannot be beaten. Returns may be negative, so
    that a plain quotient would say nothing. Where random moves are as good as any, and for what
    may never end, there is no share.

    Args:
        level: the level.
        learned: policies, as `brl.evaluate` takes them, by what they are called.
        actions: `"all"` or `"moves"`, as in the environment.
    """
    policies = {"random moves": "random", **learned, "optimum": brl.solve(level, actions=actions)}
    worth = {name: worth_of(policy, level, actions) for name, policy in policies.items()}
    worst, best = worth["random moves"], worth["optimum"]
    title = f"{level.name}: expected return"
    wide = max(len(title), *map(len, worth))
    print(f"\n{title:{wide}}  {'exactly':>12}  share of the optimum")
    for name, value in worth.items():
        share = "-"
        # Where the robot may walk for ever, its return is -inf.
        if LEAST < best - worst < math.inf and math.isfinite(value):
            share = f"{(value - worst) / (best - worst):.2%}"
        print(f"{name:{wide}}  {value:12.4f}  {share:>20}")


def worth_of(policy: Any, level: brl.Level, actions: str) -> float:
    """Return what a policy is worth, nan if that has no value or floating point cannot tell it."""
    try:
        return brl.evaluate(level, policy, actions=actions).expected_return
    except ArithmeticError:
        return math.nan
