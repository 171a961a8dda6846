"""Solving mazes with puddles: `brl.solve`, exact, beside PyPI babyrobot's ValueIteration.

    python benchmarks/solve.py

The peer iterates until no value changes by more than 0.001; ours is exact to rounding. Both solve
the same mazes with the same rewards; what it takes to make them is not counted. The peer runs in an
environment of its own, which the first run sets up.
"""

from __future__ import annotations

import random
import resource
import sys
import time
from pathlib import Path
from typing import Any

from peers import BABYROBOT, Peer
from timing import Measure, rounds, table, versions

import babyrobot_levels as brl

SIZES = ((8, 5), (30, 30))
DISCOUNT = 0.9
LARGE = (1000, 1000)


def maze(size: tuple[int, int], seed: int) -> dict[str, Any]:
    """Return a maze in which a tenth of the cells are wet."""
    rng = random.Random(seed)
    cells = [(x, y) for y in range(size[1]) for x in range(size[0])][1:-1]
    puddles = [
        (*cell, rng.choice(["small", "large"])) for cell in rng.sample(cells, len(cells) // 10)
    ]
    return {"size": size, "seed": seed, "puddles": puddles}


def level_of(world: dict[str, Any]) -> brl.Level:
    """Return the maze as a level, compiled."""
    puddles = [{"at": [x, y], "size": size} for x, y, size in world["puddles"]]
    fields = {"version": 1, "size": world["size"], "maze": {"seed": world["seed"]}}
    level = brl.load({**fields, "puddles": puddles})
    level.compile()
    return level


def ours(level: brl.Level, discount: float) -> Measure:
    """Return a measure of how often a second a level is solved."""

    def measure() -> float:
        begin = time.perf_counter()
        brl.solve(level, discount)
        return 1 / (time.perf_counter() - begin)

    return measure


def theirs(peer: Peer, world: dict[str, Any]) -> Measure:
    """Return a measure of how often a second the peer solves a maze."""
    return lambda: 1 / float(peer.ask(**world, discount=DISCOUNT)["seconds"])


def main() -> None:
    """Measure, and print the tables."""
    peer = Peer("babyrobot", Path(__file__).with_name("peer_babyrobot.py"), *BABYROBOT)
    print(versions(["babyrobot-levels", "numpy", "scipy"]) + ", babyrobot 1.0.40")
    for size in SIZES:
        world, (width, height) = maze(size, 42), size
        level, name = level_of(world), f"babyrobot's ValueIteration, {width}x{height}"
        measures = {
            name: theirs(peer, world),
            f"brl.solve, {width}x{height}, discount {DISCOUNT}": ours(level, DISCOUNT),
            f"brl.solve, {width}x{height}, discount 1": ours(level, 1.0),
        }
        print(table(rounds(measures, 5), name, "solved per second"))
    peer.close()
    level = level_of(maze(LARGE, 42))
    begin = time.perf_counter()
    solution = brl.solve(level, 1.0)
    seconds = time.perf_counter() - begin
    # Linux counts kilobytes here, macOS bytes.
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    gigabytes = peak / (1 << 30 if sys.platform == "darwin" else 1 << 20)
    print(
        f"brl.solve, {LARGE[0]}x{LARGE[1]}, discount 1: {seconds:.1f} s, "
        f"at most {gigabytes:.2f} GiB with the level, residual {solution.residual:.1e}"
    )


if __name__ == "__main__":
    main()
