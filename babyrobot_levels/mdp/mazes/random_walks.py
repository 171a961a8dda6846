"""Mazes from random walks. Both algorithms give every possible maze with the same probability."""

from __future__ import annotations

import random

from babyrobot_levels.mdp.mazes.draws import quarters
from babyrobot_levels.mdp.mazes.lattice import BACK, THERE, Lattice

OUTSIDE, INSIDE, NO_CELL = 0, 1, 2
_KINDS = bytes([OUTSIDE, NO_CELL]) + bytes(254)


def wilson(lattice: Lattice, start: int, rng: random.Random) -> None:
    """From each cell in turn, walk at random into the maze; what is left of the walk is added.

    The walk's loops are left out as they close. The maze begins as the start alone; the cells are
    taken row by row. A step that would lead nowhere is drawn again.
    """
    kinds = bytearray(lattice.blocked.translate(_KINDS))
    opened, steps, ways = lattice.open, lattice.steps, quarters(rng)
    left = bytearray(len(kinds))
    """The way by which the walk last left each cell: its loops are forgotten."""
    kinds[start] = INSIDE
    for first in lattice.component(start):
        if kinds[first]:
            continue
        cell = first
        for way in ways:
            other = cell + steps[way]
            kind = kinds[other]
            if kind == NO_CELL:
                continue
            left[cell] = way
            cell = other
            if kind:
                break
        cell = first
        while not kinds[cell]:
            kinds[cell] = INSIDE
            way = left[cell]
            opened[cell] |= THERE[way]
            cell += steps[way]
            opened[cell] |= BACK[way]


def aldous_broder(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Walk at random until every cell was visited; each is joined with the one it is entered from.

    A step that would lead nowhere is drawn again.
    """
    kinds = bytearray(lattice.blocked.translate(_KINDS))
    steps, missing = lattice.steps, len(lattice.component(start)) - 1
    if not missing:
        return
    cell = start
    kinds[cell] = INSIDE
    for way in quarters(rng):
        other = cell + steps[way]
        kind = kinds[other]
        if kind == INSIDE:
            cell = other
        elif not kind:
            kinds[other] = INSIDE
            lattice.join(cell, way)
            cell = other
            missing -= 1
            if not missing:
                return
