"""Kruskal's mazes: walls are taken away in random order, wherever that joins two parts."""

from __future__ import annotations

import random
from array import array

from babyrobot_levels.mdp.mazes.draws import shuffle
from babyrobot_levels.mdp.mazes.lattice import Lattice

EAST_WAY, SOUTH_WAY = 1, 2


def kruskal(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Take away each wall, in an order that is drawn, unless there is a path around it."""
    blocked, steps = lattice.blocked, lattice.steps
    cells = lattice.component(start)
    walls = [
        cell << 2 | way
        for cell in cells
        for way in (EAST_WAY, SOUTH_WAY)
        if not blocked[cell + steps[way]]
    ]
    shuffle(rng, walls)
    parts = array("i", [-1]) * len(blocked)
    """A cell of the same part that is nearer to its root; for a root, minus the part's size."""
    missing = len(cells) - 1
    for wall in walls:
        if not missing:
            return
        cell, way = wall >> 2, wall & 3
        root, other = cell, cell + steps[way]
        while parts[root] >= 0:
            root = parts[root]
        while parts[other] >= 0:
            other = parts[other]
        if root != other:
            lattice.join(cell, way)
            missing -= 1
            if parts[root] > parts[other]:
                root, other = other, root
            parts[root] += parts[other]
            parts[other] = root
