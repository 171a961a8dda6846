"""Galleries: how fast levels become pages, pictures and films.

    python benchmarks/gallery.py

The levels are mazes of 8 by 8 cells with loops and puddles. A thousand of them are to become a
gallery in two minutes on two cores. The parts are measured one by one, in one process.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import report
from timing import Comparison, compare_in_turns, installed

import babyrobot_levels as brl
from babyrobot_levels.analysis import pictures

COUNT = 100
SUITE = {
    "version": 1,
    "kind": "suite",
    "count": COUNT,
    "size": [8, 8],
    "maze": {"loops": {"min": 0, "max": 0.5}},
    "puddles": {"max": 6},
}
LEAST = 1000 / 120
"""The levels per second that two processes are to reach."""


def writing(jobs: int) -> float:
    """Return how many levels become a gallery in a second."""
    with tempfile.TemporaryDirectory() as folder:
        begin = time.perf_counter()
        brl.gallery(brl.load_suite(SUITE), Path(folder, "gallery"), jobs=jobs)
        return COUNT / (time.perf_counter() - begin)


def doing(part: Callable[[brl.Level, brl.Solution], Any]) -> float:
    """Return for how many levels one part is done in a second."""
    levels = [*brl.load_suite(SUITE)]
    solutions = [brl.solve(level) for level in levels]
    begin = time.perf_counter()
    for level, solution in zip(levels, solutions, strict=True):
        part(level, solution)
    return COUNT / (time.perf_counter() - begin)


PARTS: dict[str, Callable[[brl.Level, brl.Solution], Any]] = {
    "metrics": lambda level, _: brl.metrics(level).to_dict(),
    "what a page plays": lambda level, _: level.to_html(),
    "SVG": lambda level, _: level.to_svg(),
    "PNG": lambda level, _: level.to_png(),
    "film": lambda level, solution: pictures.to_gif(level, policy=solution, scale=0.5),
}


def compare(count: int) -> Iterator[Comparison]:
    """Measure whole galleries, and then their parts."""
    versions = installed("babyrobot-levels", "numba", "numpy", "pillow")
    yield compare_in_turns(
        "levels of a gallery per second",
        {f"--jobs {jobs}": partial(writing, jobs) for jobs in (1, 2)},
        {},
        count,
        aims={("--jobs 2", None): LEAST},
        versions=versions,
    )
    yield compare_in_turns(
        "levels per second, one part",
        {name: partial(doing, part) for name, part in PARTS.items()},
        {},
        count,
        versions=versions,
    )


if __name__ == "__main__":
    report.main(__doc__, compare)
