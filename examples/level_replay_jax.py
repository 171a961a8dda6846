"""Prioritised level replay by exact regret, in one `jax.jit`: python examples/level_replay_jax.py

The learner of ppo_jax.py plays mazes. Before each of its updates, the exact regret of its policy in
every maze is computed, and the mazes of the next episodes are drawn by the ranks of these regrets;
or all are drawn equally often, for comparison. It needs the extra `jax`: pip install ".[jax]"

After M. Jiang et al.: Prioritized Level Replay (2021). Results may differ between devices.
"""

from __future__ import annotations

import time
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from arguments import at_least, parser_of, suite_of
from jax import Array
from ppo_jax import NUM_ENVS, NUM_STEPS, Learner, Scale, State, scale_of

import babyrobot_levels as brl
import babyrobot_levels.jax as brl_jax

MAZES = {
    "version": 1,
    "kind": "suite",
    "name": "tiny-mazes-with-loops",
    "seed": 3,
    "count": 2000,
    "splits": {"train": 0.75, "test": 0.25},
    "size": {"min": [3, 3], "max": [5, 5]},
    "maze": {"algorithm": ["wilson", "depth-first"], "loops": {"max": 1}},
    "rewards": {"step": -1, "exit": 100},
    "max_steps": 80,
}
VIEW: dict[str, Any] = {"observation": "view", "view_radius": 4, "see_through": True}
TEMPERATURE, STALENESS = 3.0, 0.1


class Figures(NamedTuple):
    """How good a policy is, exactly: mean shares, `(return - random) / (optimum - random)`."""

    train: Array
    test: Array
    worst_tenth: Array  # the mean of the tenth of the test levels with the least shares


def priorities(
    scores: Array, ages: Array, temperature: float = TEMPERATURE, staleness: float = STALENESS
) -> Array:
    """Return with which probability each level is drawn, `[levels]`.

    Args:
        scores: such as regrets: the higher, the more often a level is drawn.
        ages: how many updates ago each level was played last.
        temperature: the higher, the less the ranks of scores matter.
        staleness: the share of draws by age.
    """
    ranks = 1 + jnp.argsort(jnp.argsort(-scores))
    by_score = (1 / ranks) ** (1 / temperature)
    by_age = ages / jnp.maximum(ages.sum(), 1)
    return (1 - staleness) * by_score / by_score.sum() + staleness * by_age


@partial(jax.jit, static_argnames=("learner", "every"))
def run(
    keys: Array, prioritised: Array, train: Any, test: Any, *, learner: Learner, every: int
) -> Any:
    """Learn once for each key; return `Figures`, `[keys, stages]`.

    Args:
        keys: sources of randomness.
        prioritised: for each key, whether levels are drawn by regret; all equally often if not.
        train: the levels to learn in.
        test: the levels to be tested on.
        learner: the learner.
        every: after how many updates it is evaluated.
    """
    to_learn, to_test = scale_of(train), scale_of(test)

    def shares(state: State, scale: Scale) -> Array:
        returns = learner.returns(state.weights, scale.params)
        return (returns - scale.random) / (scale.best - scale.random)

    def learn(case: tuple[Array, Array]) -> Any:
        key, by_regret = case
        start_key, key = jax.random.split(key)

        def update(carry: tuple[State, Array], key: Array) -> tuple[Any, None]:
            state, ages = carry
            regrets = to_learn.best - learner.returns(state.weights, train)
            weights = jnp.where(by_regret, priorities(regrets, ages), 1)
            state, played = learner.update(state, train.weighted(weights), key)
            return (state, (ages + 1).at[played].set(0)), None

        def stage(carry: tuple[State, Array], keys: Array) -> tuple[Any, Figures]:
            carry, _ = jax.lax.scan(update, carry, keys)
            in_train, in_test = (shares(carry[0], scale) for scale in (to_learn, to_test))
            worst = jnp.sort(in_test)[: max(1, len(in_test) // 10)]
            return carry, Figures(in_train.mean(), in_test.mean(), worst.mean())

        keys = jax.random.split(key, (learner.updates // every, every))
        start = learner.start(start_key, train), jnp.ones(train.num_levels)
        return jax.lax.scan(stage, start, keys)[1]

    return jax.lax.map(learn, (keys, prioritised))


def main() -> None:
    parser = parser_of(__doc__, steps=500_000, steps_help="steps of each run", level=None)
    parser.add_argument(
        "--suite", type=partial(suite_of, splits=("train", "test")), default=brl.load_suite(MAZES),
        help="a name or a path; its levels need a time limit",
    )  # fmt: skip
    parser.add_argument("--seeds", type=at_least(1), default=3, help="number of seeds")
    parser.add_argument("--every", type=at_least(1), default=15, help="updates per evaluation")
    args = parser.parse_args()
    env, train = brl_jax.make(args.suite.split("train"), **VIEW)
    _, test = brl_jax.make(args.suite.split("test"), **VIEW)

    stages = max(1, round(args.steps / (NUM_ENVS * NUM_STEPS * args.every)))
    sizes = {"learner": Learner(env, train, stages * args.every), "every": args.every}
    seeds = range(args.seed, args.seed + args.seeds)
    keys = jnp.stack([jax.random.key(seed) for seed in seeds])
    # The same seeds with both methods.
    prioritised = jnp.repeat(jnp.array([False, True]), args.seeds)
    inputs = jnp.concatenate([keys, keys]), prioritised, train, test
    began = time.perf_counter()
    compiled = run.lower(*inputs, **sizes).compile()
    ready = time.perf_counter()
    figures = jax.block_until_ready(compiled(*inputs))
    ended = time.perf_counter()

    print(f"{train.num_levels} levels to learn in, {test.num_levels} to be tested on")
    print("mean share over seeds   all levels equally often         by exact regret")
    print("      steps             train   test  worst tenth    train   test  worst tenth")
    means = [each.reshape(2, args.seeds, stages).mean(axis=1) for each in figures]
    for stage in range(stages):
        steps = (stage + 1) * args.every * NUM_ENVS * NUM_STEPS
        both = [[each[method, stage] for each in means] for method in range(2)]
        columns = "".join(f"{a:9.3f}{b:7.3f}{c:13.3f}" for a, b, c in both)
        print(f"{steps:11,}{'':10}{columns}")
    for number, name in enumerate(("all levels equally often", "by exact regret")):
        last = figures.test.reshape(2, args.seeds, stages)[number, :, -1]
        print(f"{name}: share in test {'  '.join(f'{share:.3f}' for share in last)}")
    print(f"seeds {', '.join(map(str, seeds))}; {ready - began:.1f} s to compile, "
          f"{ended - ready:.1f} s to run on {jax.devices()[0]}")  # fmt: skip


if __name__ == "__main__":
    main()
