"""Several robots: joint steps beside those of PettingZoo's pursuit and JaxMARL's Overcooked.

    python benchmarks/robots.py

Two robots in the level `two-pads`, and two pursuers on a grid of 8 by 8 cells: all take random
actions, and are reset when an episode ends. Pursuit, like ours, is not compiled; what its agents
see takes most of its time.
"""

from __future__ import annotations

import random
import time
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
import report
from jax_walks import jaxmarl_walk, team_walk
from timing import Comparison, Measure, compare_in_turns, installed

import babyrobot_levels as brl

STEPS = 20_000
TEAMS = 64, 16_384
LEVEL = "two-pads"


def joint_steps() -> Measure:
    """Return a measure of joint steps per second of the environment for one agent."""
    rng, env = random.Random(0), brl.TeamEnv(LEVEL)
    actions = [[rng.randrange(5), rng.randrange(5)] for _ in range(STEPS)]

    def measure() -> float:
        env.reset(seed=0)
        begin = time.perf_counter()
        for action in actions:
            _, _, terminated, _, _ = env.step(action)
            if terminated:
                env.reset()
        return STEPS / (time.perf_counter() - begin)

    return measure


def parallel_steps(env: Any, steps: int) -> Measure:
    """Return a measure of joint steps per second of a `ParallelEnv` whose agents have 5 actions."""
    rng = random.Random(0)

    def measure() -> float:
        env.reset(seed=0)
        begin = time.perf_counter()
        for _ in range(steps):
            env.step({agent: rng.randrange(5) for agent in env.agents})
            if not env.agents:
                env.reset()
        return steps / (time.perf_counter() - begin)

    return measure


def vector_steps(teams: int) -> Measure:
    """Return a measure of joint steps per second of many teams, which take random actions."""
    env = brl.TeamVectorEnv(LEVEL, num_envs=teams, copy=False)
    actions = np.random.default_rng(0).integers(5, size=(2_000 if teams < 1_000 else 20, teams, 2))
    env.reset(seed=0)

    def measure() -> float:
        begin = time.perf_counter()
        for each in actions:
            env.step(each)
        return len(actions) * teams / (time.perf_counter() - begin)

    return measure


def compare(count: int) -> Iterator[Comparison]:
    """Measure the environment for one agent, and that for an agent each."""
    with warnings.catch_warnings():
        # PettingZoo calls this way of making its environments deprecated.
        warnings.simplefilter("ignore", DeprecationWarning)
        from pettingzoo.sisl import pursuit_v5

    size = {"x_size": 8, "y_size": 8, "n_evaders": 1, "n_pursuers": 2}
    pursuit = pursuit_v5.parallel_env(max_cycles=500, **size)
    yield compare_in_turns(
        "joint steps of two robots per second",
        {
            "brl.parallel_env": parallel_steps(brl.parallel_env(LEVEL), STEPS),
            "brl.TeamEnv": joint_steps(),
        },
        {"PettingZoo's pursuit": parallel_steps(pursuit, STEPS // 10)},
        count,
        aims={("brl.parallel_env", "PettingZoo's pursuit"): 20},
        versions=installed("babyrobot-levels", "numpy", "pettingzoo"),
    )
    for teams in TEAMS:
        yield compare_in_turns(
            f"joint steps of {teams:,} teams of two robots per second",
            {
                "brl.TeamVectorEnv": vector_steps(teams),
                "brl_jax.make_team": team_walk(LEVEL)(teams),
            },
            {"JaxMARL's Overcooked": jaxmarl_walk("overcooked", "coord_ring")(teams)},
            count,
            versions=installed("babyrobot-levels", "numpy", "numba", "jax", "gymnax", "jaxmarl"),
        )


if __name__ == "__main__":
    report.main(__doc__, compare)
