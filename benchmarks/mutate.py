"""Whether mutants keep their promise, and how many there are in a second.

    python benchmarks/mutate.py [--edits 100000] [--seed 0] [--jobs 1]

Levels of the gallery and mazes of `small-mazes` and `locked-mazes` are edited, one to five edits at
a time, each mutant being the parent of the next one, for a hundred mutants; then the next level has
its turn. The file of each mutant is read again: it must be valid, another MDP than its parent, and
won by its optimal policy. Levels that are not won themselves are edited without this condition.
Seconds are those of one processor, without the checks; what is counted does not depend on the jobs.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Sequence
from contextlib import closing
from dataclasses import astuple, dataclass
from functools import cache
from itertools import count

# Threads of linear algebra only get in the way of such small systems.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import babyrobot_levels as brl
from babyrobot_levels.parallel import executor_for
from babyrobot_levels.parallel.executor import results

GENERATION = 100
BOUNDS = {"items": "..4", "movers": "..2", "configurations": "..500"}
"""An evolution without bounds collects things, whose combinations are states."""


@dataclass
class Tally:
    """What became of the edits."""

    edits: int = 0
    mutants: int = 0
    invalid: int = 0
    lost: int = 0
    unmet: int = 0
    seconds: float = 0.0

    def __add__(self, other: Tally) -> Tally:
        return Tally(*map(sum, zip(astuple(self), astuple(other), strict=True)))

    def __str__(self) -> str:
        rate = self.mutants / max(self.seconds, 1e-9)
        return (
            f"{self.edits:,} edits in {self.mutants:,} mutants: {self.invalid:,} invalid, "
            f"{self.lost:,} not won, {rate:,.0f} mutants a second; "
            f"{self.unmet:,} parents without a mutant"
        )


def is_won(level: brl.Level) -> bool:
    """Return whether the optimal policy surely reaches an exit."""
    success = brl.metrics(level).success
    return success is not None and success > 1 - 1e-9


@cache
def parents() -> Sequence[Sequence[brl.Level] | brl.Suite]:
    """Return where first levels come from: the gallery, but what breaks a bound, and suites."""
    gallery = (brl.load(info.name) for info in brl.levels() if info.name != "coin-run")
    small = [[level] for level in gallery if not level.has_random_maze and level.width <= 13]
    return [*small, *map(brl.load_suite, ("small-mazes", "locked-mazes"))]


def evolve(seed: int) -> Tally:
    """Edit a level, its mutant, and so on; tell what became of the edits."""
    turn, place = divmod(seed, len(parents()))
    levels = parents()[place]
    parent, tally = levels[turn % len(levels)], Tally()
    solvable = is_won(parent)
    for generation in range(GENERATION):
        number = seed * GENERATION + generation
        edits = 1 + number % 5
        begin = time.process_time()
        try:
            mutant = brl.mutate(parent, seed=number, edits=edits, solvable=solvable, expect=BOUNDS)
        except brl.UnsatisfiableError:
            tally.unmet += 1
            break
        finally:
            tally.seconds += time.process_time() - begin
        tally.edits += edits
        tally.mutants += 1
        try:
            read = brl.loads(mutant.to_yaml())
            tally.invalid += read.digest == parent.digest or read.digest != mutant.digest
            tally.lost += solvable and not is_won(read)
        except brl.LevelError:
            tally.invalid += 1
        parent = mutant
    return tally


def main() -> None:
    """Print what became of the edits."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--edits", type=int, default=100_000, help="least number of edits")
    parser.add_argument("--seed", type=int, default=0, help="seed of the first level")
    parser.add_argument("--jobs", type=int, default=1, help="number of processes")
    options = parser.parse_args()
    total = Tally()
    with closing(executor_for(jobs=options.jobs).map(evolve, count(options.seed))) as tallies:
        for tally in results(tallies):
            total += tally
            print(total, end="\r", file=sys.stderr, flush=True)
            if total.edits >= options.edits:
                break
    print(total)


if __name__ == "__main__":
    main()
