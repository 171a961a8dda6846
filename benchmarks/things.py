"""Levels with things: compiling layouts of MiniGrid, and stepping beside the same layout without.

    python benchmarks/things.py

The layouts are those of MiniGrid's DoorKey 16x16 and KeyCorridor S6R3, whose border is implied: in
the first, a key opens the door between two rooms; in the second, it opens one of nine rooms, in
which the exit is. Compiling includes reading the mapping. Stepping takes random actions, with the
key and the door, and in the same layout without them; observations are states.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
import report
from timing import Comparison, Measure, compare_in_turns, installed, needing

import babyrobot_levels as brl
from babyrobot_levels.envs.vector.env import LevelVectorEnv

SECONDS = {"DoorKey 16x16": 0.1, "KeyCorridor S6R3": 1.0}
"""The most seconds that compiling may take."""

LEAST = 0.9
"""The least speed with things, as a ratio of that without."""

LENGTH = 200_000
"""About how many steps a measurement takes, of all environments together."""

SIDE = 14


def door_key() -> dict[str, Any]:
    """Return the layout of DoorKey: two rooms, and a locked door between them."""
    wall, door = 6, 8
    return {
        "version": 1,
        "size": [SIDE, SIDE],
        "start": [2, 3],
        "exit": [SIDE - 1, SIDE - 1],
        "blocked": [{"at": [wall, y]} for y in range(SIDE) if y != door],
        "items": [{"name": "key", "at": [3, 10]}],
        "doors": [{"at": [wall - 1, door], "side": "E", "needs": "key"}],
    }


def key_corridor() -> dict[str, Any]:
    """Return the layout of KeyCorridor: a corridor with three rooms on each side."""
    walls, doors = (4, 9), {(4, 2), (4, 6), (4, 11), (9, 1), (9, 7), (9, 12)}
    blocked = [
        [x, y]
        for y in range(SIDE)
        for x in range(SIDE)
        if (x in walls or (y in walls and not walls[0] < x < walls[1])) and (x, y) not in doors
    ]
    return {
        "version": 1,
        "size": [SIDE, SIDE],
        "start": [6, 7],
        "exit": [12, 6],
        "blocked": [{"at": cell} for cell in blocked],
        "items": [{"name": "key", "at": [1, 12]}],
        "doors": [{"at": [8, 7], "side": "E", "needs": "key"}],
    }


LAYOUTS = {"DoorKey 16x16": door_key(), "KeyCorridor S6R3": key_corridor()}


def without_things(layout: dict[str, Any]) -> dict[str, Any]:
    """Return a layout without key and door."""
    return {name: value for name, value in layout.items() if name not in ("items", "doors")}


def compiling(layout: dict[str, Any]) -> Measure:
    """Return a measure of how often a second a layout is compiled."""

    def measure() -> float:
        begin = time.perf_counter()
        brl.load(layout).compile()
        return 1 / (time.perf_counter() - begin)

    return measure


def one_by_one(layout: dict[str, Any]) -> Measure:
    """Return a measure of the steps per second of a single environment."""
    env: Any = brl.load(layout).make(observation="index").unwrapped
    actions = np.random.default_rng(0).integers(5, size=LENGTH).tolist()

    def measure() -> float:
        env.reset(seed=0)
        begin = time.perf_counter()
        for action in actions:
            if env.step(action)[2]:
                env.reset()
        return LENGTH / (time.perf_counter() - begin)

    return measure


def many(layout: dict[str, Any], engine: str, num_envs: int) -> Measure:
    """Return a measure of the steps per second of an engine."""
    envs = LevelVectorEnv(layout, num_envs=num_envs, engine=engine, observation="index")
    steps = LENGTH // num_envs
    actions = [*np.random.default_rng(0).integers(5, size=(steps, num_envs))]

    def measure() -> float:
        envs.reset(seed=0)
        begin = time.perf_counter()
        for each in actions:
            envs.step(each)
        return steps * num_envs / (time.perf_counter() - begin)

    return measure


def whole(layout: dict[str, Any], num_envs: int) -> Measure:
    """Return a measure of the steps per second of whole rollouts with the compiled engine."""
    level, steps = brl.load(layout), 10 * LENGTH // num_envs

    def measure() -> float:
        begin = time.perf_counter()
        brl.rollout(level, "random", num_envs, steps, seed=0, engine="compiled")
        return steps * num_envs / (time.perf_counter() - begin)

    return measure


def compare(count: int) -> Iterator[Comparison]:
    """Measure compiling, and then stepping in all ways."""
    versions = installed("babyrobot-levels", "numpy", "numba")
    yield compare_in_turns(
        "compiled per second",
        {name: compiling(layout) for name, layout in LAYOUTS.items()},
        {},
        count,
        aims={(name, None): 1 / most for name, most in SECONDS.items()},
        versions=versions,
    )
    layout = LAYOUTS["DoorKey 16x16"]
    ways: dict[str, Callable[[dict[str, Any]], Measure]] = {
        "one environment": one_by_one,
        "64 environments, numpy": partial(many, engine="numpy", num_envs=64),
        "1,024 environments, numpy": partial(many, engine="numpy", num_envs=1024),
        "64 environments, compiled": partial(many, engine="compiled", num_envs=64),
        "1,024 environments, compiled": partial(many, engine="compiled", num_envs=1024),
        "rollouts, compiled": partial(whole, num_envs=1024),
    }
    for name, make in ways.items():
        with_things, without = partial(make, layout), partial(make, without_things(layout))
        needed = "numba" if "compiled" in name else ""
        yield compare_in_turns(
            "steps per second",
            {f"{name}, with things": needing(needed, with_things)},
            {f"{name}, without": needing(needed, without)},
            count,
            aims={(f"{name}, with things", f"{name}, without"): LEAST},
            versions=versions,
        )


if __name__ == "__main__":
    report.main(__doc__, compare)
