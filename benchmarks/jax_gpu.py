"""Levels in JAX on the device that JAX has: steps and solved levels per second, and memory.

    python benchmarks/jax_gpu.py
    python benchmarks/jax_gpu.py --sizes 1024 4096 --levels 100

The walks are those of `jax_envs.py`, the solving that of `jax_solve.py`; nothing else is asked of a
GPU or TPU but a JAX that supports it. Each figure is the best of several rounds.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from typing import Any

import jax
import jax_envs
import jax_solve
from report import rate, table
from timing import FEW, ROUNDS, Measure, MissingPeer, installed

import babyrobot_levels as brl
import babyrobot_levels.jax as brl_jax

SIZES = (1024, 4096, 16_384, 65_536, 262_144, 1_048_576)
LEVELS = 4000
"""How many mazes are solved in one call."""

OBSERVATIONS = ("index", "position", "walls", "vector", "planes", "view")


def device() -> str:
    """Return what JAX runs on."""
    devices = jax.devices()
    versions = ", ".join(f"{name} {version}" for name, version in installed("jax").items())
    where = f"{len(devices)} x {devices[0].device_kind} ({devices[0].platform}), {versions}"
    return where + ("; JAX has no GPU or TPU here" if devices[0].platform == "cpu" else "")


def best(measure: Measure, rounds: int) -> str:
    """Return the best rate of some rounds, the first of which does not count."""
    try:
        measure()
        return rate(max(measure() for _ in range(rounds)))
    except MissingPeer as missing:
        return str(missing)


def stepping(pool: Sequence[brl.Level], sizes: Sequence[int], rounds: int) -> str:
    """Return a table of the steps per second, ours and those of a peer."""
    walks = jax_envs.ours(pool) | {jax_envs.LAKE: jax_envs.peers(pool)[jax_envs.LAKE]}
    rows = ((name, *(best(walk(size), rounds) for size in sizes)) for name, walk in walks.items())
    return table(rows, ("environments", *(f"{size:,}" for size in sizes)))


def solving(count: int, rounds: int) -> str:
    """Return a table of the mazes solved per second, in one call for all."""
    mazes = jax_solve.mazes(count)
    calls = {"optimum": jax_solve.optima, "regret": jax_solve.regrets}
    return table(
        (
            (name, best(jax_solve.rate_of(made(mazes), count), rounds))
            for name, made in calls.items()
        ),
        (f"{count:,} mazes of 8x8", "per second"),
    )


def memory(pool: Sequence[brl.Level]) -> str:
    """Return a table of the memory that the arrays of levels take."""

    pools: dict[str, Any] = {
        "frozen-lake": "frozen-lake",
        "door-key": "door-key",
        f"{len(pool)} mazes": pool,
    }

    def rows() -> Iterator[tuple[str, ...]]:
        for name, levels in pools.items():
            for observation in OBSERVATIONS:
                _, params = brl_jax.make(levels, observation=observation, actions="moves")
                size, states = params.nbytes, params.num_states
                yield name, observation, f"{states:,}", f"{size:,}", f"{size / states:,.0f}"

    return table(rows(), ("levels", "observation", "states", "bytes", "per state"))


def main() -> None:
    """Measure all, and print tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="few rounds")
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, help="of environments")
    parser.add_argument("--levels", type=int, default=LEVELS, help="mazes that are solved")
    asked = parser.parse_args()
    rounds = FEW if asked.quick else ROUNDS
    pool = jax_envs.mazes()
    print(device())
    print(f"\nSteps per second:\n{stepping(pool, asked.sizes, rounds)}", flush=True)
    print(f"\n{solving(asked.levels, rounds)}", flush=True)
    print(f"\n{memory(pool)}")


if __name__ == "__main__":
    main()
