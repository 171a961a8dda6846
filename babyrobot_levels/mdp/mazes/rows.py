"""Mazes that are carved row by row, from the north. They need the whole rectangle."""

from __future__ import annotations

import random

from babyrobot_levels.mdp.mazes.draws import below
from babyrobot_levels.mdp.mazes.lattice import Lattice

WEST_WAY, EAST_WAY, SOUTH_WAY, NORTH_WAY = range(4)


def binary_tree(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Open each cell either to the north or to the west. The start does not matter."""
    for y, row in enumerate(lattice.rows()):
        for cell in range(row.start, row.stop):
            if cell == row.start:
                if y:
                    lattice.join(cell, NORTH_WAY)
            elif y and rng.getrandbits(1):
                lattice.join(cell, NORTH_WAY)
            else:
                lattice.join(cell, WEST_WAY)


def sidewinder(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Cut each row into runs, and open one cell of each run to the north.

    The first row is one run. The start does not matter.
    """
    for y, row in enumerate(lattice.rows()):
        first = row.start
        for cell in range(row.start, row.stop):
            is_last = cell == row.stop - 1
            if is_last or (y and rng.getrandbits(1)):
                if y:
                    lattice.join(first + below(rng, cell - first + 1), NORTH_WAY)
                first = cell + 1
            else:
                lattice.join(cell, EAST_WAY)


def eller(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Carve rows knowing nothing but which cells of the last one hang together.

    In a row, neighbours that do not hang together yet are joined, every other time. Of the cells
    that hang together then one is opened to the south, and of the others each, every other time.
    In the last row, all neighbours are joined that do not hang together yet. The start does not
    matter.
    """
    rows = lattice.rows()
    above = list(range(lattice.width))
    """For each column one that hangs together with it and is nearer to the root; the root."""
    for y, row in enumerate(rows):
        is_last = y == lattice.height - 1
        for column in range(1, lattice.width):
            root, other = _root(above, column - 1), _root(above, column)
            if root != other and (is_last or rng.getrandbits(1)):
                above[other] = root
                lattice.join(row.start + column - 1, EAST_WAY)
        if is_last:
            return
        parts: dict[int, list[int]] = {}
        for column in range(lattice.width):
            parts.setdefault(_root(above, column), []).append(column)
        above = list(range(lattice.width))
        for columns in parts.values():
            sure = columns[below(rng, len(columns))]
            for column in columns:
                if column == sure or rng.getrandbits(1):
                    lattice.join(row.start + column, SOUTH_WAY)
                    above[column] = sure


def _root(above: list[int], column: int) -> int:
    while above[column] != column:
        above[column] = column = above[above[column]]
    return column
