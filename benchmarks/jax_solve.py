"""Solving many levels in JAX in one call, beside `brl.solve` and `brl.score`, level by level.

    python benchmarks/jax_solve.py

All solve the same mazes of 8×8 cells with puddles, which are compiled before. `brl.solve` is exact
to rounding in 64 bits. JAX iterates in 32 bits, until no value changes, or as often as an episode
has steps; how far it is from `brl.solve` stands below the table. Regret is that of the random
policy; besides, `brl.score` returns its success and its steps.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import report
from solve import level_of, maze
from timing import Comparison, Measure, compare_in_turns, installed, needing

import babyrobot_levels as brl

LEVELS = 1000
SIZE = (8, 8)
DISCOUNT = 0.9
WITHIN = 100
"""After how many steps episodes are truncated, for regret."""

AIM = 1.5
"""How many times as fast as level by level all levels in one call have to be."""


def mazes(count: int) -> list[brl.Level]:
    """Return different mazes with puddles, compiled."""
    return [level_of(maze(SIZE, seed)) for seed in range(count)]


def optima(levels: Sequence[brl.Level]) -> Callable[[], Any]:
    """Return a compiled call that returns the optimal returns of levels."""
    import jax

    import babyrobot_levels.jax as brl_jax

    _, params = brl_jax.make(levels)
    solve = jax.jit(lambda params: brl_jax.optimum(params, discount=DISCOUNT).returns)
    return lambda: jax.block_until_ready(solve(params))


def regrets(levels: Sequence[brl.Level]) -> Callable[[], Any]:
    """Return a compiled call that returns the regret of the random policy in levels."""
    import jax

    import babyrobot_levels.jax as brl_jax

    _, params = brl_jax.make(levels)
    policy = brl_jax.random_policy(params)
    regret = jax.jit(partial(brl_jax.regret, within=WITHIN))
    return lambda: jax.block_until_ready(regret(params, policy))


def rate_of(call: Callable[[], Any], count: int) -> Measure:
    """Return a measure of the levels per second of a call, the first of which is not measured."""
    call()

    def measure() -> float:
        begin = time.perf_counter()
        call()
        return count / (time.perf_counter() - begin)

    return measure


def measured(compiled: Callable[[Any], Callable[[], Any]], levels: Sequence[brl.Level]) -> Measure:
    """Return a measure of the levels per second of a call that has to be compiled."""
    return rate_of(compiled(levels), len(levels))


def solved(levels: Sequence[brl.Level]) -> list[float]:
    """Return the optimal return of each level."""
    return [brl.solve(level, DISCOUNT).expected_return for level in levels]


def scored(levels: Sequence[brl.Level]) -> list[float]:
    """Return the regret of the random policy in each level."""
    return [score.regret for score in brl.score(levels, "random", within=WITHIN)]


def compare(count: int, levels: int = LEVELS) -> Iterator[Comparison]:
    """Yield how many optima, and how many regrets, are computed per second."""
    made = mazes(levels)
    versions = installed("babyrobot-levels", "jax", "numpy", "scipy")
    for name, ours, peer, theirs in (
        ("brl_jax.optimum", optima, "brl.solve", solved),
        ("brl_jax.regret", regrets, "brl.score", scored),
    ):
        found = compare_in_turns(
            f"levels per second, {levels:,} mazes of 8x8",
            {name: needing("jax gymnax", partial(measured, ours, made))},
            {peer: rate_of(partial(theirs, made), levels)},
            count,
            aims={(name, peer): AIM},
            versions=versions,
        )
        if found.missing:
            yield found
        else:
            error = np.max(np.abs(np.asarray(ours(made)()) - np.asarray(theirs(made))))
            yield replace(found, note=f"{name}: at most {error:.1e} from {peer}")


if __name__ == "__main__":
    report.main(__doc__, compare)
