"""Policies that workers of tests import."""

from __future__ import annotations

from typing import Any

import babyrobot_levels as brl


def optimal(level: brl.Level) -> Any:
    """Return an optimal policy."""
    return brl.solve(level)


def optimal_but(name: str, level: brl.Level) -> Any:
    """Return an optimal policy, or fail in the level of a name."""
    if level.name == name:
        raise ArithmeticError(f"no policy for {name}")
    return brl.solve(level)
