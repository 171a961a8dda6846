"""Mazes that grow from the start, one cell at a time: where they go on is what tells them apart."""

from __future__ import annotations

import random
from heapq import heappop, heappush

from babyrobot_levels.mdp.mazes.draws import below
from babyrobot_levels.mdp.mazes.lattice import Lattice


def prim(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Add one of the cells beside the maze, drawn evenly, joined with a neighbour in the maze."""
    listed, steps = lattice.closed, lattice.steps
    outside = bytearray(b"\1") * len(listed)
    beside: list[int] = []
    listed[start] = 1
    cell = start
    while True:
        outside[cell] = 0
        for way in lattice.ways(cell, listed):
            listed[cell + steps[way]] = 1
            beside.append(cell + steps[way])
        if not beside:
            return
        number = below(rng, len(beside))
        cell, beside[number] = beside[number], beside[-1]
        beside.pop()
        ways = lattice.ways(cell, outside)
        lattice.join(cell, ways[below(rng, len(ways))])


def growing_tree(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Go on from the newest cell or, every other time, from any: a mixture of two characters.

    A cell without an unvisited neighbour leaves the list; the last one takes its place.
    """
    closed = lattice.closed
    closed[start] = 1
    active = [start]
    while active:
        number = len(active) - 1 if rng.getrandbits(1) else below(rng, len(active))
        ways = lattice.ways(active[number], closed)
        if ways:
            other = lattice.join(active[number], ways[below(rng, len(ways))])
            closed[other] = 1
            active.append(other)
        else:
            active[number] = active[-1]
            active.pop()


def hunt_and_kill(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Walk to unvisited neighbours until there is none; then hunt for the next cell to go on from.

    That is the first unvisited cell beside a visited one, row by row. It is joined with one of
    its visited neighbours.
    """
    closed, steps = lattice.closed, lattice.steps
    outside = bytearray(b"\1") * len(closed)
    seen: list[int] = []
    """The prey: cells beside visited ones, the first of them on top."""
    cell = start
    while True:
        closed[cell], outside[cell] = 1, 0
        ways = lattice.ways(cell, closed)
        for way in ways:
            heappush(seen, cell + steps[way])
        if ways:
            cell = lattice.join(cell, ways[below(rng, len(ways))])
            continue
        while seen and closed[seen[0]]:
            heappop(seen)
        if not seen:
            return
        cell = heappop(seen)
        ways = lattice.ways(cell, outside)
        lattice.join(cell, ways[below(rng, len(ways))])
