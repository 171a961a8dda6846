"""Arrays and lists that users give, as one thing for each cell of a level."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld


def cells_of(told: Any, key: str, level: GridWorld, *, deep: bool = False) -> list[list[Any]]:
    """Return what is told for each cell, `[height][width]`.

    Args:
        told: an array or lists, or an object that has such an attribute.
        key: what it is called, there and in messages.
        level: the level.
        deep: whether there is a number for each action (or move) of each cell.

    Raises:
        ValueError: it is not as large as the level.
    """
    told = getattr(told, key, told)
    width, height = level.size
    fitting = [(height, width, count) for count in (5, 4)] if deep else [(height, width)]
    shape = shape_of(told, len(fitting[0]))
    if shape not in fitting:
        raise ValueError(_misfit(key, shape, fitting))
    rows: list[list[Any]] = told.tolist() if hasattr(told, "tolist") else [*map(list, told)]
    return rows


def shape_of(told: Any, depth: int) -> tuple[int, ...]:
    """Return the shape of an array, or of lists in lists as far as they are even."""
    if hasattr(told, "shape"):
        return tuple(told.shape)
    if depth == 0 or not isinstance(told, list | tuple):
        return ()
    inner = {shape_of(part, depth - 1) for part in told}
    return (len(told), *(inner.pop() if len(inner) == 1 else ()))


def number_of(told: Any, key: str) -> float | None:
    """Return a number, or None for nan and None.

    Raises:
        ValueError: it is not a number.
    """
    if told is None:
        return None
    if isinstance(told, str):
        raise ValueError(f"`{key}` must be numbers, not {told!r}")
    try:
        value = float(told)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"`{key}` must be numbers, not {told!r}") from None
    return None if math.isnan(value) else value


def _misfit(key: str, shape: tuple[int, ...], fitting: Sequence[tuple[int, ...]]) -> str:
    height, width = fitting[0][:2]
    must = " or ".join(map(str, fitting))
    text = f"`{key}` has the shape {shape}, and on this level it must be {must}"
    if shape[:1] == (height * width,):
        text += f"; reshape it with `.reshape{(height, width, *shape[1:])}`"
    elif shape[:2] == (width, height):
        text += "; arrays are told by [y, x]"
    elif key == "values" and len(shape) == 3:
        text += "; values of actions go to `action_values`"
    return text
