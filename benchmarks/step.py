"""Single environments: the final maze beside Gymnasium's own grid worlds.

    python benchmarks/step.py

All take the same list of random moves, and are reset when an episode ends. A step returns complete
Gymnasium results: observation, reward, terminated, truncated, info; ours with the action mask.
"""

from __future__ import annotations

import random
import time
from collections.abc import Iterator
from typing import Any

import gymnasium
import report
from timing import Comparison, Measure, compare_in_turns, installed

import babyrobot_levels  # noqa: F401  (registers the environments)

STEPS = 100_000
MAZE, OUR_LAKE, LAKE = "babyrobot/final-maze-v0", "babyrobot/frozen-lake-v0", "FrozenLake-v1 8x8"


def stepping(env: gymnasium.Env[Any, Any], first_action: int) -> Measure:
    """Return a measure of an environment's steps per second; it has four moves."""
    rng = random.Random(0)
    actions = [first_action + rng.randrange(4) for _ in range(STEPS)]

    def measure() -> float:
        env.reset(seed=0)
        begin = time.perf_counter()
        for action in actions:
            _, _, terminated, truncated, _ = env.step(action)
            if terminated or truncated:
                env.reset()
        return STEPS / (time.perf_counter() - begin)

    return measure


def compare(count: int) -> Iterator[Comparison]:
    """Measure environments as `gymnasium.make` returns them, and without its wrappers."""
    maze, lake = gymnasium.make(MAZE), gymnasium.make("FrozenLake-v1", map_name="8x8")
    versions = installed("babyrobot-levels", "gymnasium", "numpy")
    yield compare_in_turns(
        "steps per second",
        {MAZE: stepping(maze, 1), OUR_LAKE: stepping(gymnasium.make(OUR_LAKE), 1)},
        {
            LAKE: stepping(lake, 0),
            "CliffWalking-v1": stepping(gymnasium.make("CliffWalking-v1"), 0),
        },
        count,
        aims={(MAZE, LAKE): 5},
        versions=versions,
    )
    yield compare_in_turns(
        "steps per second, unwrapped",
        {MAZE: stepping(maze.unwrapped, 1)},
        {LAKE: stepping(lake.unwrapped, 0)},
        count,
        aims={(MAZE, None): 700_000},
        versions=versions,
    )


if __name__ == "__main__":
    report.main(__doc__, compare)
