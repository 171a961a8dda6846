"""Generalisation: agents learn in the levels of one split, and are scored in those of another.

python benchmarks/generalisation.py --train    # does runs without a result; can be interrupted
python benchmarks/generalisation.py --table    # the tables of docs/benchmark.md
python benchmarks/generalisation.py --curves   # its learning curves, into docs/images

Each run, of a method in a suite with a seed, leaves a file in benchmarks/generalisation/. PPO,
MaskablePPO and RecurrentPPO of Stable-Baselines3 need the extra `sb3`. The networks of `jax-…` are
trained by generalisation_jax.py first; those that are not there are left out.
"""

from __future__ import annotations

import argparse
import json
import statistics
import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, astuple
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np

import babyrobot_levels as brl
from babyrobot_levels.extensions.learning.charts import Curve, curves_svg
from babyrobot_levels.extensions.scoring.summaries import improvement_of, statistics_of
from babyrobot_levels.language.plain_data import json_mapping
from babyrobot_levels.text.files import write_text

RESULTS = Path(__file__).with_name("generalisation")
IMAGES = Path(__file__).parents[1] / "docs" / "images"
COLORS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7")
SUITES = ("bench-easy", "bench-hard", "bench-keys")
SEEDS = (0, 1, 2)
FIVE = range(5)
"""The seeds of networks that are trained together."""

FAMILIES: dict[str, dict[str, Any]] = {
    "starts": {"start": "random"},
    "larger": {"size": {"min": [8, 8], "max": [10, 10]}, "max_steps": 200},
    "algorithms": {
        "maze": {
            "algorithm": ["depth-first", "kruskal", "recursive-division", "sidewinder"],
            "loops": {"min": 0.25, "max": 1},
        }
    },
    "terrain": {"puddles": {"min": 6, "max": 10}, "wind": {"min": 1, "max": 2}},
}
"""Families for tests alone, by what they have in place of the fields of `bench-easy`."""

HELD_OUT = 200
"""How many levels each of these families has."""

TRAINED = Path(__file__).parents[1] / "build" / "generalisation"
"""Where generalisation_jax.py keeps tables and networks."""

NETWORKS = ("bench-easy", "bench-keys")
"""The suites in which it trains networks."""

PROGRAMS = {
    "feedforward": ("jax-ppo", "jax-plr-estimate", "jax-plr-regret"),
    "recurrent": ("jax-recurrent-ppo",),
}
"""What it trains together."""

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
    return lambda levels: brl.score(levels, "random", actions="moves")


def best_policy(suite: str, seed: int, steps: int) -> Callable[[Levels], brl.Scores]:
    """Return what scores optimal policies without a time limit."""

    def scores(levels: Levels) -> brl.Scores:
        best = {level.digest: brl.solve(level, actions="moves") for level in levels}
        return brl.score(levels, best, actions="moves")

    return scores


def q_learning(suite: str, seed: int, steps: int) -> Callable[[Levels], brl.Scores]:
    """Return what learns a table in each level that it is scored in."""

    def scores(levels: Levels) -> brl.Scores:
        learned = {}
        for level in levels:
            *_, last = brl.q_learning(level, EPISODES, step_size=0.5, every=EPISODES, seed=seed)
            learned[level.digest] = last.policy
        return brl.score(levels, learned, actions="moves")

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
                levels, model, observation="view", actions="moves", deterministic=False,
                episodes=PLAYED, seed=seed,
            )  # fmt: skip

    return scores


class Network:
    """A network that generalisation_jax.py has trained.

    Args:
        weights: its layers, by their names.
        told: which entries of a view it reads.
        seed: the seed of the actions that it draws, if it has memory.
    """

    def __init__(self, weights: Mapping[str, Any], told: Any, seed: int) -> None:
        self.weights, self.told = weights, told
        self.random = np.random.default_rng(seed)
        self.memory: Any = None

    def layer(self, name: str, values: Any) -> Any:
        return values @ self.weights[name] + self.weights[f"{name}-bias"]

    def entered(self, views: Any) -> Any:
        inputs = views.reshape(len(views), -1)[:, self.told].astype(np.float32)
        return self.layer("core", np.maximum(self.layer("inputs", inputs), 0))

    def chances(self, read: Any) -> Any:
        """Return the probabilities of the actions."""
        outputs = self.layer("heads", read)[:, :-1].astype(np.float64)
        raised = np.exp(outputs - outputs.max(axis=1, keepdims=True))
        return raised / raised.sum(axis=1, keepdims=True)

    def policy(self, views: Any) -> Any:
        """Return the probabilities of the actions, of a network without memory."""
        return self.chances(np.maximum(self.entered(views), 0))

    # -- with memory -------------------------------------------------------------------------

    def reset(self) -> None:
        self.memory = np.zeros((1, len(self.weights["memory"])), np.float32)

    def act(self, view: Any, mask: Any) -> int:
        """Return an action that is drawn; the memory is a gated recurrent unit."""
        entered = np.split(self.entered(view[None]), 3, axis=1)
        kept = np.split(self.layer("memory", self.memory), 3, axis=1)
        reset, update = (1 / (1 + np.exp(-entered[n] - kept[n])) for n in (0, 1))
        new = np.tanh(entered[2] + reset * kept[2])
        self.memory = (1 - update) * new + update * self.memory
        (chances,) = self.chances(self.memory)
        return int(self.random.choice(chances.size, p=chances))


@cache
def networks(suite: str, method: str) -> dict[str, Any]:
    """Return what generalisation_jax.py has written of a method: nothing, if it has not."""
    program = next(name for name, methods in PROGRAMS.items() if method in methods)
    path = TRAINED / f"{suite}-{program}.npz"
    if not path.exists():
        return {}
    with np.load(path) as kept:
        return dict(kept)


def trained(method: str, suite: str, seed: int, steps: int) -> Callable[[Levels], brl.Scores]:
    """Return what scores a network of generalisation_jax.py."""
    kept = networks(suite, method)
    (run,) = np.flatnonzero((kept["methods"] == method) & (kept["seeds"] == seed))
    weights = {
        name.removeprefix("weights-"): each[run]
        for name, each in kept.items()
        if name.startswith("weights-")
    }

    def scores(levels: Levels) -> brl.Scores:
        network = Network(weights, kept["told"], seed)
        has_memory = "memory" in weights
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "of an agent with memory", UserWarning)
            return brl.score(
                levels, network if has_memory else network.policy, observation="view",
                actions="moves", batched=not has_memory, episodes=PLAYED, seed=seed,
            )  # fmt: skip

    return scores


METHODS: dict[str, Callable[[str, int, int], Callable[[Levels], brl.Scores]]] = {
    "random": random_policy,
    "best": best_policy,
    "q-learning": q_learning,
    "ppo": ppo,
    "maskable-ppo": maskable_ppo,
    "recurrent-ppo": recurrent_ppo,
    **{method: partial(trained, method) for methods in PROGRAMS.values() for method in methods},
}

TITLES = {
    "random": "random policy",
    "best": "optimal policy",
    "q-learning": "Q-learning in each level",
    "ppo": "PPO",
    "recurrent-ppo": "RecurrentPPO",
    "maskable-ppo": "MaskablePPO",
}

TITLES_OF_NETWORKS = {
    "jax-ppo": "PPO",
    "jax-plr-estimate": "PLR by positive value loss",
    "jax-plr-regret": "PLR by exact regret",
    "jax-recurrent-ppo": "recurrent PPO",
}

IN_LEGENDS = {
    "jax-ppo": "PPO",
    "jax-plr-estimate": "PLR by loss",
    "jax-plr-regret": "PLR by regret",
    "jax-recurrent-ppo": "recurrent",
}

TABLES = (
    ("random", "best", "q-learning"),
    ("ppo", "recurrent-ppo"),
    ("maskable-ppo",),
    tuple(TITLES_OF_NETWORKS),
)
"""The methods of each table, which have the same observation and the same steps."""

ONCE = ("random", "best")
"""The methods in which nothing is drawn."""


# -- runs ------------------------------------------------------------------------------------


@cache
def levels_of(suite: str, split: str) -> Levels:
    """Return the levels of a split, generated once."""
    return list(brl.load_suite(suite).split(split))


@cache
def family(name: str) -> Levels:
    """Return the levels of a family that is held out, of the kind of `bench-easy`."""
    if name == "mirrored":
        return [mirrored(level) for level in levels_of("bench-easy", "test")]
    fields = brl.load_suite("bench-easy").to_dict()
    changes = {"name": f"bench-easy-{name}", "seed": 2, "count": HELD_OUT, "splits": {}}
    return list(brl.load_suite({**fields, **changes, **FAMILIES[name]}))


def mirrored(level: brl.Level) -> brl.Level:
    """Return the mirror image of a level of mazes and puddles: what was left is right."""
    fields = level.resolve().to_dict()
    last = fields["size"][0] - 1

    def across(at: Sequence[int], width: int = 1) -> list[int]:
        return [last - at[0] - width + 1, at[1]]

    for end in ("start", "exit"):
        fields[end] = across(fields[end])
    for puddle in fields.get("puddles", []):
        puddle["at"] = across(puddle["at"])
    for wall in fields["walls"]:
        # One to the east lies between two columns, one to the south is as long as its cells.
        is_east = wall["side"] == "E"
        wall["at"] = across(wall["at"], 2 if is_east else wall.get("length", 1))
    return brl.load({**fields, "name": f"{fields['name']}-mirrored"})


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
    spent: dict[str, Any] = {
        "steps": steps if method.endswith("ppo") else 0,
        "train_cpu_seconds": round(trained - began, 1),
    }
    held_out = {}
    if method in TITLES_OF_NETWORKS:
        kept = networks(suite, method)
        spent = {"steps": int(kept["steps"]), "device": str(kept["device"])}
        if suite == "bench-easy":
            held_out = {name: shares_of(scores(family(name))) for name in ("mirrored", *FAMILIES)}
    return {
        "method": method,
        "suite": suite,
        "seed": seed,
        "is_exact": test.is_exact,
        **spent,
        "score_cpu_seconds": round(time.process_time() - trained, 1),
        "train": json_mapping(asdict(seen.summary)),
        "test": json_mapping(asdict(test.summary)),
        "test-mazes": json_mapping(asdict(mazes.summary)),
        "test_shares": shares_of(test),
        "test_maze_shares": {score.level: round(score.share, 4) for score in mazes},
        **({"held_out_shares": held_out} if held_out else {}),
    }


def shares_of(scores: brl.Scores) -> list[float]:
    return [round(score.share, 4) for score in scores]


def train(chosen: Sequence[Any], folder: Path, steps: int) -> None:
    """Do the runs that have no result yet."""
    for method, suite, seed in chosen:
        path = folder / f"{suite}-{method}-{seed}.json"
        if path.exists() or (method in TITLES_OF_NETWORKS and not networks(suite, method)):
            continue
        result = result_of(method, suite, seed, steps)
        folder.mkdir(parents=True, exist_ok=True)
        write_text(path, json.dumps(result, indent=1) + "\n")
        print(f"{path.name}: mean share {result['test']['mean']:.3f} in test", flush=True)


# -- the table -------------------------------------------------------------------------------


def table(folder: Path = RESULTS) -> str:
    """Return the tables of the results, in Markdown."""
    found: dict[tuple[str, str], list[dict[str, Any]]] = {}
    for path in sorted(folder.glob("*.json")):
        result = json.loads(path.read_text("utf-8"))
        found.setdefault((result["method"], result["suite"]), []).append(result)
    parts = []
    for methods in TABLES:
        rows = [
            row(method, found[method, suite])
            for suite in SUITES
            for method in methods
            if (method, suite) in found
        ]
        parts += [HEAD + "".join(rows)] if rows else []
    compared = {
        method: found[method, "bench-easy"]
        for method in TITLES_OF_NETWORKS
        if (method, "bench-easy") in found
    }
    return "\n".join([*parts, *([held_out_table(compared)] if compared else [])])


HEAD = (
    "| suite | agent | seeds | train | test | IQM | worst tenth | solved | regret | success "
    "| test mazes |\n" + "|---" * 11 + "|\n"
)


def row(method: str, found: Sequence[dict[str, Any]]) -> str:
    """Return the row of a method in a suite: means over its seeds, an interval of `test`."""

    def mean(part: str, name: str, digits: int = 2) -> str:
        # Without the sign of a zero.
        value = round(statistics.fmean(each[part][name] for each in found), 4) + 0.0
        return f"{value:.{digits}f}"

    in_test = [each["test_shares"] for each in found]
    cells = [
        f"`{found[0]['suite']}`",
        (TITLES | TITLES_OF_NETWORKS)[method],
        str(len(found)),
        mean("train", "mean"),
        mean("test", "mean") if method in ONCE else interval(in_test),
        *(mean("test", name) for name in ("iqm", "worst_tenth", "solved")),
        mean("test", "regret", 1),
        mean("test", "success"),
        mean("test-mazes", "mean"),
    ]
    return f"| {' | '.join(cells)} |\n"


def held_out_table(found: Mapping[str, Sequence[dict[str, Any]]]) -> str:
    """Return how networks of `bench-easy` do in families that are held out, and compare them."""
    names = ("mirrored", *FAMILIES)
    lines = [
        f"| `bench-easy` | {' | '.join(names)} | better than PPO in test |",
        "|---" * (len(names) + 2) + "|",
    ]
    in_test = {
        method: np.array([each["test_shares"] for each in runs]) for method, runs in found.items()
    }
    for method, runs in found.items():
        cells = [interval([each["held_out_shares"][name] for each in runs]) for name in names]
        better = improvement_of(in_test[method], in_test["jax-ppo"])
        compared = "–" if method == "jax-ppo" else between(*astuple(better))
        lines.append(f"| {' | '.join([TITLES_OF_NETWORKS[method], *cells, compared])} |")
    return "\n".join(lines) + "\n"


def interval(shares: Any) -> str:
    """Return the mean of shares `[runs, levels]`, with its interval."""
    shares = np.array(shares)
    known, ends = statistics_of(shares, np.zeros((*shares.shape, 2)), 0.0, stratified=False)
    return between(known["mean"], *ends["mean"])


def between(value: float, low: float, high: float) -> str:
    return "{:.2f} ({:.2f} to {:.2f})".format(
        *(round(each, 4) + 0.0 for each in (value, low, high))
    )


def curves(suite: str) -> str:
    """Return the learning curves of the networks of a suite, as SVG: "" if there are none."""
    drawn: list[Curve] = []
    for method, title in IN_LEGENDS.items():
        kept = networks(suite, method)
        if kept:
            means = kept["curve"][kept["methods"] == method].mean(axis=(0, 2))
            millions = np.linspace(0, kept["steps"] / 1e6, len(means) + 1)[1:].tolist()
            drawn.append(
                Curve(title, [*zip(millions, means.tolist(), strict=True)], COLORS[len(drawn)])
            )
    return curves_svg(
        drawn, goal=("optimum", 1.0), x_title="steps, in millions",
        y_title=f"mean share in test of {suite}",
    )  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--train", action="store_true", help="do the runs that have no result yet")
    what.add_argument("--table", action="store_true", help="print the tables of the results")
    what.add_argument("--curves", action="store_true", help="draw the learning curves of networks")
    parser.add_argument("--method", action="append", choices=METHODS, help="only this method")
    parser.add_argument("--suite", action="append", choices=SUITES, help="only this suite")
    parser.add_argument("--seed", action="append", type=int, help="only this seed")
    parser.add_argument("--steps", type=int, default=STEPS, help="steps of training")
    parser.add_argument("--folder", type=Path, default=RESULTS, help="where results are")
    args = parser.parse_args()
    if args.table:
        print(table(args.folder), end="")
        return
    if args.curves:
        for suite in args.suite or NETWORKS:
            if svg := curves(suite):
                write_text(IMAGES / f"curves-{suite}.svg", svg)
        return
    chosen = [
        run
        for methods, suites, seeds in (
            (TITLES, SUITES, SEEDS),
            (TITLES_OF_NETWORKS, NETWORKS, FIVE),
        )
        for run in runs(
            [method for method in args.method or methods if method in methods],
            [suite for suite in args.suite or suites if suite in suites],
            args.seed or seeds,
        )
    ]
    train(chosen, args.folder, args.steps)


if __name__ == "__main__":
    main()
