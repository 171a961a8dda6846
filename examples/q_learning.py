"""Q-learning in thousands of environments at once, in NumPy: python examples/q_learning.py

All environments share one table of action values. In each step, the value of an action moves
towards the mean of the targets in the environments that took it.
"""

from __future__ import annotations

import time

import numpy as np
from arguments import at_least, parsed, parser_of
from comparison import print_comparison
from numpy.typing import NDArray

import babyrobot_levels as brl


def main() -> None:
    parser = parser_of(__doc__, steps=8_000_000)
    parser.add_argument("--num-envs", "--robots", type=at_least(1), default=4096)
    args = parsed(parser)
    level = args.level
    # Each environment takes a step at least.
    steps = max(1, args.steps // args.num_envs)

    began = time.perf_counter()
    values = q_learning(level, args.num_envs, steps, args.seed)
    print(f"{steps * args.num_envs:,} steps in {time.perf_counter() - began:.1f} s")

    print("\nvalues, learned:")
    print_grid(values.max(axis=2))
    print("values, exactly:")
    print_grid(brl.solve(level, actions="moves").values)
    print_comparison(level, {"learned, greedy": values.argmax(axis=2)}, actions="moves")


def q_learning(level: brl.Level, num_envs: int, steps: int, seed: int) -> NDArray[np.float64]:
    """Return action values, `[height, width, 4]`."""
    envs = brl.LevelVectorEnv(
        level,
        num_envs=num_envs,
        observation="index",
        actions="moves",
        max_episode_steps=level.max_steps or 500,
    )
    rng = np.random.default_rng(seed)
    # From 5 % of random actions in the first environment to random actions only in the last one.
    epsilon = np.linspace(0.05, 1.0, num_envs)
    width, height = level.size
    values = np.zeros((height * width, 4))
    updates = np.zeros((height * width, 4))
    states, _ = envs.reset(seed=seed)
    begins = np.zeros(num_envs, bool)
    for _ in range(steps):
        best = values.argmax(axis=1)[states]
        explores = rng.random(num_envs) < epsilon
        actions = np.where(explores, rng.integers(4, size=num_envs), best)
        next_states, rewards, terminated, truncated, _ = envs.step(actions)
        ahead = np.where(terminated, 0.0, values.max(axis=1)[next_states])
        targets = rewards + level.discount * ahead

        # A step that resets an environment takes no action.
        taken = (4 * states + actions)[~begins]
        count = np.bincount(taken, minlength=values.size).reshape(values.shape)
        total = np.bincount(taken, targets[~begins], values.size).reshape(values.shape)
        seen = count > 0
        updates += seen
        step_size = updates[seen] ** -0.5
        values[seen] += step_size * (total[seen] / count[seen] - values[seen])
        states, begins = next_states, terminated | truncated
    return values.reshape(height, width, 4)


def print_grid(values: NDArray[np.float64]) -> None:
    for row in values:
        print("  " + " ".join(f"{value:8.2f}" for value in row))


if __name__ == "__main__":
    main()
