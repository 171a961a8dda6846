"""Lines of sight: which cells around the robot it can see past walls, doors and blocked cells.

A cell is seen if the straight line from the centre of the robot's cell to its centre crosses no
wall, no closed door and no blocked cell; glass hides nothing, but is a wall before a blocked cell.
A line that runs exactly through a corner passes if there is a way past the corner on one side of
it: over two open sides, and the cell between them. Where a line runs follows from whole numbers
alone, so that it is the same on every platform, and the line back crosses the same sides: of two
cells that are not blocked, either each sees the other or none does.
"""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.mdp.grid import BIT, Grid

_EAST, _SOUTH, _SOUTH_EAST, _SOUTH_WEST, _CLEAR = range(5)
"""What a line of sight can meet, by cell: the ways to other cells, and the cell itself.

`_SOUTH_WEST` of a cell is the way from its eastern neighbour to its southern one.
"""


def barriers(grid: Grid, radius: int) -> NDArray[np.bool_]:
    """Return what can be seen past, bool `[5, height + 2 * radius, width + 2 * radius]`.

    Args:
        grid: the grid, with walls at closed doors.
        radius: how many cells to add on each side. Nothing is seen out there.
    """
    shape = grid.height, grid.width
    walls = np.frombuffer(grid.wall_bits, np.uint8)
    no_wall = (walls[:, None] & np.array([BIT[side] for side in SIDES], np.uint8)) == 0
    for cell, side in grid.glass:
        no_wall[cell, SIDES.index(side)] = True
    east, south = (no_wall[:, SIDES.index(side)].reshape(shape).copy() for side in "ES")
    east[:, -1] = south[-1] = False
    clear = ~grid.blocked
    found = np.zeros((5, grid.height + 2 * radius, grid.width + 2 * radius), np.bool_)
    inner = found[:, radius : radius + grid.height, radius : radius + grid.width]
    inner[[_EAST, _SOUTH, _CLEAR]] = east, south, clear
    # Past a corner: by the cell to the north of it or to the south, in either diagonal.
    here, right = np.s_[:-1, :-1], np.s_[:-1, 1:]
    below, beyond = np.s_[1:, :-1], np.s_[1:, 1:]
    by_right = east[here] & clear[right] & south[right]
    by_below = south[here] & clear[below] & east[below]
    inner[_SOUTH_EAST][here] = by_right | by_below
    by_here = east[here] & clear[here] & south[here]
    by_beyond = south[right] & clear[beyond] & east[below]
    inner[_SOUTH_WEST][here] = by_here | by_beyond
    return found


def visible(passable: NDArray[np.bool_], x: int, y: int, radius: int) -> NDArray[np.bool_]:
    """Return which cells the robot sees, `[2 * radius + 1, 2 * radius + 1]`, north up.

    Args:
        passable: what `barriers` returned.
        x: the robot's column.
        y: its row.
        radius: that of `barriers`.
    """
    side = 2 * radius + 1
    met = np.append(passable[:, y : y + side, x : x + side], True)
    seen: NDArray[np.bool_] = np.logical_and.reduce(met.take(_lines(radius)), axis=1)
    return seen.reshape(side, side)


@cache
def _lines(radius: int) -> NDArray[np.intp]:
    """Return what each line of sight meets, `[cells, most]`.

    The numbers are those of the flat `[5, side, side]` window around the robot; the one after them
    stands for nothing.
    """
    side = 2 * radius + 1
    lines = [
        [(what * side + radius + y) * side + radius + x for what, x, y in _line(dx, dy)]
        for dy in range(-radius, radius + 1)
        for dx in range(-radius, radius + 1)
    ]
    most = max(map(len, lines))
    nothing = 5 * side * side
    return np.array([[*line, *[nothing] * (most - len(line))] for line in lines], np.intp)


def _line(dx: int, dy: int) -> list[tuple[int, int, int]]:
    """Return what the line from the cell (0, 0) to another one meets, as (what, x, y)."""
    across, down = abs(dx), abs(dy)
    right, below = (1 if dx > 0 else -1), (1 if dy > 0 else -1)
    met: list[tuple[int, int, int]] = []
    x = y = 0
    while (x, y) != (dx, dy):
        if met:
            met.append((_CLEAR, x, y))
        # The line crosses its next level side when it has come (2|y| + 1) / (2 down) of its way,
        # and its next upright side at (2|x| + 1) / (2 across).
        lead = (2 * abs(x) + 1) * down - (2 * abs(y) + 1) * across
        to_x, to_y = x + right * (lead <= 0), y + below * (lead >= 0)
        if lead < 0:
            what = _EAST
        elif lead > 0:
            what = _SOUTH
        else:
            what = _SOUTH_EAST if right == below else _SOUTH_WEST
        met.append((what, min(x, to_x), min(y, to_y)))
        x, y = to_x, to_y
    return met
