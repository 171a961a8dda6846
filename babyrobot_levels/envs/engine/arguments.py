"""Checks of what users hand over to have many robots walk."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from typing import Any

from babyrobot_levels.envs.engine.tables import NO_LIMIT
from babyrobot_levels.library.level import Level


def checked_count(name: str, value: Any) -> int:
    """Return a number of things.

    Raises:
        ValueError: it is no whole number above 0.
    """
    number = whole_number(value)
    if number is None or number < 1:
        raise ValueError(f"{name} must be a whole number, at least 1, not {value!r}")
    return number


def limits_of(levels: Sequence[Level], max_episode_steps: Any) -> list[int]:
    """Return after how many steps episodes are cut off, for each level.

    Args:
        levels: the levels.
        max_episode_steps: the number for all of them, -1 for no limit; None for each level's own.

    Raises:
        ValueError: the number is neither.
    """
    if max_episode_steps is None:
        return [level.max_steps or NO_LIMIT for level in levels]
    number = whole_number(max_episode_steps)
    if number is None or (number < 1 and number != -1):
        raise ValueError(
            f"max_episode_steps must be at least 1, or -1 for no limit, not {max_episode_steps!r}"
        )
    return [NO_LIMIT if number == -1 else min(number, NO_LIMIT)] * len(levels)


def whole_number(value: Any) -> int | None:
    """Return a value as an int, None if it is no whole number."""
    try:
        return operator.index(value)
    except TypeError:
        return None
