"""Ray Tune sweeps step sizes of Q-learning over levels and seeds, by exact shares of the optimum.

On this machine or on a cluster: python examples/sweep_tune.py --address auto
It needs the extra `rllib`: pip install ".[rllib]"
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np
from arguments import at_least, level_of
from cluster import add_address, connect
from ray import tune

import babyrobot_levels as brl

LEVELS = ["maze", "final-maze", "frozen-lake"]


def name_of(text: str) -> str:
    """Return the name or share code of a level, which is all that travels, if there is one."""
    level_of(text)
    return text


def learn(settings: dict[str, Any]) -> None:
    """Learn a level, and report the exact share of the optimum of the greedy policy so far."""
    for trials in brl.q_learning(every=50, **settings):
        (score,) = brl.score(settings["level"], trials.policy, actions="moves")
        tune.report({"share": score.share, "episodes": trials.number})


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--levels", nargs="+", type=name_of, default=LEVELS)
    parser.add_argument("--step-sizes", nargs="+", type=float, default=[0.1, 0.3, 1.0])
    parser.add_argument("--seeds", type=at_least(1), default=3, help="how many")
    parser.add_argument("--episodes", type=at_least(1), default=300, help="of each trial")
    parser.add_argument("--output", type=Path, default=Path("sweep"), help="folder of all results")
    add_address(parser)
    args = parser.parse_args()
    connect(args.address, cpus=2)

    space = {
        "level": tune.grid_search(args.levels),
        "step_size": tune.grid_search(args.step_sizes),
        "seed": tune.grid_search(list(range(args.seeds))),
        "episodes": args.episodes,
    }
    tuner = tune.Tuner(
        tune.with_resources(learn, {"cpu": 1}),
        param_space=space,
        # Processes go on with the next trial; a trial whose process or machine dies is repeated.
        tune_config=tune.TuneConfig(metric="share", mode="max", reuse_actors=True),
        run_config=tune.RunConfig(
            name="q-learning",
            storage_path=str(args.output.resolve()),
            failure_config=tune.FailureConfig(max_failures=2),
            verbose=0,
        ),
    )
    results = tuner.fit()
    if results.num_errors:
        sys.exit(f"{results.num_errors} of {len(results)} trials failed: see {args.output}")

    shares: dict[tuple[float, str], list[float]] = {}
    for each in results:
        trial = each.config["step_size"], each.config["level"]
        shares.setdefault(trial, []).append(each.metrics["share"])
    print(f"mean share of the optimum with {args.seeds} seeds, after {args.episodes} episodes")
    print("step size", *(f"{name:>14}" for name in args.levels), f"{'all levels':>14}")
    for size in args.step_sizes:
        row = [np.mean(shares[size, name]) for name in args.levels]
        print(f"{size:<9}", *(f"{share:14.1%}" for share in [*row, np.mean(row)]))


if __name__ == "__main__":
    main()
