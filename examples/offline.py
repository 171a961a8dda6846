"""Learns from a data set alone, without playing: python examples/offline.py

Robots that move at random fill the data set. What it says of each action, how often it led where
and what that cost, is solved by value iteration.
"""

from __future__ import annotations

import argparse

import numpy as np
from comparison import print_comparison
from numpy.typing import NDArray

import babyrobot_levels as brl


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--level", default="final-maze", help="a name, a path or a share code")
    parser.add_argument("--steps", type=int, default=2_000_000, help="steps of all robots together")
    parser.add_argument("--robots", type=int, default=1024)
    parser.add_argument("--seed", type=int, default=0)
    args = parser.parse_args()

    level = brl.load(args.level)
    data = brl.rollout(
        level, "uniform", args.robots, args.steps // args.robots, args.seed, actions="moves"
    )
    width, height = level.size
    values = learn(data, width * height, level.discount)
    greedy = values.argmax(axis=1).reshape(height, width)
    print(f"{data.actions.size:,} steps")
    print_comparison(level, {"learned, greedy": greedy}, actions="moves")


def learn(data: brl.Rollout, num_states: int, discount: float) -> NDArray[np.float64]:
    """Return action values, `[states, 4]`; what the data set does not have counts as the end."""
    pairs = 4 * data.observations.ravel().astype(np.int64) + data.actions.ravel()
    # Where an episode ended, nothing follows: the robot comes to a state of its own.
    ahead = np.where(data.terminations, num_states, data.next_observations).ravel()
    size = (num_states * 4, num_states + 1)
    counts = np.bincount(pairs * size[1] + ahead, minlength=size[0] * size[1]).reshape(size)
    often = np.maximum(counts.sum(axis=1), 1)
    rewards = np.bincount(pairs, data.rewards.ravel(), size[0]) / often
    chances = counts[:, :num_states] / often[:, None]
    values = np.zeros(size[0])
    for _ in range(10_000):
        before, best = values, values.reshape(-1, 4).max(axis=1)
        values = rewards + discount * chances @ best
        if np.abs(values - before).max() < 1e-9:
            break
    return values.reshape(-1, 4)


if __name__ == "__main__":
    main()
