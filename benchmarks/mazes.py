"""Depth-first mazes, beside PyPI babyrobot and mazelib; then all algorithms, and one large maze.

    python benchmarks/mazes.py

Ours are the same mazes as babyrobot's, wall for wall, in plain Python and with the extra `fast`
(Numba), one at a time and many at a time. Compiling and loading are not counted. The peers run in
environments of their own, which the first run sets up.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial

import report
from peers import Peer
from timing import Comparison, Measure, compare_in_turns, installed, needing

from babyrobot_levels.mdp.mazes import ALGORITHMS, carve, carve_many, compiled

SIZES = {(8, 8): (300, 1.5), (32, 32): (15, 4.0)}
"""For each size, how many mazes the peers grow in a round, and how many times as fast ours are to
be in plain Python."""

LARGE = (1000, 1000)
SECONDS = 0.15
"""How long a large one may take with compiled code."""


@contextmanager
def plainly(plain: bool) -> Iterator[None]:
    """Grow mazes in plain Python, or else with compiled code from the first on."""
    load, compiled.WORTH_LOADING = compiled.load, 0
    if plain:
        compiled.load = lambda: None  # type: ignore[assignment]
    try:
        yield
    finally:
        compiled.load = load


def ours(size: tuple[int, int], count: int, *, plain: bool, many: bool = False) -> Measure:
    """Return a measure of depth-first mazes per second."""
    width, height = size
    blocked = bytes(width * height)

    def measure() -> float:
        with plainly(plain):
            begin = time.perf_counter()
            if many:
                carve_many(width, height, blocked, 0, range(count), "depth-first", 0.0)
            else:
                for seed in range(count):
                    carve(width, height, blocked, 0, seed, "depth-first", 0.0)
            return count / (time.perf_counter() - begin)

    return measure if plain else needing("numba", lambda: measure)


def theirs(peer: Peer, size: tuple[int, int], count: int) -> Measure:
    """Return a measure of a peer's mazes per second."""
    return lambda: count / float(peer.ask(size=size, count=count)["seconds"])


def large(algorithm: str, *, plain: bool) -> float:
    """Return how many cells of one large maze are grown a second."""
    width, height = LARGE
    with plainly(plain):
        begin = time.perf_counter()
        carve(width, height, bytes(width * height), 0, 1, algorithm, 0.0)
        return width * height / (time.perf_counter() - begin)


def compare(count: int) -> Iterator[Comparison]:
    """Measure small mazes beside the peers, and then large ones alone."""
    peers = Peer("babyrobot", "peer_babyrobot_mazes.py"), Peer("mazelib", "peer_mazelib.py")
    versions = installed("babyrobot-levels", "numba", "numpy")
    for size, (number, least) in SIZES.items():
        there = {f"{peer.name}, {size[0]}x{size[1]}": theirs(peer, size, number) for peer in peers}
        first = next(iter(there))
        plain, fast, many = (
            f"ours, {how}, {size[0]}x{size[1]}" for how in ("plain", "fast", "fast, many at a time")
        )
        yield compare_in_turns(
            "depth-first mazes per second",
            {
                plain: ours(size, number * 4, plain=True),
                fast: ours(size, number * 60, plain=False),
                many: ours(size, number * 60, plain=False, many=True),
            },
            there,
            count,
            aims={(plain, first): least, (fast, first): 40, (many, first): 40},
            versions=versions | peers[0].version | peers[1].version,
        )
    for peer in peers:
        peer.close()
    cells = f"{LARGE[0]}x{LARGE[1]}"
    yield Comparison(
        "cells of one maze per second",
        {f"{name}, plain, {cells}": [large(name, plain=True)] for name in ALGORITHMS},
        versions=versions,
    )
    # The first call loads what was compiled.
    name = f"depth-first, fast, {cells}"
    yield compare_in_turns(
        "cells of one maze per second",
        {name: needing("numba", lambda: partial(large, "depth-first", plain=False))},
        {},
        count,
        aims={(name, None): LARGE[0] * LARGE[1] / SECONDS},
        versions=versions,
    )


if __name__ == "__main__":
    report.main(__doc__, compare)
