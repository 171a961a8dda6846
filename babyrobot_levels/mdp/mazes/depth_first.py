"""Depth-first mazes: long, winding corridors. Wall for wall those of PyPI `babyrobot`."""

from __future__ import annotations

import random

from babyrobot_levels.mdp.mazes.lattice import BACK, THERE, WAYS, Lattice

BITS = tuple(count.bit_length() for count in range(5))


def depth_first(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Walk to an unvisited neighbour as long as there is one, else back by one cell.

    The neighbours are listed in the order west, east, south, north. `compiled` does the same, bit
    for bit.
    """
    # `Lattice.ways`, `below` and `Lattice.join`, unrolled: this is the hot loop of most mazes.
    closed, opened, stride = lattice.closed, lattice.open, lattice.stride
    draw, moves = rng.getrandbits, tuple(zip(lattice.steps, THERE, BACK, strict=True))
    choices = tuple(tuple(moves[way] for way in ways) for ways in WAYS)
    path: list[int] = []
    cell = start
    closed[cell] = 1
    while True:
        free = choices[
            closed[cell - 1]
            | closed[cell + 1] << 1
            | closed[cell + stride] << 2
            | closed[cell - stride] << 3
        ]
        if free:
            count = len(free)
            bits = BITS[count]
            number = draw(bits)
            while number >= count:
                number = draw(bits)
            step, there, back = free[number]
            opened[cell] |= there
            path.append(cell)
            cell += step
            opened[cell] = back
            closed[cell] = 1
        elif path:
            cell = path.pop()
        else:
            return
