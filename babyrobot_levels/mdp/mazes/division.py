"""Recursive division: long straight walls, each with one gap. It needs the whole rectangle."""

from __future__ import annotations

import random

from babyrobot_levels.mdp.mazes.draws import below
from babyrobot_levels.mdp.mazes.lattice import EAST, NORTH, SOUTH, WEST, Lattice


def recursive_division(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Divide a chamber in two by a wall with a gap, and do the same with both.

    The wall stands across the longer side; in a square, across one that is drawn. Chambers that
    are one cell wide or high are left as they are. The start does not matter.
    """
    stride, opened = lattice.stride, lattice.open
    width, height = lattice.width, lattice.height
    for y, row in enumerate(lattice.rows()):
        vertical = (NORTH if y else 0) | (SOUTH if y < height - 1 else 0)
        opened[row] = bytes([vertical | EAST | WEST]) * width
        opened[row.start] &= ~WEST
        opened[row.stop - 1] &= ~EAST
    chambers = [(lattice.index(0), width, height)]
    while chambers:
        first, columns, rows = chambers.pop()
        if columns < 2 or rows < 2:
            continue
        if rows > columns or (rows == columns and rng.getrandbits(1)):
            upper = below(rng, rows - 1) + 1
            begin = first + (upper - 1) * stride
            gap = begin + below(rng, columns)
            _close(opened, slice(begin, begin + columns), SOUTH)
            _close(opened, slice(begin + stride, begin + stride + columns), NORTH)
            opened[gap] |= SOUTH
            opened[gap + stride] |= NORTH
            chambers.append((first + upper * stride, columns, rows - upper))
            chambers.append((first, columns, upper))
        else:
            left = below(rng, columns - 1) + 1
            begin = first + left - 1
            end = begin + rows * stride
            gap = begin + below(rng, rows) * stride
            _close(opened, slice(begin, end, stride), EAST)
            _close(opened, slice(begin + 1, end + 1, stride), WEST)
            opened[gap] |= EAST
            opened[gap + 1] |= WEST
            chambers.append((first + left, columns - left, rows))
            chambers.append((first, left, rows))


_WITHOUT = {
    side: bytes(sides & ~side & 255 for sides in range(256)) for side in (NORTH, EAST, SOUTH, WEST)
}


def _close(opened: bytearray, cells: slice, side: int) -> None:
    opened[cells] = opened[cells].translate(_WITHOUT[side])
