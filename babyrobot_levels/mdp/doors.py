"""Doors on the grid: where they stand, and the grid while some of them are closed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from babyrobot_levels.language.base import SIDE_NAMES
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.things import Door
from babyrobot_levels.language.walls import sides_of
from babyrobot_levels.mdp.grid import BIT, OPPOSITE, Grid


def door_name(door: Door) -> str:
    """Return what a door is called in messages: `door east of [4, 2]`."""
    (side,) = (name for name, side in SIDE_NAMES.items() if side == door.side)
    return f"door {side} of [{door.at[0]}, {door.at[1]}]"


def door_sides(level: LevelFields, grid: Grid) -> Iterator[tuple[int, str, int]]:
    """Yield the cells and sides at which doors stand, from both sides, and each door's number."""
    for index, door in enumerate(level.doors):
        for x, y in sides_of(door):
            cell = y * grid.width + x
            yield cell, door.side, index
            other = grid.neighbour(cell, door.side)
            if other is not None:
                yield other, OPPOSITE[door.side], index


def grid_with_doors(level: LevelFields, grid: Grid, closed: Sequence[bool]) -> Grid:
    """Return the grid with a wall at each closed door.

    Args:
        level: the level.
        grid: its grid, in which all doors are open.
        closed: for each door, whether it is closed.
    """
    if not any(closed):
        return grid
    walls = bytearray(grid.wall_bits)
    for cell, side, index in door_sides(level, grid):
        if closed[index]:
            walls[cell] |= BIT[side]
    return replace(grid, wall_bits=bytes(walls))
