"""Levels generated and solved by processes and on Ray: how fast one worker and two are.

    python benchmarks/parallel.py

10,000 levels of 8 by 8 cells with a path of 20 to 30 steps are generated and written as files, and
2,000 mazes of 20 by 20 cells with puddles are solved. A few levels come before, so that Ray, which
is a local instance here, has started and its workers have imported the package; the processes of
`--jobs` start with the work that is measured.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Iterator
from functools import partial
from importlib.util import find_spec

import report
from timing import Comparison, MissingPeer, compare_in_turns, installed

COUNTS = {"generated": 10_000, "solved": 2_000}
LEAST = 0.8
"""How fast Ray is to be, beside as many processes."""

RUN = """
import sys, time
import babyrobot_levels as brl

work, executor, workers, count, folder = sys.argv[1:]
workers, count = int(workers), int(count)
sized = {
    "generated": {"size": [8, 8], "path_length": {"min": 20, "max": 30}},
    "solved": {"size": [20, 20], "puddles": {"max": 20}},
}
if executor == "ray":
    import logging
    import ray

    ray.init("local", num_cpus=workers, include_dashboard=False, logging_level=logging.ERROR)
jobs = None if executor == "ray" else workers

def run(name, count):
    suite = {"version": 1, "kind": "suite", "count": count, **sized[work]}
    options = {"executor": executor, "jobs": jobs}
    if work == "generated":
        rows = brl.generate(suite, f"{folder}/{name}", **options)
    else:
        rows = brl.solve_many(suite, **options)
    assert sum(1 for row in rows) == count

run("first", count // 50 * workers)
begin = time.perf_counter()
run("all", count)
print(time.perf_counter() - begin)
"""


def working(work: str, executor: str, workers: int) -> float:
    """Return the rate of an executor, in levels per second."""
    if executor == "ray" and find_spec("ray") is None:
        raise MissingPeer("Ray is not installed (the extra `ray`)")
    with tempfile.TemporaryDirectory() as folder:
        count = COUNTS[work]
        call = [sys.executable, "-c", RUN, work, executor, str(workers), str(count), folder]
        done = subprocess.run(call, check=True, capture_output=True, text=True)
    return count / float(done.stdout)


def compare(count: int) -> Iterator[Comparison]:
    """Measure Ray beside processes of the same number."""
    for work in COUNTS:
        yield compare_in_turns(
            f"levels {work} per second",
            {f"Ray, {n} CPU{'s' * (n > 1)}": partial(working, work, "ray", n) for n in (1, 2)},
            {f"--jobs {n}": partial(working, work, "processes", n) for n in (1, 2)},
            count,
            aims={("Ray, 2 CPUs", "--jobs 2"): LEAST},
            versions=installed("babyrobot-levels", "numba", "numpy", "ray"),
        )


if __name__ == "__main__":
    report.main(__doc__, compare)
