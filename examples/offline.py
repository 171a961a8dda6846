"""Offline learning from a data set of random moves: python examples/offline.py

The frequencies of next states and the mean rewards of each action in the data set are solved by
value iteration.
"""

from __future__ import annotations

import numpy as np
from arguments import at_least, parsed, parser_of
from comparison import print_comparison
from numpy.typing import NDArray

import babyrobot_levels as brl


def main() -> None:
    parser = parser_of(__doc__, steps=2_000_000)
    parser.add_argument("--num-envs", "--robots", type=at_least(1), default=1024)
    args = parsed(parser)
    level = args.level
    # Each environment takes a step at least.
    steps = max(1, args.steps // args.num_envs)

    data = brl.rollout(level, "uniform", args.num_envs, steps, args.seed, actions="moves")
    width, height = level.size
    values = learn(data, width * height, level.discount)
    greedy = values.argmax(axis=1).reshape(height, width)
    print(f"{data.actions.size:,} steps")
    print_comparison(level, {"learned, greedy": greedy}, actions="moves")


def learn(data: brl.Rollout, num_states: int, discount: float) -> NDArray[np.float64]:
    """Return action values, `[states, 4]`; actions that the data set does not have are terminal."""
    pairs = 4 * data.observations.ravel().astype(np.int64) + data.actions.ravel()
    # All terminal states become one more state, without a value.
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
