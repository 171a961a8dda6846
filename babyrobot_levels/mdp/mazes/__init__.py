"""Mazes grown from a seed. `carve` chooses the algorithm; the algorithms are in one file."""

import random
from collections.abc import Callable, Sequence

from babyrobot_levels.mdp.mazes import compiled
from babyrobot_levels.mdp.mazes.algorithms import (
    aldous_broder,
    binary_tree,
    depth_first,
    eller,
    growing_tree,
    hunt_and_kill,
    kruskal,
    prim,
    recursive_division,
    sidewinder,
    wilson,
)
from babyrobot_levels.mdp.mazes.lattice import Lattice, open_dead_ends

ALGORITHMS: dict[str, Callable[[Lattice, int, random.Random], None]] = {
    "depth-first": depth_first,
    "wilson": wilson,
    "aldous-broder": aldous_broder,
    "kruskal": kruskal,
    "prim": prim,
    "growing-tree": growing_tree,
    "hunt-and-kill": hunt_and_kill,
    "recursive-division": recursive_division,
    "binary-tree": binary_tree,
    "sidewinder": sidewinder,
    "eller": eller,
}
"""Each carves a lattice from a cell on, drawing only from the generator that it is given.

It carves the cells that are connected with that cell, and no others.
"""


def carve(
    width: int, height: int, blocked: bytes, start: int, seed: int, algorithm: str, loops: float
) -> bytes:
    """Return the open sides of a maze's cells.

    Between any two cells connected with the start there is exactly one path, before
    `loops` opens some more. Cells that blocked ones cut off from it stay walled in on all sides.

    Args:
        width: the number of columns.
        height: the number of rows.
        blocked: 1 for each blocked cell, row by row, else 0. Not every algorithm can do with
            them, see `language.cells.RECTANGULAR`.
        start: the number of the cell to begin with, which is not blocked.
        seed: what the maze is grown from.
        algorithm: a name in `ALGORITHMS`.
        loops: the share of the dead ends that are opened up afterwards, from 0 to 1.

    Returns:
        For each cell a bit set of open sides: 1 north, 2 east, 4 south, 8 west.
    """
    done = None
    if algorithm == "depth-first":
        done = compiled.depth_first(width, height, blocked, start, seed)
        if done and not loops:
            return done[0]
    lattice, rng = Lattice(width, height, blocked), random.Random(seed)
    if done:
        sides, words = done
        lattice.set_sides(sides)
        # What the compiled code has drawn, the generator for the loops must leave out.
        rng.getrandbits(32 * words)
    else:
        ALGORITHMS[algorithm](lattice, lattice.index(start), rng)
    if loops:
        open_dead_ends(lattice, loops, rng)
    return lattice.sides()


def carve_many(
    width: int,
    height: int,
    blocked: bytes,
    start: int,
    seeds: Sequence[int],
    algorithm: str,
    loops: float,
) -> list[bytes]:
    """Return what `carve` returns for each of many seeds; with the extra `fast`, in less time."""
    if algorithm == "depth-first" and not loops:
        mazes = compiled.depth_first_many(width, height, blocked, start, seeds)
        if mazes is not None:
            return mazes
    return [carve(width, height, blocked, start, seed, algorithm, loops) for seed in seeds]
