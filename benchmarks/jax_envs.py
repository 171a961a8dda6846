"""Levels in JAX: random walks, beside gymnax, navix, XLand-MiniGrid, and the compiled engine.

    python benchmarks/jax_envs.py
    python benchmarks/jax_envs.py --sizes 1024 16384

All walks in JAX are the same compiled loop, which draws random actions, steps, and starts the next
episodes (see `jax_walks.py`). The aim is set for the environments as they are by default: gymnax's
FrozenLake, in which the same level is played, and FourRooms, and the empty rooms of 8×8 cells of
the other two. The compiled engine, which does not need JAX, draws its random actions by NumPy.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

import jax_walks
import numpy as np
import report
from timing import Comparison, Measure, in_turns, installed, needing

import babyrobot_levels as brl
from babyrobot_levels.envs.vector.env import LevelVectorEnv

SIZES = (1024, 16_384, 262_144)
"""How many environments there are."""

POOL = 400
"""How many mazes are played at once."""

AIM = 1.5
"""How many times as fast as the peers' environments the level of the same kind has to be."""

TRANSITIONS = 2**23
"""How many transitions a rollout has."""

LAKE, DRY = "gymnax FrozenLake", "gymnax FrozenLake 8x8, not slippery"
ROOMS, NAVIX, XMINIGRID = "gymnax FourRooms", "navix Empty 8x8", "XLand-MiniGrid Empty 8x8"
ENGINE, ENGINE_POOL = "LevelVectorEnv, compiled", f"LevelVectorEnv, compiled, {POOL} mazes"
ROLLOUT = "rollout, compiled"

BESIDE = {
    "frozen-lake": (LAKE, ROOMS, NAVIX, XMINIGRID),
    "frozen-lake-8x8-dry": (DRY,),
    "final-maze": (LAKE, ENGINE, ROLLOUT),
    "final-maze, view": (XMINIGRID,),
    "door-key": (LAKE,),
    f"{POOL} mazes": (LAKE, ENGINE_POOL),
}
"""What each of ours is set beside."""

DEFAULTS = (LAKE, ROOMS, NAVIX, XMINIGRID)


def mazes() -> list[brl.Level]:
    """Return different mazes, with puddles, of several sizes."""
    return list(brl.load_suite("bench-easy").split("train")[:POOL])


def ours(pool: Sequence[brl.Level]) -> dict[str, jax_walks.Walk]:
    """Return the walks in levels."""
    return {
        "frozen-lake": jax_walks.level_walk("frozen-lake", observation="index"),
        "frozen-lake-8x8-dry": jax_walks.level_walk("frozen-lake-8x8-dry", observation="index"),
        "final-maze": jax_walks.level_walk("final-maze"),
        "final-maze, view": jax_walks.level_walk("final-maze", observation="view"),
        "door-key": jax_walks.level_walk("door-key"),
        f"{POOL} mazes": jax_walks.level_walk(pool),
    }


def peers(pool: Sequence[brl.Level]) -> dict[str, jax_walks.Walk]:
    """Return the walks in the environments of others, and those of the compiled engine."""
    return {
        LAKE: jax_walks.gymnax_walk("FrozenLake"),
        DRY: jax_walks.gymnax_walk("FrozenLake", map_name="8x8", is_slippery=False),
        ROOMS: jax_walks.gymnax_walk("FourRooms"),
        NAVIX: jax_walks.navix_walk("Navix-Empty-8x8-v0"),
        XMINIGRID: jax_walks.xminigrid_walk("MiniGrid-Empty-8x8"),
        ENGINE: lambda size: needing("numba", partial(stepping, ["final-maze"], size)),
        ENGINE_POOL: lambda size: needing("numba", partial(stepping, pool, size)),
        ROLLOUT: lambda size: needing("numba", lambda: partial(rolling, size)),
    }


def stepping(levels: Sequence[Any], num_envs: int) -> Measure:
    """Return a measure of the compiled engine's steps per second, by random moves."""
    envs = LevelVectorEnv(
        levels=levels,
        draw_levels=True,
        num_envs=num_envs,
        engine="compiled",
        actions="moves",
        copy=False,
    )
    envs.reset(seed=1)
    source = np.random.default_rng(1)
    steps = max(5, int(5e7 * jax_walks.SECONDS / num_envs))

    def measure() -> float:
        begin = time.perf_counter()
        for _ in range(steps):
            envs.step(source.integers(4, size=num_envs))
        return steps * num_envs / (time.perf_counter() - begin)

    return measure


def rolling(num_envs: int) -> float:
    """Return the steps per second of a whole rollout, which keeps all transitions."""
    steps = TRANSITIONS // num_envs
    begin = time.perf_counter()
    brl.rollout("final-maze", "random", num_envs, steps, seed=1, actions="moves", engine="compiled")
    return steps * num_envs / (time.perf_counter() - begin)


def compare(count: int, sizes: Sequence[int] = SIZES) -> Iterator[Comparison]:
    """Yield what all numbers of environments have come to, after `count` rounds each."""
    versions = installed("babyrobot-levels", "jax", "gymnax", "navix", "xminigrid", "numba")
    pool = mazes()
    for size in sizes:
        walks = {**ours(pool), **peers(pool)}
        names = dict.fromkeys(each for name, others in BESIDE.items() for each in (name, *others))
        rates, missing = in_turns({name: walks[name](size) for name in names}, count)
        for name, others in BESIDE.items():
            yield Comparison(
                f"steps per second, {size:,}",
                {name: rates[name]},
                {other: rates[other] for other in others},
                {each: missing[each] for each in (name, *others) if each in missing},
                {(name, other): AIM for other in DEFAULTS} if name == "frozen-lake" else {},
                versions,
            )


if __name__ == "__main__":
    report.main(__doc__, compare, SIZES)
