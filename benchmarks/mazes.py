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
from pathlib import Path

from peers import BABYROBOT, Peer
from timing import Measure, rounds, table, versions

from babyrobot_levels.maze import ALGORITHMS, carve, carve_many, compiled

MAZELIB = (("mazelib==0.9.16",),)
SIZES = {(8, 8): 300, (32, 32): 15}
"""For each size, how many mazes the peers grow in a round."""

LARGE = (1000, 1000)


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

    return measure


def theirs(peer: Peer, size: tuple[int, int], count: int) -> Measure:
    """Return a measure of a peer's mazes per second."""
    return lambda: count / float(peer.ask(size=size, count=count)["seconds"])


def seconds(algorithm: str, *, plain: bool) -> float:
    """Return how long one large maze takes."""
    width, height = LARGE
    with plainly(plain):
        begin = time.perf_counter()
        carve(width, height, bytes(width * height), 0, 1, algorithm, 0.0)
        return time.perf_counter() - begin


def main() -> None:
    """Measure, and print the tables."""
    folder = Path(__file__).parent
    babyrobot = Peer("babyrobot", folder / "peer_babyrobot_mazes.py", *BABYROBOT)
    mazelib = Peer("mazelib", folder / "peer_mazelib.py", *MAZELIB)
    print(versions(["babyrobot-levels", "numba", "numpy"]) + ", babyrobot 1.0.40, mazelib 0.9.16")
    for size, count in SIZES.items():
        width, height = size
        baseline = f"babyrobot, {width}x{height}"
        measures = {
            baseline: theirs(babyrobot, size, count),
            f"mazelib, {width}x{height}": theirs(mazelib, size, count),
            f"ours, plain, {width}x{height}": ours(size, count * 4, plain=True),
            f"ours, fast, {width}x{height}": ours(size, count * 60, plain=False),
            f"ours, fast, many at a time, {width}x{height}": ours(
                size, count * 60, plain=False, many=True
            ),
        }
        print(table(rounds(measures, 7), baseline, "depth-first mazes per second"))
    babyrobot.close()
    mazelib.close()
    width, height = LARGE
    for name in ALGORITHMS:
        print(f"{name}, {width}x{height}, plain: {seconds(name, plain=True):.2f} s")
    fast = min(seconds("depth-first", plain=False) for _ in range(3))
    print(f"depth-first, {width}x{height}, fast: {fast:.3f} s")


if __name__ == "__main__":
    main()
