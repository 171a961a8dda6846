"""Learning from a Minari dataset of good and bad moves: python examples/dataset_minari.py

The scores of the dataset are exact. It needs the extra `minari`: pip install ".[minari]"
"""

from __future__ import annotations

import os
from tempfile import TemporaryDirectory
from typing import Any

import minari
import numpy as np
from arguments import parsed, parser_of
from comparison import print_comparison, return_of
from minari.data_collector import EpisodeBuffer
from numpy.typing import NDArray

import babyrobot_levels as brl

NUM_ENVS = 64
ARRAYS = ("actions", "rewards", "terminations", "truncations")
# Minari warns about datasets without them.
ABOUT = ("algorithm_name", "author", "author_email", "code_permalink", "description")


def main() -> None:
    args = parsed(parser_of(__doc__, steps=100_000))
    level, best = args.level, brl.solve(args.level, actions="moves")
    # Half of the moves are optimal, the others are random ones.
    policy = 0.5 * np.eye(4)[best.policy.ravel()] + 0.5 / 4
    steps = max(1, args.steps // NUM_ENVS)
    data = brl.rollout(level, policy, NUM_ENVS, steps, args.seed, actions="moves")
    env = level.make(observation="index", actions="moves")
    about: dict[str, Any] = dict.fromkeys(ABOUT, "an example")
    about["ref_min_score"] = brl.evaluate(level, "random", actions="moves").expected_return
    about["ref_max_score"] = best.expected_return
    with TemporaryDirectory() as folder:
        os.environ["MINARI_DATASETS_PATH"] = folder  # by default, a folder in the user's home
        name = f"babyrobot/{level.name}-v0"
        minari.create_dataset_from_buffers(name, episodes(data), env, eval_env=env, **about)
        dataset = minari.load_dataset(name)
        print(f"{dataset.total_episodes:,} episodes, {dataset.total_steps:,} steps")
        greedy = learn(dataset, best.policy.size, level.discount).reshape(best.policy.shape)
        learned = np.array(return_of(greedy, level, "moves"))
        print(f"normalized score: {minari.get_normalized_score(dataset, learned):.4f}")
    print_comparison(level, {"learned, greedy": greedy}, actions="moves")


def episodes(data: brl.Rollout) -> list[EpisodeBuffer]:
    """Return the episodes of a rollout that come to an end."""
    buffers = []
    for env, over in enumerate((data.terminations | data.truncations).T):
        ends = np.flatnonzero(over) + 1
        for begin, end in zip([0, *ends], ends, strict=False):
            rows = slice(begin, end), env
            states = np.append(data.observations[rows], data.next_observations[end - 1, env])
            arrays = {name: getattr(data, name)[rows] for name in ARRAYS}
            buffers.append(EpisodeBuffer(observations=states, **arrays))
    return buffers


def learn(dataset: minari.MinariDataset, num_states: int, discount: float) -> NDArray[np.int64]:
    """Return the best action of each state, among those that the dataset has."""
    rows = list(dataset)
    pairs = np.concatenate([4 * each.observations[:-1] + each.actions for each in rows])
    following = np.concatenate([each.observations[1:] for each in rows])
    rewards = np.concatenate([each.rewards for each in rows])
    terminated = np.concatenate([each.terminations for each in rows])
    counts, values = np.bincount(pairs, minlength=4 * num_states), np.zeros((num_states, 4))
    for _ in range(500):
        targets = rewards + discount * np.where(terminated, 0, values.max(axis=1)[following])
        totals = np.bincount(pairs, targets, counts.size)
        values = np.where(counts > 0, totals / counts.clip(1), -np.inf).reshape(-1, 4)
    return np.asarray(values.argmax(axis=1))


if __name__ == "__main__":
    main()
