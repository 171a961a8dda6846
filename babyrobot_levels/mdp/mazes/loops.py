"""Braiding: dead ends that are opened up, so that a maze gets loops."""

from __future__ import annotations

import random

from babyrobot_levels.mdp.mazes.draws import below, shuffle
from babyrobot_levels.mdp.mazes.lattice import THERE, Lattice


def open_dead_ends(lattice: Lattice, share: float, rng: random.Random) -> None:
    """Open a share of the dead ends, each towards a neighbour that it has a wall to.

    The dead ends are taken in an order that the generator draws. One that another's opening
    has already joined counts as opened; one without a neighbour behind a wall is passed over.
    """
    dead_ends = [cell for cell in lattice.cells() if _is_dead_end(lattice, cell)]
    wanted = int(share * len(dead_ends) + 0.5)
    shuffle(rng, dead_ends)
    for cell in dead_ends[:wanted]:
        if not _is_dead_end(lattice, cell):
            continue
        walled = [
            way
            for way in lattice.ways(cell, lattice.blocked)
            if not lattice.open[cell] & THERE[way]
        ]
        if walled:
            lattice.join(cell, walled[below(rng, len(walled))])


def _is_dead_end(lattice: Lattice, cell: int) -> bool:
    return lattice.open[cell].bit_count() == 1
