"""Mutants in compiled code: how many a second, with their tables and exact regrets.

    python benchmarks/jax_design.py [--levels 1024] [--size 8]

Each round edits all levels five times, keeps those edits after which they can be solved, makes
their tables, and computes the regret of the random policy within 100 steps. Figures are medians of
seven rounds.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp

import babyrobot_levels.jax as brl_jax


def rate(function: Callable[[Any], Any], count: int, rounds: int = 7) -> float:
    """Return how many levels a function makes in a second, once it is compiled."""
    keys = jax.random.split(jax.random.key(0), rounds + 1)
    jax.block_until_ready(function(keys[0]))
    seconds = []
    for key in keys[1:]:
        begin = time.perf_counter()
        jax.block_until_ready(function(key))
        seconds.append(time.perf_counter() - begin)
    return count / statistics.median(seconds)


def main() -> None:
    """Print a line for each part."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--levels", type=int, default=1024, help="number of levels")
    parser.add_argument("--size", type=int, default=8, help="width and height in cells")
    options = parser.parse_args()
    base = {"version": 1, "size": [options.size] * 2, "max_steps": 100}
    _, made = brl_jax.designs(base, options.levels, observation="index")
    first = jax.tree.map(
        lambda array: jnp.broadcast_to(array, (options.levels, *array.shape)), made.layout(base)
    )

    def mutate(key: Any) -> Any:
        keys = jax.random.split(key, options.levels)
        return jax.vmap(partial(made.mutate, edits=5))(keys, first)

    def tables(key: Any) -> Any:
        return made.params(mutate(key))

    def regrets(key: Any) -> Any:
        params = tables(key)
        return brl_jax.regret(params, brl_jax.random_policy(params), within="max_steps")

    parts = {"mutants": mutate, "with their tables": tables, "with their regrets": regrets}
    for name, function in parts.items():
        print(f"{name:20} {rate(jax.jit(function), options.levels):12,.0f} a second")
    print(f"{options.levels:,} levels of {options.size}x{options.size} on {jax.devices()[0]}")


if __name__ == "__main__":
    main()
