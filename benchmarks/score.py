"""Scoring a policy in 1,000 mazes of 8x8 cells: exactly, beside episodes of the same precision.

    python benchmarks/score.py

The policy is the optimal one, which takes a random action one time in ten. Exactly: all levels are
scored, with their optimum and the random policy, and compiling counts. By episodes: only the policy
is measured, by `brl.rollout`, in levels that are compiled. How many episodes give the expected
return with a standard error of 0.01 (a hundredth of a step) follows from the exact deviation; how
long they take, from how long a million steps take.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
import report
from timing import Comparison, Measure, compare_in_turns, installed, needing

import babyrobot_levels as brl

LEVELS, SIZE, LIMIT = 1_000, 8, 200
SECONDS = 5
"""How long the scores may take."""

MEASURED = 10
"""In so many levels, episodes are measured."""

ERROR = 0.01
"""The standard error of the expected return that episodes are to have."""

NUM_ENVS, STEPS = 1_024, 1_000

Policies = dict[str, Any]


def levels() -> list[brl.Level]:
    """Return mazes with loops and puddles, not compiled yet."""
    suite = brl.load_suite(
        {
            "version": 1,
            "kind": "suite",
            "seed": 1,
            "count": LEVELS,
            "size": [SIZE, SIZE],
            "maze": {"algorithm": "wilson", "loops": 0.1},
            "puddles": {"max": 4},
            "max_steps": LIMIT,
        }
    )
    return list(suite)


def policies_of(all_levels: list[brl.Level]) -> Policies:
    """Return the policy of each level, by digest: probabilities `[states, actions]`."""
    found = {}
    for level in all_levels:
        best = brl.solve(level, actions="all").policy.reshape(-1)
        chances = np.full((best.size, 5), 0.1 / 5)
        chances[np.arange(best.size), np.maximum(best, 0)] += 0.9
        found[level.digest] = chances
    return found


def exactly(policies: Policies) -> Measure:
    """Return a measure of how many levels are scored in a second."""

    def measure() -> float:
        # They have no tables yet.
        fresh = levels()
        begin = time.perf_counter()
        brl.score(fresh, policies, actions="all")
        return len(fresh) / (time.perf_counter() - begin)

    return measure


def by_episodes(all_levels: list[brl.Level], policies: Policies) -> Measure:
    """Return a measure of how many levels as many episodes can be played in a second."""
    chosen = all_levels[:MEASURED]
    needed = []
    for level in chosen:
        policy = policies[level.digest]
        spread = brl.return_distribution(level, policy, discount=1.0).standard_deviation
        steps = brl.evaluate(level, policy, within="max_steps").expected_steps
        needed.append((spread / ERROR) ** 2 * steps)

    def measure() -> float:
        seconds = 0.0
        for level, steps in zip(chosen, needed, strict=True):
            begin = time.perf_counter()
            brl.rollout(level, policies[level.digest], NUM_ENVS, STEPS, seed=0, actions="all")
            rate = NUM_ENVS * STEPS / (time.perf_counter() - begin)
            seconds += steps / rate
        return len(chosen) / seconds

    return measure


def compare(count: int) -> Iterator[Comparison]:
    """Measure both ways."""
    all_levels = levels()
    policies = policies_of(all_levels)
    ours = f"brl.score, {LEVELS:,} mazes of {SIZE}x{SIZE}"
    yield compare_in_turns(
        "levels scored per second",
        {ours: exactly(policies)},
        {
            f"episodes, standard error {ERROR}": needing(
                "numba", partial(by_episodes, all_levels, policies)
            )
        },
        count,
        aims={(ours, None): LEVELS / SECONDS},
        versions=installed("babyrobot-levels", "numpy", "scipy", "numba"),
    )


if __name__ == "__main__":
    report.main(__doc__, compare)
