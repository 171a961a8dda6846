"""Levels to order: how fast suites are drawn and compiled, and how fast files are written.

    python benchmarks/generate.py

`Suite-v0` is reset again and again: each time a level is drawn, compiled into exact tables, and its
digest taken. `babyrobot generate` makes 10,000 levels of 8 by 8 cells with a path of 20 to 30
steps, proves that each can be solved, and writes them as files, with two processes.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from typing import Any

import gymnasium
import report
from timing import Comparison, Measure, compare_in_turns, installed

import babyrobot_levels as brl
from babyrobot_levels.mdp.mazes import compiled

RESETS = 1_000
COUNT = 10_000
ORDER = ("--size", "8x8", "--path-length", "20..30", "--jobs", "2")

SUITES: dict[str, dict[str, Any]] = {
    "depth-first": {},
    "depth-first, train of two splits": {"splits": {"train": 0.8, "test": 0.2}},
    "depth-first, path of 20 to 30 steps": {"path_length": {"min": 20, "max": 30}},
    "depth-first, up to four puddles": {"puddles": {"max": 4}},
    "wilson": {"maze": {"algorithm": "wilson"}},
}


def resetting(fields: dict[str, Any]) -> Measure:
    """Return a measure of a suite's levels of 8 by 8 per second, drawn, compiled, and told."""
    whole = {"version": 1, "kind": "suite", "count": 1_000_000, "size": [8, 8], **fields}
    env = gymnasium.make(
        "babyrobot/Suite-v0", suite=whole, split="train" if "splits" in whole else None
    )

    def measure() -> float:
        env.reset(seed=0)
        begin = time.perf_counter()
        for _ in range(RESETS):
            env.reset()
        return RESETS / (time.perf_counter() - begin)

    return measure


def generating() -> float:
    """Return how many seconds the command takes."""
    with tempfile.TemporaryDirectory() as folder:
        call = [sys.executable, "-m", "babyrobot_levels", "generate", "--count", str(COUNT)]
        begin = time.perf_counter()
        subprocess.run([*call, *ORDER, "-o", folder], check=True, capture_output=True)
        return time.perf_counter() - begin


def compare(count: int) -> Iterator[Comparison]:
    """Measure suites, and then the command, which has no peer either."""
    is_fast = compiled.load() is not None
    versions = installed("babyrobot-levels", "gymnasium", "numba", "numpy")
    # From here on the kernel is loaded, as it is in every process that draws many levels.
    suite = brl.load_suite({"version": 1, "kind": "suite", "count": 10_000, "size": [8, 8]})
    for level in suite[:8_000]:
        level.grid()
    how = "with" if is_fast else "without"
    yield compare_in_turns(
        f"levels of 8x8 per second, Suite-v0, {how} fast",
        {name: resetting(fields) for name, fields in SUITES.items()},
        {},
        count,
        aims={("depth-first", None): 2_000} if is_fast else {},
        versions=versions,
    )
    seconds = generating()
    yield Comparison(
        "files per second, babyrobot generate",
        {" ".join(ORDER): [COUNT / seconds]},
        versions=versions,
        note=f"{COUNT:,} files, {' '.join(ORDER)}: {seconds:.1f} s",
    )


if __name__ == "__main__":
    report.main(__doc__, compare)
