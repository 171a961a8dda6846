"""Learning from a Minari dataset of good and bad moves. It needs: pip install ".[minari]"."""

import os
from tempfile import TemporaryDirectory
from typing import Any

import minari
import numpy as np
from arguments import parsed, parser_of
from comparison import print_comparison, return_of
from numpy.typing import NDArray

import babyrobot_levels as brl

# Minari warns about datasets without them.
ABOUT = ("algorithm_name", "author", "author_email", "code_permalink", "description")


def learn(dataset: minari.MinariDataset, num_states: int, discount: float) -> NDArray[np.int64]:
    """Return the best action of each state, among those that the dataset has."""
    steps = [(e.observations[:-1], e.actions, e.rewards, e.observations[1:]) for e in dataset]
    states, actions, rewards, following = map(np.concatenate, zip(*steps, strict=True))
    ended = np.concatenate([e.terminations for e in dataset])
    pairs, values = 4 * states + actions, np.zeros((num_states, 4))
    counts = np.bincount(pairs, minlength=values.size)
    for _ in range(500):
        targets = rewards + discount * np.where(ended, 0, values.max(axis=1)[following])
        totals = np.bincount(pairs, targets, values.size)
        values = np.where(counts > 0, totals / counts.clip(1), -np.inf).reshape(-1, 4)
    return np.asarray(values.argmax(axis=1))


args = parsed(parser_of(__doc__, steps=100_000))
level, best = args.level, brl.solve(args.level, actions="moves")
policy = 0.5 * np.eye(4)[best.policy.ravel()] + 0.5 / 4  # half of the moves are random
data = brl.rollout(level, policy, 64, max(1, args.steps // 64), args.seed, actions="moves")
name = f"babyrobot/{level.name}-v0"
with TemporaryDirectory() as folder:
    os.environ["MINARI_DATASETS_PATH"] = folder  # by default, a folder in the user's home
    about: dict[str, Any] = dict.fromkeys(ABOUT, "-")
    brl.to_minari(data, name, level=level, actions="moves", observation="index", **about)
    dataset = minari.load_dataset(name)
    greedy = learn(dataset, best.policy.size, level.discount).reshape(best.policy.shape)
    learned = np.array(return_of(greedy, level, "moves"))
    print(f"normalized score: {minari.get_normalized_score(dataset, learned):.4f}")
print_comparison(level, {"learned, greedy": greedy}, actions="moves")
