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
from collections.abc import Iterator
from typing import Any

import report
from peers import Peer
from timing import Comparison, Measure, compare_in_turns, installed

import babyrobot_levels as brl

SIZES = {(8, 5): None, (30, 30): 100}
"""For each size, how many times as fast as the peer ours is to be."""

DISCOUNT = 0.9
LARGE = (1000, 1000)
SECONDS = 60
"""How long the large one may take."""


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


def compare(count: int) -> Iterator[Comparison]:
    """Measure mazes of two sizes beside the peer, and then a large one alone."""
    peer = Peer("babyrobot", "peer_babyrobot.py")
    versions = installed("babyrobot-levels", "numpy", "scipy")
    for (width, height), aim in SIZES.items():
        world = maze((width, height), 42)
        level = level_of(world)
        theirs_here = f"babyrobot's ValueIteration, {width}x{height}"
        discounts = {
            f"brl.solve, {width}x{height}, discount {discount:g}": discount
            for discount in (DISCOUNT, 1.0)
        }
        yield compare_in_turns(
            "solved per second",
            {name: ours(level, discount) for name, discount in discounts.items()},
            {theirs_here: theirs(peer, world)},
            count,
            aims={(name, theirs_here): aim for name in discounts} if aim else {},
            versions={**versions, **peer.version},
        )
    peer.close()
    yield large(versions)


def large(versions: dict[str, str]) -> Comparison:
    """Measure a maze of a million cells, once."""
    level = level_of(maze(LARGE, 42))
    begin = time.perf_counter()
    solution = brl.solve(level, 1.0)
    seconds = time.perf_counter() - begin
    # Linux counts kilobytes here, macOS bytes.
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    gigabytes = peak / (1 << 30 if sys.platform == "darwin" else 1 << 20)
    name = f"brl.solve, {LARGE[0]}x{LARGE[1]}, discount 1"
    cells = LARGE[0] * LARGE[1]
    return Comparison(
        "cells solved per second",
        {name: [cells / seconds]},
        aims={(name, None): cells / SECONDS},
        versions=versions,
        note=f"{name}: {seconds:.1f} s, at most {gigabytes:.2f} GiB with the level, "
        f"residual {solution.residual:.1e}",
    )


if __name__ == "__main__":
    report.main(__doc__, compare)
