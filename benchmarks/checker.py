"""Solving large levels: `brl.solve`, exact, beside the model checker Storm and mdpsolver.

    python benchmarks/checker.py

Storm bounds its error by 1e-6 of a value (`sound`) or stops when values change by less (`default`),
mdpsolver too; ours is exact to rounding, and finds bounds and all optimal actions besides.
What it takes to compile, write and read levels is not counted. The peers run in environments of
their own, which the first run sets up.
"""

from __future__ import annotations

import math
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
import report
from peers import Peer
from timing import Comparison, Measure, MissingPeer, compare_in_turns, installed, needing

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver import model, sweeps
from babyrobot_levels.analysis.solver.policies import space_of

OPEN = (64, 128, 256, 512)
MAZES = (64, 256)
DISCOUNT = 0.99
LARGEST_FOR_MDPSOLVER = 128 * 128
"""The number of cells above which mdpsolver takes minutes."""

AIM = 1.5
"""How many times as fast as Storm's sound engine ours is to be, with the extra `fast`."""


def open_grid(side: int) -> brl.Level:
    """Return an open grid with skids."""
    return brl.load({"version": 1, "size": [side, side], "skid": 0.4})


def maze(side: int, seed: int = 1) -> brl.Level:
    """Return a maze with skids."""
    return brl.load({"version": 1, "size": [side, side], "maze": {"seed": seed}, "skid": 0.4})


def things() -> brl.Level:
    """Return a level of some 300,000 states, with a mover that walks at random."""
    walker = {"within": {"at": [0, 0], "size": [18, 18]}}
    return brl.load({"version": 1, "size": [31, 31], "skid": 0.2, "movers": [walker]})


def without_numba(levels: Sequence[brl.Level], discount: float) -> Measure:
    """Return a measure of how often a second levels are solved as if there was no Numba."""

    def measure() -> float:
        with patch.object(model, "is_compiled", _no), patch.object(sweeps, "is_compiled", _no):
            return ours(levels, discount)()

    return measure


def _no(states: int) -> bool:
    return False


def ours(
    levels: Sequence[brl.Level], discount: float, clock: Callable[[], float] = time.perf_counter
) -> Measure:
    """Return a measure of how often a second, by a clock, levels are solved."""

    def measure() -> float:
        begin = clock()
        for level in levels:
            brl.solve(level, discount)
        return 1 / (clock() - begin)

    return measure


def asking(peer: Peer, what: str, **question: Any) -> Measure:
    """Return a measure of how often a second a peer solves levels."""

    def measure() -> float:
        answer = peer.ask(**question)
        if "failed" in answer:
            raise MissingPeer(f"{what}: {answer['failed']}")
        return 1 / float(answer["seconds"])

    return measure


def write(levels: Sequence[brl.Level], folder: Path) -> None:
    """Write what the peers read: files for Storm, and the tables of the first level."""
    folder.mkdir()
    for number, level in enumerate(levels):
        brl.export(level, path=folder / f"{number}.umb")
    tables = space_of(levels[0], "all").model()
    np.savez(
        folder / "tables.npz",
        probability=tables.probability,
        next_state=tables.next_state,
        reward=np.where(tables.allowed, tables.reward, -1e6),
    )


def compare(count: int) -> Iterator[Comparison]:
    """Measure levels of some shapes and sizes beside the peers."""
    storm, solver = Peer("stormpy", "peer_storm.py"), Peer("mdpsolver", "peer_mdpsolver.py")
    versions = {**installed("babyrobot-levels", "numba", "numpy", "scipy"), **storm.version}
    sizes: dict[float, list[tuple[int, float]]] = {1.0: [], DISCOUNT: []}
    cases: list[tuple[str, Callable[[], list[brl.Level]], float]] = [
        (f"open {side}x{side}", lambda side=side: [open_grid(side)], discount)  # type: ignore[misc]
        for side in OPEN
        for discount in sizes
    ]
    cases += [
        (f"maze {side}x{side}", lambda side=side: [maze(side)], 1.0)  # type: ignore[misc]
        for side in MAZES
    ]
    cases.append(("31x31 with a mover", lambda: [things()], 1.0))
    cases.append(("1,000 mazes 20x20", lambda: [maze(20, seed) for seed in range(1000)], 1.0))
    for number, (name, make, discount) in enumerate(cases):
        levels = make()
        with tempfile.TemporaryDirectory() as folder:
            where = Path(folder) / str(number)
            write(levels, where)
            what = name if discount == 1 else f"{name}, discount {discount:g}"
            question = {"folder": str(where), "count": len(levels), "discount": discount}
            peers = {
                f"Storm {engine}, {what}": asking(storm, what, engine=engine, **question)
                for engine in ("sound", "default")
            }
            if discount < 1 and math.prod(levels[0].size) <= LARGEST_FOR_MDPSOLVER:
                tables = {"tables": str(where / "tables.npz"), "discount": discount}
                peers[f"mdpsolver, {what}"] = asking(solver, what, **tables)
            fast = f"brl.solve, fast, {what}"
            measures = {
                fast: needing("numba", partial(ours, levels, discount)),
                f"brl.solve, {what}": without_numba(levels, discount),
            }
            found = compare_in_turns(
                "solved per second",
                measures,
                peers,
                count,
                aims={(fast, f"Storm sound, {what}"): AIM},
                versions={**versions, **solver.version},
            )
        if name.startswith("open") and found.ours[fast]:
            sizes[discount].append(
                (OPEN[len(sizes[discount])], statistics.median(found.ours[fast]))
            )
            grown = exponents(sizes[discount])
        else:
            grown = ""
        yield replace(found, note=f"{what}: {how_exact(levels[0], discount)}{grown}")
    storm.close()
    solver.close()


def how_exact(level: brl.Level, discount: float) -> str:
    """Return how a level is solved, and how exactly."""
    solution = brl.solve(level, discount)
    largest = np.abs(solution.values[np.isfinite(solution.values)]).max()
    return f"{solution.method}, residual {solution.residual / largest:.0e} of the largest value"


def exponents(measured: Sequence[tuple[int, float]]) -> str:
    """Return by which power of the number of states the time grows, from each size to the next."""
    powers = [
        math.log(rate / other) / math.log((larger / side) ** 2)
        for (side, rate), (larger, other) in pairwise(measured)
    ]
    grown = ", ".join(f"{power:.2f}" for power in powers)
    return f"; time grows with the number of states to the power {grown}" if powers else ""


if __name__ == "__main__":
    report.main(__doc__, compare)
