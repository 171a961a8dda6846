"""Mazes grown from a seed. `carve` chooses the algorithm; each lives in a file of its own."""

from __future__ import annotations

import random
from collections.abc import Callable

from babyrobot_levels.maze.depth_first import depth_first
from babyrobot_levels.maze.lattice import Lattice
from babyrobot_levels.maze.loops import open_dead_ends

ALGORITHMS: dict[str, Callable[[Lattice, int, random.Random], None]] = {
    "depth-first": depth_first,
}
"""Each carves a lattice from a cell on, drawing only from the generator that it is given."""


def carve(
    width: int, height: int, blocked: bytes, start: int, seed: int, algorithm: str, loops: float
) -> bytes:
    """Return the open sides of a maze's cells.

    Args:
        width: the number of columns.
        height: the number of rows.
        blocked: 1 for each blocked cell, row by row. Blocked cells are not carved.
        start: the number of the cell to begin with.
        seed: what the maze is grown from.
        algorithm: a name in `ALGORITHMS`.
        loops: the share of the dead ends that are opened up afterwards, from 0 to 1.

    Returns:
        For each cell a bit set of open sides: 1 north, 2 east, 4 south, 8 west.
    """
    lattice = Lattice(width, height, blocked)
    rng = random.Random(seed)
    ALGORITHMS[algorithm](lattice, lattice.index(start), rng)
    if loops:
        open_dead_ends(lattice, loops, rng)
    return lattice.sides()
