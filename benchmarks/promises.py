"""Whether generated levels keep their promise: 1,000 of them, each under conditions of its own.

    python benchmarks/promises.py [--count 1000] [--seed 0]

For each, a suite is drawn: sizes, loops, puddles, wind, keys, doors, coins, guards, what hits cost,
rewards and discount. Its first level is found twice: by default, and without the condition that the
optimal policy surely reaches the exit (`expect: {success: 0..}`). The files of the levels are read
and solved. Seconds are those of the processor.
"""

from __future__ import annotations

import argparse
import random
import statistics
import sys
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from typing import Any

import babyrobot_levels as brl
from babyrobot_levels.generation.candidates import Maker
from babyrobot_levels.generation.search import UnsatisfiableError, find_level
from babyrobot_levels.language.suite import SuiteFields

REWARDS: tuple[dict[str, float], ...] = (
    {},
    {"step": -0.1, "exit": 1},
    {"step": -1, "exit": 10},
    {"step": 0, "exit": 20},
    {"step": -1, "bump": -5, "stay": -0.5},
    {"step": -1, "closer": -0.5, "farther": -2},
)


@dataclass(frozen=True)
class Outcome:
    """What was found under some conditions.

    Attributes:
        success: the probability that the optimal policy of the level reaches the exit.
        candidates: how many there were.
        seconds: how long it took.
        unmet: the condition that was not met; empty if there is a level.
    """

    success: float = 0.0
    candidates: int = 0
    seconds: float = 0.0
    unmet: str = ""


def outcome(fields: dict[str, Any]) -> Outcome:
    """Find a level, and solve what its file says."""
    maker = Maker(SuiteFields.model_validate(fields), "level-{index}")
    begin = time.process_time()
    try:
        found = find_level(maker, 0)
    except UnsatisfiableError as error:
        return Outcome(unmet=error.condition)
    seconds = time.process_time() - begin
    success = brl.solve(brl.loads(found.level.to_yaml())).exit_probability
    return Outcome(success, found.attempt + 1, seconds)


def both(fields: dict[str, Any]) -> tuple[Outcome, Outcome]:
    """Return what is found by default, and without the promise."""
    return outcome(fields), outcome({**fields, "expect": {"success": "0.."}})


def row(name: str, outcomes: list[Outcome]) -> str:
    """Return a row of the table."""
    made = [each for each in outcomes if not each.unmet]
    won = sum(each.success > 1 - 1e-9 for each in made)
    tries, seconds = [each.candidates for each in made], [each.seconds for each in made]
    counts = Counter(each.unmet for each in outcomes if each.unmet)
    unmet = ", ".join(f"{name} {count}" for name, count in sorted(counts.items()))
    return (
        f"| {name} | {won:,} of {len(made):,} | {statistics.mean(tries):.1f} | "
        f"{statistics.median(tries):g} | {max(tries):,} | {statistics.median(seconds):.2f} s | "
        f"{statistics.mean(seconds):.2f} s | {max(seconds):.1f} s | {unmet or 'none'} |"
    )


def conditions(rng: random.Random) -> dict[str, Any]:
    """Return the fields of a suite."""
    keys, guards = rng.randint(0, 2), rng.randint(0, 2)
    fields: dict[str, Any] = {
        "version": 1,
        "kind": "suite",
        "count": 1,
        "seed": rng.getrandbits(30),
        "size": [rng.randint(5, 7), rng.randint(5, 7)],
        "maze": {
            "algorithm": rng.choice(["depth-first", "wilson", "prim", "kruskal"]),
            "loops": rng.choice([0, 0.5, 1]),
        },
        "start": rng.choice(["corner", "random"]),
        "exit": rng.choice(["corner", "random", "farthest"]),
        "puddles": rng.randint(0, 6),
        "wind": rng.randint(0, 2),
        "keys": keys,
        "doors": keys + (rng.randint(0, 1) if keys else 0),
        "coins": rng.randint(0, 2),
        "guards": guards,
        "rewards": rng.choice(REWARDS),
        "discount": rng.choice([1.0, 1.0, 0.99]),
    }
    if guards and rng.random() < 0.5:
        fields["hit"] = {"reward": -rng.choice([1.0, 10.0, 100.0]), "ends": rng.random() < 0.8}
    return fields


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=1000, help="number of levels")
    parser.add_argument("--seed", type=int, default=0, help="seed of the conditions")
    options = parser.parse_args()
    rng = random.Random(options.seed)
    pairs: list[tuple[Outcome, Outcome]] = []
    made = 0
    with ProcessPoolExecutor() as pool:
        try:
            while made < options.count:
                drawn = [conditions(rng) for _ in range(min(100, options.count - made))]
                for pair in pool.map(both, drawn):
                    pairs.append(pair)
                    made += not pair[0].unmet
                    print(f"{made:,} levels", end="\r", file=sys.stderr, flush=True)
        except KeyboardInterrupt:
            # What is done is told.
            pool.shutdown(cancel_futures=True)
    print(
        "| | surely won | candidates, mean | median | most | time, median | mean | most | not met |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    print(row("by default", [one for one, _ in pairs]))
    print(row("without the promise", [other for _, other in pairs]))


if __name__ == "__main__":
    main()
