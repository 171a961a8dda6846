"""Vector environments: `LevelVectorEnv` beside Gymnasium's SyncVectorEnv and EnvPool.

    python benchmarks/vector.py

All return complete Gymnasium results: observations, rewards, terminated, truncated, info; ours with
action masks. Ours take random valid actions in the final maze, which has puddles; the peers take
random moves on FrozenLake's ice. All actions are drawn in advance. With `copy=False`, ours returns
its own arrays instead of new ones. EnvPool has a virtual environment of its own, which the first
run creates.

With the extra `fast`, ours is also compared with a bare loop over the same tables, which writes
observations, rewards and flags into existing arrays, without checks and masks.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import gymnasium
import numpy as np
import report
from peers import Peer
from timing import Comparison, Measure, compare_in_turns, installed, needing

import babyrobot_levels as brl

SIZES = (64, 1024, 16_384)
LEVEL = "final-maze"
ENGINES = ("numpy", "compiled")
SECONDS = 0.1
"""About how long a measurement lasts."""

LENGTH = 500_000
"""How many actions are drawn in advance: more of them would not fit into the cache."""

ROLLOUT = (1024, 8192)
"""Environments and steps of a rollout."""

AIMS = {
    ("numpy", "sync", 64): 40,
    ("numpy", "sync", 1024): 300,
    ("numpy", "envpool", 1024): 20,
    ("numpy", "envpool", 16_384): 60,
    ("compiled", "sync", 64): 150,
    ("compiled", "envpool", 1024): 100,
    ("compiled", "envpool", 16_384): 150,
    ("compiled", "bare", 1024): 0.6,
    ("compiled", "bare", 16_384): 0.6,
}
"""How many times as fast as a peer an engine has to be, with a number of environments."""


def on(engine: str, make: Callable[[], Measure]) -> Measure:
    """Return an engine's measure; the compiled one may be missing."""
    return needing("numba", make) if engine == "compiled" else make()


def ours(engine: str, num_envs: int, copy: bool) -> Measure:
    """Return a measure of an engine's steps per second, with random valid actions."""
    steps = max(20, LENGTH // num_envs)
    repeats = math.ceil(SECONDS * 5e7 / LENGTH)
    envs: Any = gymnasium.make_vec(
        "babyrobot/Level-v0", num_envs=num_envs, level=LEVEL, engine=engine, copy=copy
    )
    # The same seed and actions give the same episodes, so the actions stay valid.
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
    """Return a measure of a compiled loop that does nothing but step."""
    import numba

    from babyrobot_levels.envs.engine.tables import build_tables, masks_at, part_of

    level = brl.load(LEVEL)
    mdp = level.compile()
    tables = build_tables([part_of(level, mdp, 0)], [2**62])
    width = level.size[0]
    states = np.arange(mdp.num_states)
    shown = np.stack([states % width, states // width], axis=1)

    @numba.njit
    def run(  # type: ignore[no-untyped-def]
        actions, state, next_state, reward, first, threshold, is_terminal, shown,
        block, start, observations, rewards, terminated, truncated,
    ):  # fmt: skip
        position = 0
        for env in range(state.size):
            outcome = state[env] * 5 + actions[env]
            number = next_state[outcome]
            if number < 0:
                outcome = first[number]
                for further in range(threshold.shape[1] - 1):
                    outcome += block[position] >= threshold[number, further]
                position += 1
            here = next_state[outcome]
            rewards[env] = reward[outcome]
            terminated[env] = is_terminal[here]
            truncated[env] = False
            observations[env, 0] = shown[here, 0]
            observations[env, 1] = shown[here, 1]
            state[env] = start if is_terminal[here] else here
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
        used = run(
            action, state, tables.next_state, tables.reward, tables.first,
            tables.threshold, mdp.is_terminal, shown, block, start, *results,
        )  # fmt: skip
        source.random(out=block[:used])

    actions = []
    for _ in range(steps):
        possible = masks_at(tables.state_info, state, 5).astype(bool)
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


def compare(count: int) -> Iterator[Comparison]:
    """Measure three numbers of environments beside the peers, and then rollouts."""
    peer = Peer("envpool", "peer_envpool.py")
    versions = installed("babyrobot-levels", "gymnasium", "numpy", "numba") | peer.version
    for size in SIZES:
        names = {
            (engine, copy): f"LevelVectorEnv, {engine}, {size:,}{'' if copy else ', no copies'}"
            for engine in ENGINES
            for copy in (True, False)
        }
        peers = {
            "sync": f"SyncVectorEnv FrozenLake, {size:,}",
            "envpool": f"EnvPool FrozenLake, {size:,}",
            "bare": f"bare compiled loop, {size:,}",
        }
        yield compare_in_turns(
            "steps per second",
            {
                name: on(engine, partial(ours, engine, size, copy))
                for (engine, copy), name in names.items()
            },
            {
                # More of them take too long.
                **({peers["sync"]: sync(size)} if size < 2000 else {}),
                peers["envpool"]: pool(peer, size),
                peers["bare"]: needing("numba", partial(bare, size)),
            },
            count,
            aims={
                (name, peers[beside]): least
                for (engine, beside, number), least in AIMS.items()
                for (named, _), name in names.items()
                if (named, number) == (engine, size)
            },
            versions=versions,
        )
    peer.close()
    solution = brl.solve(LEVEL)
    yield compare_in_turns(
        "steps per second, whole rollouts",
        {
            f"rollout, {engine}, {word}": on(engine, partial(rolling, engine, policy))
            for engine in ENGINES
            for word, policy in (("random", "random"), ("greedy", solution))
        },
        {},
        count,
        aims={(f"rollout, compiled, {word}", None): 80e6 for word in ("random", "greedy")},
        versions=versions,
    )


if __name__ == "__main__":
    report.main(__doc__, compare)
