"""Generalisation: agents learn in the levels of one split, and are scored in those of another.

python benchmarks/generalisation.py --train    # trains what has no result yet; can be interrupted
python benchmarks/generalisation.py --table    # the table of docs/benchmark.md

Each run, of a method in a suite with a seed, leaves a file in benchmarks/generalisation/. PPO,
MaskablePPO and RecurrentPPO need the extra `sb3`.
"""

from __future__ import annotations

import argparse
import json
import statistics
import time
import warnings
from collections.abc import Callable, Sequence
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import babyrobot_levels as brl
from babyrobot_levels.scoring.results import plain
from babyrobot_levels.text.files import write_text

RESULTS = Path(__file__).with_name("generalisation")
SUITES = ("bench-easy", "bench-hard")
SEEDS = (0, 1, 2)

STEPS = 500_000
"""The steps that an agent may take in the levels of `train`."""

EPISODES = 300
"""The episodes of Q-learning in each level."""

PLAYED = 5
"""The episodes in which an agent with memory is scored, in each level."""

SEEN = 100
"""How many levels of `train` agents are scored in, beside all of `test`."""

TEST_MAZES = (
    "labyrinth", "labyrinth-2", "labyrinth-flipped", "large-corridor", "sixteen-rooms",
    "sixteen-rooms-fewer-doors", "small-corridor", "standard-maze", "standard-maze-2",
    "standard-maze-3",
)  # fmt: skip

Levels = Sequence[brl.Level]


# -- methods ---------------------------------------------------------------------------------


def random_policy(suite: str, seed: int, steps: int) -> Callable[[Levels], brl.Scores]:
    """Return what scores the random policy."""
    return lambda levels: brl.score("random", levels, actions="moves")


def best_policy(suite: str, seed: int, steps: int) -> Callable[[Levels], brl.Scores]:
    """Return what scores optimal policies without a time limit."""

    def scores(levels: Levels) -> brl.Scores:
        best = {level.digest: brl.solve(level, actions="moves") for level in levels}
        return brl.score(best, levels, actions="moves")

    return scores


def q_learning(suite: str, seed: int, steps: int) -> Callable[[Levels], brl.Scores]:
    """Return what learns a table in each level that it is scored in."""

    def scores(levels: Levels) -> brl.Scores:
        learned = {}
        for level in levels:
            *_, last = brl.q_learning(level, EPISODES, step_size=0.5, every=EPISODES, seed=seed)
            learned[level.digest] = last.policy
        return brl.score(learned, levels, actions="moves")

    return scores


def ppo(suite: str, seed: int, steps: int) -> Callable[[Levels], brl.Scores]:
    """Return what scores a network that has learned with PPO."""
    from stable_baselines3 import PPO

    return learned(PPO, "MlpPolicy", suite, seed, steps)


def maskable_ppo(suite: str, seed: int, steps: int) -> Callable[[Levels], brl.Scores]:
    """Return what scores a network that has learned with PPO and action masks."""
    from sb3_contrib import MaskablePPO

    return learned(MaskablePPO, "MlpPolicy", suite, seed, steps)


def recurrent_ppo(suite: str, seed: int, steps: int) -> Callable[[Levels], brl.Scores]:
    """Return what scores a network with memory that has learned with PPO."""
    from sb3_contrib import RecurrentPPO

    memory = {"lstm_hidden_size": 64, "net_arch": []}
    return learned(RecurrentPPO, "MlpLstmPolicy", suite, seed, steps, **memory)


def learned(
    method: Any, policy: str, suite: str, seed: int, steps: int, **network: Any
) -> Callable[[Levels], brl.Scores]:
    """Train a model of Stable-Baselines3 or sb3-contrib in the levels of `train`."""
    import torch
    from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
    from stable_baselines3.common.vec_env import VecNormalize

    from babyrobot_levels.envs.sb3 import LevelVecEnv

    class Layer(BaseFeaturesExtractor):
        """A layer that actor and critic share: views have many inputs, most of them 0."""

        def __init__(self, space: Any) -> None:
            super().__init__(space, features_dim=64)
            inputs = int(np.prod(space.shape))
            self.layers = torch.nn.Sequential(
                torch.nn.Flatten(), torch.nn.Linear(inputs, 64), torch.nn.ReLU()
            )

        def forward(self, views: Any) -> Any:
            return self.layers(views)

    # Small networks learn fastest on one thread.
    torch.set_num_threads(1)
    envs = LevelVecEnv(
        levels=levels_of(suite, "train"),
        draw_levels=True,
        num_envs=64,
        observation="view",
        actions="moves",
    )
    model = method(
        policy,
        VecNormalize(envs, norm_obs=False, gamma=0.99),
        n_steps=64,
        batch_size=512,
        n_epochs=4,
        learning_rate=1e-3,
        gamma=0.99,
        ent_coef=0.01,
        policy_kwargs={"features_extractor_class": Layer, **network},
        seed=seed,
    )
    model.learn(steps)

    def scores(levels: Levels) -> brl.Scores:
        torch.manual_seed(seed)
        with warnings.catch_warnings():
            # Few episodes tell little of one level; here their mean over many levels counts.
            warnings.filterwarnings("ignore", "of an agent with memory", UserWarning)
            # In partial views, a policy that draws its actions does not stay in a loop.
            return brl.score(
                model, levels, observation="view", actions="moves", deterministic=False,
                episodes=PLAYED, seed=seed,
            )  # fmt: skip

    return scores


METHODS = {
    "random": random_policy,
    "best": best_policy,
    "q-learning": q_learning,
    "ppo": ppo,
    "maskable-ppo": maskable_ppo,
    "recurrent-ppo": recurrent_ppo,
}

TITLES = {
    "random": "random policy",
    "best": "optimal policy",
    "q-learning": "Q-learning in each level",
    "ppo": "PPO",
    "maskable-ppo": "MaskablePPO",
    "recurrent-ppo": "RecurrentPPO",
}

ONCE = ("random", "best")
"""The methods in which nothing is drawn."""


# -- runs ------------------------------------------------------------------------------------


@cache
def levels_of(suite: str, split: str) -> Levels:
    """Return the levels of a split, generated once."""
    return list(brl.load_suite(suite).split(split))


def runs(methods: Sequence[str], suites: Sequence[str], seeds: Sequence[int]) -> list[Any]:
    """Return the runs: method, suite and seed; all with the first seed come first."""
    return [
        (method, suite, seed)
        for seed in seeds
        for method in methods
        for suite in suites
        if seed == seeds[0] or method not in ONCE
    ]


def result_of(method: str, suite: str, seed: int, steps: int) -> dict[str, Any]:
    """Train and score an agent."""
    began = time.process_time()
    scores = METHODS[method](suite, seed, steps)
    trained = time.process_time()
    seen = scores(levels_of(suite, "train")[:SEEN])
    test = scores(levels_of(suite, "test"))
    mazes = scores([brl.load(name) for name in TEST_MAZES])
    return {
        "method": method,
        "suite": suite,
        "seed": seed,
        "steps": steps if method.endswith("ppo") else 0,
        "is_exact": test.is_exact,
        "train_cpu_seconds": round(trained - began, 1),
        "score_cpu_seconds": round(time.process_time() - trained, 1),
        "train": plain(asdict(seen.summary)),
        "test": plain(asdict(test.summary)),
        "test-mazes": plain(asdict(mazes.summary)),
        "test_shares": [round(score.share, 4) for score in test],
        "test_maze_shares": {score.level: round(score.share, 4) for score in mazes},
    }


def train(chosen: Sequence[Any], folder: Path, steps: int) -> None:
    """Do the runs that have no result yet."""
    for method, suite, seed in chosen:
        path = folder / f"{suite}-{method}-{seed}.json"
        if path.exists():
            continue
        result = result_of(method, suite, seed, steps)
        folder.mkdir(parents=True, exist_ok=True)
        write_text(path, json.dumps(result, indent=1) + "\n")
        mean, seconds = result["test"]["mean"], result["train_cpu_seconds"]
        print(
            f"{path.name}: mean share {mean:.3f} in test, {seconds:.0f} s of training", flush=True
        )


# -- the table -------------------------------------------------------------------------------


def table(folder: Path = RESULTS) -> str:
    """Return a table of the results for each suite, in Markdown."""
    results = [json.loads(path.read_text("utf-8")) for path in sorted(folder.glob("*.json"))]
    parts = []
    for suite in SUITES:
        lines = [
            f"| `{suite}` | seeds | train | test | IQM | worst tenth | solved | regret | success "
            "| test mazes |",
            "|---|---|---|---|---|---|---|---|---|---|",
        ]
        for method, title in TITLES.items():
            found = [each for each in results if (each["suite"], each["method"]) == (suite, method)]
            if found:
                lines.append(row(title, found))
        parts.append("\n".join(lines) + "\n")
    return "\n".join(parts)


def row(title: str, found: Sequence[dict[str, Any]]) -> str:
    """Return the row of a method: means over its seeds, and the lowest and highest of `test`."""

    def mean(part: str, name: str) -> float:
        # Without the sign of a zero.
        return round(statistics.fmean(each[part][name] for each in found), 4) + 0.0

    test = f"{mean('test', 'mean'):.2f}"
    if len(found) > 1:
        ends = sorted(each["test"]["mean"] for each in found)
        test += f" ({ends[0]:.2f} to {ends[-1]:.2f})"
    cells = [
        title,
        str(len(found)),
        f"{mean('train', 'mean'):.2f}",
        test,
        *(f"{mean('test', name):.2f}" for name in ("iqm", "worst_tenth", "solved")),
        f"{mean('test', 'regret'):.1f}",
        f"{mean('test', 'success'):.2f}",
        f"{mean('test-mazes', 'mean'):.2f}",
    ]
    return f"| {' | '.join(cells)} |"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--train", action="store_true", help="do the runs that have no result yet")
    what.add_argument("--table", action="store_true", help="print the table of the results")
    parser.add_argument("--method", action="append", choices=METHODS, help="only this method")
    parser.add_argument("--suite", action="append", choices=SUITES, help="only this suite")
    parser.add_argument("--seed", action="append", type=int, help="only this seed")
    parser.add_argument("--steps", type=int, default=STEPS, help="steps of training")
    parser.add_argument("--folder", type=Path, default=RESULTS, help="where results are")
    args = parser.parse_args()
    if args.table:
        print(table(args.folder), end="")
        return
    chosen = runs(args.method or list(METHODS), args.suite or SUITES, args.seed or SEEDS)
    train(chosen, args.folder, args.steps)


if __name__ == "__main__":
    main()
