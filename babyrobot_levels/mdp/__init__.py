"""From a level's fields to walls and exact tables: mazes, grid, compiler, digest."""

from __future__ import annotations

from typing import Any

_OF_TABLES = frozenset({"FREE", "GLASS", "Mdp", "Outcome", "REFUSED"})
"""What stood here when `babyrobot_levels.mdp` was a module of its own."""


def __getattr__(name: str) -> Any:
    if name not in _OF_TABLES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    import warnings

    from babyrobot_levels.mdp import tables

    message = f"{__name__}.{name} has moved to {tables.__name__}.{name}"
    warnings.warn(message, DeprecationWarning, stacklevel=2)
    return getattr(tables, name)
