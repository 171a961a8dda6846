"""The actions, by their numbers. Apart from the tables, because it needs no NumPy."""

from __future__ import annotations

from enum import IntEnum


class Action(IntEnum):
    """What the robot can be told to do, with the numbers that environments use."""

    STAY = 0
    NORTH = 1
    EAST = 2
    SOUTH = 3
    WEST = 4


NUM_ACTIONS = len(Action)
NUM_MOVES = NUM_ACTIONS - 1
