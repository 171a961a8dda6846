"""The five actions: their numbers, and how they change the cell."""

from __future__ import annotations

from enum import IntEnum


class Action(IntEnum):
    """An action of the robot, with the number that environments use."""

    STAY = 0
    NORTH = 1
    EAST = 2
    SOUTH = 3
    WEST = 4


NUM_ACTIONS = len(Action)
NUM_MOVES = NUM_ACTIONS - 1

DELTAS: dict[Action, tuple[int, int]] = {
    Action.NORTH: (0, -1),
    Action.EAST: (1, 0),
    Action.SOUTH: (0, 1),
    Action.WEST: (-1, 0),
}
"""How each move changes the cell, `(dx, dy)`: x grows to the east, y to the south."""
