"""Prioritised level replay with exact regret: python examples/prioritised_level_replay.py

PPO learns in mazes, and plays those more often from which most is to be learnt. How much that is,
is estimated, by MaxMC or by the positive value loss, or it is the exact regret. In each update, the
ranks of the estimates are compared with those of the exact regret. It needs the extra `sb3`:
pip install ".[sb3]"

After M. Jiang et al.: Prioritized Level Replay (2021), and Replay-Guided Adversarial Environment
Design (2021).
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from statistics import fmean
from typing import Any

import numpy as np
import torch
from arguments import at_least, parser_of
from numpy.typing import NDArray
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback

import babyrobot_levels as brl
from babyrobot_levels.envs.sb3 import LevelVecEnv
from babyrobot_levels.extensions.learning.charts import FAINT, STRONG, Curve, curves_svg

Floats = NDArray[np.float64]

DISCOUNT = 0.99
MAZES = {
    "version": 1,
    "kind": "suite",
    "seed": 3,
    "count": 400,
    "splits": {"train": 0.25, "test": 0.75},
    "size": {"min": [3, 3], "max": [8, 8]},
    "maze": {"algorithm": ["wilson", "depth-first"], "loops": {"max": 1}},
    "exit": "random",
    "rewards": {"step": 0, "exit": 1},
    "discount": DISCOUNT,
    "max_steps": 80,
}
VIEW: dict[str, Any] = {"observation": "view", "view_radius": 2, "actions": "moves"}

ESTIMATES = {"maxmc": "MaxMC", "value-loss": "positive value loss"}
METHODS = {"uniform": "all levels equally often", **ESTIMATES, "regret": "exact regret"}


def regrets(model: PPO, levels: Sequence[brl.Level]) -> Floats:
    """Return the exact regret of the model's policy in each level."""
    scores = brl.score(levels, model, deterministic=False, **VIEW)
    return np.array([score.regret for score in scores])


def rank_correlation(first: Floats, second: Floats) -> float:
    """Return Spearman's correlation: 1 where both have the same order."""
    return float(np.corrcoef(_mean_ranks(first), _mean_ranks(second))[0, 1])


def _mean_ranks(numbers: Floats) -> Floats:
    _, group, counts = np.unique(numbers, return_inverse=True, return_counts=True)
    ends = np.cumsum(counts)
    ranks: Floats = (ends - (counts - 1) / 2)[group]
    return ranks


class LevelReplay(BaseCallback):
    """Scores the levels of each rollout, before the policy is updated.

    Args:
        levels: the levels in which the model learns.
        method: what levels are scored by: a key of `METHODS`.
        sampler: is told the scores.

    Attributes:
        correlations: for each estimate, its rank correlation with the exact regret by steps.
    """

    def __init__(
        self, levels: Sequence[brl.Level], method: str, sampler: brl.PrioritizedSampler | None
    ) -> None:
        super().__init__()
        self.levels, self.method, self.sampler = levels, method, sampler
        self.best = np.zeros(len(levels))
        self.correlations: dict[str, list[tuple[float, float]]] = {name: [] for name in ESTIMATES}

    def _on_training_start(self) -> None:
        self.returns, self.factors = np.zeros((2, self.training_env.num_envs))
        self.factors[:] = 1

    def _on_rollout_start(self) -> None:
        self.numbers: list[list[int]] = []

    def _on_step(self) -> bool:
        numbers = [info["level_index"] for info in self.locals["infos"]]
        self.numbers.append(numbers)
        self.returns += self.factors * self.locals["rewards"]
        self.factors *= DISCOUNT
        for env in np.flatnonzero(self.locals["dones"]):
            self.best[numbers[env]] = max(self.best[numbers[env]], self.returns[env])
            self.returns[env], self.factors[env] = 0, 1
        return True

    def _on_rollout_end(self) -> None:
        buffer, numbers = self.model.rollout_buffer, np.array(self.numbers)
        steps = np.bincount(numbers.ravel(), minlength=len(self.levels))
        played = np.flatnonzero(steps)

        def mean(values: Floats) -> Floats:
            total = np.bincount(numbers.ravel(), values.ravel(), minlength=len(self.levels))
            return total[played] / steps[played]

        scores = {
            # The highest return that was seen in the level, less what is expected.
            "maxmc": mean(self.best[numbers] - buffer.values),
            # How much better actions were than expected, where they were.
            "value-loss": mean(np.maximum(buffer.advantages, 0)),
            "regret": regrets(self.model, [self.levels[number] for number in played.tolist()]),
        }
        for name, found in self.correlations.items():
            found.append((self.num_timesteps, rank_correlation(scores[name], scores["regret"])))
        if self.sampler is not None:
            self.sampler.update(played, scores[self.method])


def learn(
    method: str, train: Sequence[brl.Level], test: Sequence[brl.Level], steps: int, seed: int
) -> tuple[LevelReplay, brl.Scores]:
    """Train with one method and one seed; return what was found, and the scores in `test`."""
    sampler = None
    if method != "uniform":
        sampler = brl.PrioritizedSampler(len(train), temperature=1.0, staleness=0.3)
    settings: dict[str, Any] = {"levels": train, "draw_levels": True, "sampler": sampler, **VIEW}
    model = PPO(
        "MlpPolicy",
        LevelVecEnv(num_envs=32, **settings),
        n_steps=128,
        batch_size=512,
        n_epochs=4,
        learning_rate=1e-3,
        gamma=DISCOUNT,
        ent_coef=0.01,
        seed=seed,
    )
    replay = LevelReplay(train, method, sampler)
    model.learn(steps, callback=replay)
    return replay, brl.score(test, model, deterministic=False, **VIEW)


def picture(replays: Sequence[LevelReplay]) -> str:
    """Return the mean rank correlations of the estimates as an SVG document."""
    curves = []
    for name, color in zip(ESTIMATES, (STRONG, FAINT), strict=True):
        each = np.array([replay.correlations[name] for replay in replays])
        curves.append(Curve(ESTIMATES[name], (each.mean(axis=0) / [1000, 1]).tolist(), color))
    # The last curve gives the range.
    curves.sort(key=lambda curve: -min(y for _, y in curve.points))
    title = "rank correlation with the regret"
    return curves_svg(
        curves, goal=("exact regret", 1.0), x_title="thousands of steps", y_title=title
    )


def main() -> None:
    parser = parser_of(__doc__, steps=150_000, level=None)
    parser.add_argument("--seeds", type=at_least(1), default=3, help="number of seeds")
    parser.add_argument("-o", "--output", type=Path, help="an .svg file for the correlations")
    args = parser.parse_args()
    # Small networks learn fastest on one thread.
    torch.set_num_threads(1)
    suite = brl.load_suite(MAZES)
    train, test = list(suite.split("train")), list(suite.split("test"))
    # Both estimates are compared with the regret in all runs.
    replays = []
    print(f"{'levels by':26} {'mean share in test, by seed':29} mean  worst tenth")
    for method, title in METHODS.items():
        summaries = []
        for seed in range(args.seed, args.seed + args.seeds):
            replay, scores = learn(method, train, test, args.steps, seed)
            replays.append(replay)
            summaries.append(scores.summary)
        seeds = "  ".join(f"{each.mean:.3f}" for each in summaries)
        mean, worst = (fmean(getattr(each, of) for each in summaries)
                       for of in ("mean", "worst_tenth"))  # fmt: skip
        print(f"{title:26} {seeds:29} {mean:.3f} {worst:.3f}", flush=True)
    for name, title in ESTIMATES.items():
        each = [y for replay in replays for _, y in replay.correlations[name]]
        print(f"{title}: mean rank correlation with the regret {fmean(each):.2f}")
    if args.output:
        args.output.write_text(picture(replays), encoding="utf-8")


if __name__ == "__main__":
    main()
