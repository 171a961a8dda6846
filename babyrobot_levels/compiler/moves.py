"""Where a move ends: walks over the grid, with wind and walls, before any chance or warp."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.actions import NUM_MOVES
from babyrobot_levels.grid import Grid
from babyrobot_levels.spec.base import SIDES
from babyrobot_levels.spec.level import LevelFields
from babyrobot_levels.spec.moves import shifts

States = NDArray[np.int64]
Flags = NDArray[np.bool_]

NORTH, EAST, SOUTH, WEST = range(NUM_MOVES)
VERTICAL = (True, False, True, False)
SIGN = (-1, 1, 1, -1)
"""The direction of each move on its axis: south and east are positive."""


@dataclass(frozen=True, eq=False)
class Moves:
    """Arrays `[4, states]`, one row a direction: north, east, south, west.

    Attributes:
        open: whether nothing closes that side of the cell. Walls of glass do.
        landing: where a robot comes to stand that tries the direction; glass is a wall to it.
        refused: whether a wall refused the move: it pushed against the side and did not go.
        glass: the probability of getting through the wall of glass that the move tries, else 0.
        through: where the robot comes to stand if it gets through.
        bounce: where it comes to stand if it bounces off.
    """

    open: Flags
    landing: States
    refused: Flags
    glass: NDArray[np.float64]
    through: States
    bounce: States


def build_moves(level: LevelFields, grid: Grid) -> Moves:
    """Walk every direction out of every cell."""
    count = grid.width * grid.height
    states = np.arange(count)
    open_ = np.ascontiguousarray(grid.open.reshape(count, NUM_MOVES).T)
    delta = (-grid.width, 1, grid.width, -1)
    south, east = shifts(level.wind, grid.width, grid.height)
    pushes = {
        True: np.tile(np.array(south, np.int64), grid.height),
        False: np.repeat(np.array(east, np.int64), grid.width),
    }
    glass = np.zeros((NUM_MOVES, count))
    for (cell, side), probability in grid.glass.items():
        glass[SIDES.index(side), cell] = probability
    landing = np.empty((NUM_MOVES, count), np.int64)
    through, bounce = np.empty_like(landing), np.empty_like(landing)
    refused = np.empty((NUM_MOVES, count), bool)

    def walk(start: States, amount: States, vertical: bool) -> States:
        """Walk `amount` cells along an axis, one at a time, each state until a wall stops it."""
        ways = (SOUTH, NORTH) if vertical else (EAST, WEST)
        position = start
        for way, left in zip(ways, (amount, -amount), strict=True):
            for step in range(max(0, int(left.max(initial=0)))):
                going = (left > step) & open_[way, position]
                if not going.any():
                    break
                position = np.where(going, position + delta[way], position)
        return position

    for way in range(NUM_MOVES):
        vertical, sign = VERTICAL[way], SIGN[way]
        along, across = pushes[vertical] + sign, pushes[not vertical]
        pushing = along * sign > 0
        landing[way] = walk(walk(states, along, vertical), across, not vertical)
        glass[way] *= pushing
        refused[way] = pushing & ~open_[way]
        behind = np.where(glass[way] > 0, states + delta[way], states)
        rest = np.where(glass[way] > 0, along - sign, 0)
        drift = np.where(glass[way] > 0, across, 0)
        through[way] = walk(walk(behind, rest, vertical), drift, not vertical)
        back = (way + 2) % NUM_MOVES
        bounce[way] = np.where(open_[back], states + delta[back], states)
    return Moves(open_, landing, refused, glass, through, bounce)
