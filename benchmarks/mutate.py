"""Whether mutants keep their promise, and how many there are in a second.

    python benchmarks/mutate.py [--edits 100000] [--seed 0]

Levels of the gallery and mazes of `small-mazes` and `locked-mazes` are edited, one to five edits at
a time, each mutant being the parent of the next one, for a hundred mutants; then the next level has
its turn. The file of each mutant is read again: it must be valid, another MDP than its parent, and
won by its optimal policy. Levels that are not won themselves are edited without this condition.
Seconds are those of the processor, without the checks.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import dataclass

import babyrobot_levels as brl

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


def evolve(parent: brl.Level, seed: int, tally: Tally, most: int) -> None:
    """Edit a level, its mutant, and so on."""
    solvable = is_won(parent)
    for generation in range(GENERATION):
        if tally.edits >= most:
            return
        number = seed * GENERATION + generation
        edits = 1 + number % 5
        begin = time.process_time()
        try:
            mutant = brl.mutate(
                parent,
                seed=number,
                edits=edits,
                solvable=solvable,
                expect=BOUNDS,
            )
        except brl.UnsatisfiableError:
            tally.unmet += 1
            return
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


def main() -> None:
    """Print what became of the edits."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--edits", type=int, default=100_000, help="number of edits")
    parser.add_argument("--seed", type=int, default=0, help="seed of the first level")
    options = parser.parse_args()
    gallery = [brl.load(info.name) for info in brl.levels()]
    parents = [level for level in gallery if not level.has_random_maze and level.width <= 13]
    suites = [brl.load_suite(name) for name in ("small-mazes", "locked-mazes")]
    tally, seed = Tally(), options.seed
    while tally.edits < options.edits:
        turn, place = divmod(seed, len(parents) + len(suites))
        level = parents[place] if place < len(parents) else suites[place - len(parents)][turn]
        evolve(level, seed, tally, options.edits)
        print(tally, end="\r", file=sys.stderr, flush=True)
        seed += 1
    print(tally)


if __name__ == "__main__":
    main()
