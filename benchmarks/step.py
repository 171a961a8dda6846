"""One robot, one step at a time: the final maze beside Gymnasium's own grid worlds.

    python benchmarks/step.py

All are stepped with a fixed list of random moves and reset when an episode ends. What is counted
is whole Gymnasium steps: observation, reward, terminated, truncated, info; ours with the mask.
"""

from __future__ import annotations

import random
import time
from typing import Any

import gymnasium
from timing import Measure, rounds, table, versions

import babyrobot_levels  # noqa: F401  (registers the environments)

STEPS = 100_000
OURS, PEER = "babyrobot/final-maze-v0", "FrozenLake-v1 8x8"


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


def main() -> None:
    """Measure, and print the table."""
    ours = gymnasium.make("babyrobot/final-maze-v0")
    lake = gymnasium.make("FrozenLake-v1", map_name="8x8")
    rates = rounds(
        {
            PEER: stepping(lake, 0),
            "CliffWalking-v1": stepping(gymnasium.make("CliffWalking-v1"), 0),
            OURS: stepping(ours, 1),
            "babyrobot/frozen-lake-v0": stepping(gymnasium.make("babyrobot/frozen-lake-v0"), 1),
            f"{PEER}, unwrapped": stepping(lake.unwrapped, 0),
            f"{OURS}, unwrapped": stepping(ours.unwrapped, 1),
        }
    )
    print(versions(["babyrobot-levels", "gymnasium", "numpy"]))
    print(table(rates, PEER, "steps per second"))


if __name__ == "__main__":
    main()
