"""Depth-first mazes: long, winding corridors. Wall for wall those of PyPI `babyrobot`."""

from __future__ import annotations

import random

from babyrobot_levels.maze.lattice import Lattice


def depth_first(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Walk to an unvisited neighbour as long as there is one, else back by one cell.

    The neighbours are listed in the order west, east, south, north.
    """
    closed, join, draw = lattice.closed, lattice.join, rng.getrandbits
    west, east, south, north = lattice.steps
    cell = start
    closed[cell] = 1
    path: list[int] = []
    while True:
        neighbours = [
            other
            for other in (cell + west, cell + east, cell + south, cell + north)
            if not closed[other]
        ]
        if neighbours:
            # `lattice.below`, unrolled: this is the hot loop of large mazes.
            count = len(neighbours)
            bits = count.bit_length()
            number = draw(bits)
            while number >= count:
                number = draw(bits)
            other = neighbours[number]
            join(cell, other)
            closed[other] = 1
            path.append(cell)
            cell = other
        elif path:
            cell = path.pop()
        else:
            return
