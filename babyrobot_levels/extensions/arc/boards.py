"""Levels as boards of pixels in the colours of ARC-AGI: a pixel for each cell and each wall."""

from collections.abc import Iterator
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.grid import BIT, door_sides
from babyrobot_levels.render.situation import effects_of, place_of, situation_of

MOST = 31
"""The most columns, and rows: of 64 pixels, each cell has one, and so have walls around it."""


class Color(IntEnum):
    """What the colours of ARC-AGI stand for."""

    FLOOR = 0
    COSTS = 1
    OFF = 2
    PAYS = 3
    LOCKED = 4
    WALL = 5
    WARP = 6
    TARGET = 7
    MOVER = 8
    ROBOT = 9
    PUDDLE = 10
    ITEM = 11
    DOOR = 12
    BOX = 13
    EXIT = 14
    TRAP = 15


ON = Color.PAYS
"""A switch that is on."""


def board_of(level: Level, state: int) -> NDArray[np.int8]:
    """Return the picture of a state, `[2 * height + 1, 2 * width + 1]`, as numbers of colours.

    Cells have odd places, what is between them even ones.

    Args:
        level: the level; a maze needs a seed.
        state: the state, as in `level.compile()`.
    """
    place = place_of(level, state)
    board = _walls(level, place.configuration)
    for (x, y), color in (*_grounds(level), *_things(level, place.configuration)):
        board[2 * y + 1, 2 * x + 1] = color
    board[2 * place.y + 1, 2 * place.x + 1] = Color.ROBOT
    return board


def _walls(level: Level, configuration: int) -> NDArray[np.int8]:
    """Return cells, and the walls and closed doors around them."""
    width, height = level.size
    board = np.full((2 * height + 1, 2 * width + 1), Color.WALL, np.int8)
    grid = level.grid_at(configuration)
    for cell, is_blocked in enumerate(grid.blocked_cells):
        y, x = divmod(cell, width)
        if not is_blocked:
            board[2 * y + 1, 2 * x + 1] = Color.FLOOR
        for side, dy, dx in (("E", 0, 1), ("S", 1, 0)):
            if grid.open_bits[cell] & BIT[side]:
                board[2 * y + 1 + dy, 2 * x + 1 + dx] = Color.FLOOR
    _open_corners(board)
    closed = situation_of(level, configuration).doors
    for cell, side, door in door_sides(level, level.grid()):
        y, x = divmod(cell, width)
        if closed[door]:
            dx, dy = {"N": (0, -1), "E": (1, 0), "S": (0, 1), "W": (-1, 0)}[side]
            board[2 * y + 1 + dy, 2 * x + 1 + dx] = Color.DOOR
    return board


def _open_corners(board: NDArray[np.int8]) -> None:
    """Leave out corners at which no wall ends."""
    inner = board[2:-2:2, 2:-2:2]
    around = (
        board[1:-3:2, 2:-2:2],
        board[3:-1:2, 2:-2:2],
        board[2:-2:2, 1:-3:2],
        board[2:-2:2, 3:-1:2],
    )
    inner[np.all([side == Color.FLOOR for side in around], axis=0)] = Color.FLOOR


def _grounds(level: Level) -> Iterator[tuple[Cell, Color]]:
    """Yield the colours of cells that are not plain, later ones above earlier ones."""
    effects = effects_of(level)
    yield from ((puddle.at, Color.PUDDLE) for puddle in level.puddles)
    yield from ((cell, Color.COSTS) for cell in effects.costs)
    yield from ((cell, Color.PAYS) for cell in effects.pays)
    yield from ((warp.at, Color.WARP) for warp in level.warps)
    for cell, end in effects.ends.items():
        yield cell, Color.EXIT if end.is_good else Color.TRAP


def _things(level: Level, configuration: int) -> Iterator[tuple[Cell, Color]]:
    """Yield the colours of what stands, lies and moves."""
    now, things = situation_of(level, configuration), level.things()
    yield from ((cell, Color.LOCKED if now.is_locked else Color.EXIT) for cell in now.exits)
    for column, is_on in zip(things.fixed, now.on, strict=True):
        is_target = things.kinds[column] == "target"
        yield things[column].entry.at, Color.TARGET if is_target else ON if is_on else Color.OFF
    yield from ((cell, Color.ITEM) for cells in now.items for cell in cells)
    yield from ((cell, Color.BOX) for cell in now.boxes)
    yield from ((cell, Color.MOVER) for cell in now.movers)
