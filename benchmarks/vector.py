"""Many robots at once: `LevelVectorEnv` beside Gymnasium's SyncVectorEnv and EnvPool.

    python benchmarks/vector.py

All give whole Gymnasium results: observations, rewards, terminated, truncated, info; ours with the
masks. Ours walk the final maze, with its puddles, by random possible actions; the peers slide over
FrozenLake's ice by random moves. All actions are drawn beforehand. Of ours, `copy=False` hands out
the arrays that it writes into, without copies. EnvPool runs in an environment of its own, which the
first run sets up; where it cannot be installed, the run says so.

With the extra `fast`, ours is also set beside a bare loop over the same tables, which writes
observations, rewards and flags into arrays that are there, checks nothing and masks nothing.
"""

from __future__ import annotations

import math
import subprocess
import sys
import time
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from peers import Peer
from timing import Measure, rounds, table, versions

import babyrobot_levels as brl

SIZES = (64, 1024, 16_384)
LEVEL = "final-maze"
SECONDS = 0.1
"""About how long a measurement lasts."""

LENGTH = 500_000
"""How many actions are drawn beforehand: more of them would have to come from main memory."""

ROLLOUT = (1024, 8192)
"""Robots and steps of a rollout."""


def ours(engine: str, num_envs: int, copy: bool) -> Measure:
    """Return a measure of an engine's steps per second, with random possible actions."""
    steps = max(20, LENGTH // num_envs)
    repeats = math.ceil(SECONDS * 5e7 / LENGTH)
    envs: Any = gymnasium.make_vec(
        "babyrobot/Level-v0", num_envs=num_envs, level=LEVEL, engine=engine, copy=copy
    )
    # The same seed and the same actions give the same walk: they stay possible.
    envs.reset(seed=1)
    envs.action_space.seed(1)
    actions = []
    for _ in range(steps):
        actions.append(envs.action_space.sample())
        envs.step(actions[-1])

    def measure() -> float:
        seconds = 0.0
        for _ in range(repeats):
            envs.reset(seed=1)
            begin = time.perf_counter()
            for action in actions:
                envs.step(action)
            seconds += time.perf_counter() - begin
        return repeats * steps * num_envs / seconds

    return measure


def sync(num_envs: int) -> Measure:
    """Return a measure of the steps per second of Gymnasium's own vector environment."""
    steps = max(5, int(SECONDS * 6e4 / num_envs))
    envs = gymnasium.make_vec(
        "FrozenLake-v1", num_envs=num_envs, vectorization_mode="sync", map_name="8x8"
    )
    moves = np.random.default_rng(0).integers(4, size=(steps, num_envs))

    def measure() -> float:
        envs.reset(seed=1)
        begin = time.perf_counter()
        for move in moves:
            envs.step(move)
        return steps * num_envs / (time.perf_counter() - begin)

    return measure


def pool(peer: Peer, num_envs: int) -> Measure:
    """Return a measure of EnvPool's steps per second."""
    steps = max(5, int(SECONDS * 1e6 / num_envs))
    return lambda: steps * num_envs / float(peer.ask(num_envs=num_envs, steps=steps)["seconds"])


def bare(num_envs: int) -> Measure:
    """Return a measure of a compiled loop that does nothing but walk."""
    import numba

    from babyrobot_levels.engine.tables import build_tables

    level = brl.load(LEVEL)
    tables = build_tables([level.compile()], [2**62], 0)
    width = level.size[0]
    states = np.arange(tables.over.size)
    shown = np.stack([states % width, states // width], axis=1)

    @numba.njit
    def walk(  # type: ignore[no-untyped-def]
        actions, state, next_state, reward, chance, first, threshold, over, shown, block, start,
        observations, rewards, terminated, truncated,
    ):  # fmt: skip
        position = 0
        for robot in range(state.size):
            outcome = state[robot] * 5 + actions[robot]
            number = chance[outcome]
            if number >= 0:
                outcome = first[number]
                for further in range(threshold.shape[1] - 1):
                    outcome += block[position] >= threshold[number, further]
                position += 1
            here = next_state[outcome]
            rewards[robot] = reward[outcome]
            terminated[robot] = over[here]
            truncated[robot] = False
            observations[robot, 0] = shown[here, 0]
            observations[robot, 1] = shown[here, 1]
            state[robot] = start if over[here] else here
        return position

    steps = max(20, LENGTH // num_envs)
    repeats = math.ceil(SECONDS * 1e8 / LENGTH)
    start = int(tables.starts[0])
    state = np.full(num_envs, start)
    source = np.random.default_rng(1)
    block = source.random(num_envs)
    results = (
        np.empty((num_envs, 2), np.int64),
        np.empty(num_envs),
        np.empty(num_envs, np.bool_),
        np.empty(num_envs, np.bool_),
    )

    def step(action: Any) -> None:
        used = walk(
            action, state, tables.next_state, tables.reward, tables.chance, tables.first,
            tables.threshold, tables.over, shown, block, start, *results,
        )  # fmt: skip
        source.random(out=block[:used])

    actions = []
    for _ in range(steps):
        possible = tables.masks[state].astype(bool)
        actions.append(np.argmax(source.random((num_envs, 5)) * possible, axis=1))
        step(actions[-1])

    def measure() -> float:
        seconds = 0.0
        for _ in range(repeats):
            state[:] = start
            begin = time.perf_counter()
            for action in actions:
                step(action)
            seconds += time.perf_counter() - begin
        return repeats * steps * num_envs / seconds

    return measure


def rolling(engine: str, policy: Any) -> Measure:
    """Return a measure of the steps per second of whole rollouts."""
    level = brl.load(LEVEL)
    num_envs, num_steps = ROLLOUT

    def measure() -> float:
        begin = time.perf_counter()
        brl.rollout(level, policy, num_envs, num_steps, seed=1, engine=engine)
        return num_envs * num_steps / (time.perf_counter() - begin)

    return measure


def main() -> None:
    """Measure, and print the tables."""
    engines = ["numpy", *(["compiled"] if find_spec("numba") else [])]
    peer: Peer | None = None
    try:
        peer = Peer(
            "envpool", Path(__file__).with_name("peer_envpool.py"), ("envpool", "gymnasium")
        )
    except subprocess.CalledProcessError:
        print("missing: EnvPool, which cannot be installed for this Python", file=sys.stderr)
    told = ["babyrobot-levels", "gymnasium", "numpy"]
    print(versions([*told, "numba"] if "compiled" in engines else told), end="")
    print(f", envpool {peer.ask(num_envs=1, steps=1)['version']}" if peer is not None else "")
    for size in SIZES:
        names = {
            (engine, copy): f"LevelVectorEnv, {engine}, {size:,}{'' if copy else ', no copies'}"
            for engine in engines
            for copy in (True, False)
        }
        rates = rounds(
            {
                # More of them take too long.
                **({f"SyncVectorEnv FrozenLake, {size:,}": sync(size)} if size < 2000 else {}),
                **({f"EnvPool FrozenLake, {size:,}": pool(peer, size)} if peer else {}),
                **({f"bare compiled loop, {size:,}": bare(size)} if "compiled" in engines else {}),
                **{name: ours(engine, size, copy) for (engine, copy), name in names.items()},
            },
            5,
        )
        for baseline in rates:
            if baseline in names.values():
                break
            chosen = {baseline: rates[baseline]}
            chosen |= {name: rates[name] for name in names.values()}
            print(table(chosen, baseline, "steps per second"))
    if peer is not None:
        peer.close()
    solution = brl.solve(LEVEL)
    measures = {
        f"rollout, {engine}, {word}": rolling(engine, policy)
        for engine in engines
        for word, policy in (("random", "random"), ("greedy", solution))
    }
    print(table(rounds(measures, 5), next(iter(measures)), "steps per second"))


if __name__ == "__main__":
    main()
