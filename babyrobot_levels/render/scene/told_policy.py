"""Policies in the forms that users hold them in, as the actions that arrows show."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from babyrobot_levels.mdp.actions import NUM_ACTIONS, Action
from babyrobot_levels.render.scene.told_rows import cells_of, number_of, shape_of

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

_NAMES = {name: action for action in Action for name in (action.name, action.name[0])}
_NAMES["S"] = Action.SOUTH
_TIE = 1e-9
"""How much less than the largest a probability may be and still count, as a share of it."""


def read_policy(told: Any, level: GridWorld) -> list[list[tuple[Action, ...]]]:
    """Return the actions of a policy in each cell, `[height][width]`; see `overlay_from`.

    Raises:
        ValueError: it is not as large as the level, or something in it is no action.
    """
    first = getattr(told, "first_action", 0)
    told = getattr(told, "greedy", getattr(told, "policy", told))
    if len(shape_of(told, 3)) == 3 and hasattr(told, "shape"):
        rows = cells_of(told, "policy", level, deep=True)
        return [[_likeliest(cell) for cell in row] for row in rows]
    rows = cells_of(told, "policy", level)
    return [[tuple(sorted(_actions(cell, first))) for cell in row] for row in rows]


def _likeliest(weights: Sequence[Any]) -> tuple[Action, ...]:
    numbers = [number_of(weight, "policy") or 0.0 for weight in weights]
    if min(numbers) < 0:
        raise ValueError(f"a policy of probabilities has none below 0: {min(numbers):g}")
    most = max(numbers)
    first = NUM_ACTIONS - len(numbers)
    return tuple(
        Action(first + index)
        for index, number in enumerate(numbers)
        if most and number >= most - _TIE * most
    )


def _actions(told: Any, first: int) -> set[Action]:
    """Return the actions that a cell's entry tells of."""
    if told is None:
        return set()
    if isinstance(told, str):
        action = _NAMES.get(told.upper())
        if action is None:
            raise ValueError(f"a policy cannot take {told!r} for an action")
        return {action}
    if isinstance(told, Iterable):
        return {action for part in told for action in _actions(part, first)}
    number = number_of(told, "policy")
    if number is None or number < 0:
        return set()
    if not number.is_integer() or number + first >= NUM_ACTIONS or math.isinf(number):
        raise ValueError(f"a policy cannot take {told!r} for an action: they are 0 to 4")
    return {Action(first + int(number))}
