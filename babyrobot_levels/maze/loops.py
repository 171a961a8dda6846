"""Braiding: dead ends that are opened up, so that a maze gets loops."""

from __future__ import annotations

import random

from babyrobot_levels.maze.lattice import Lattice, below


def open_dead_ends(lattice: Lattice, share: float, rng: random.Random) -> None:
    """Open a share of the dead ends, each towards a neighbour that it has a wall to.

    The dead ends are taken in an order that the generator draws. One that another's opening
    has already joined counts as opened; one without a neighbour behind a wall is passed over.
    """
    dead_ends = [cell for cell in lattice.cells() if _is_dead_end(lattice, cell)]
    wanted = int(share * len(dead_ends) + 0.5)
    for last in range(len(dead_ends) - 1, 0, -1):
        chosen = below(rng, last + 1)
        dead_ends[last], dead_ends[chosen] = dead_ends[chosen], dead_ends[last]
    for cell in dead_ends[:wanted]:
        if not _is_dead_end(lattice, cell):
            continue
        walled = [
            cell + step
            for step in lattice.steps
            if not lattice.blocked[cell + step] and not lattice.open[cell] & lattice.bits[step][0]
        ]
        if walled:
            lattice.join(cell, walled[below(rng, len(walled))])


def _is_dead_end(lattice: Lattice, cell: int) -> bool:
    return lattice.open[cell].bit_count() == 1
