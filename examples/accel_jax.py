"""Evolved levels as a curriculum, in one `jax.jit`: python examples/accel_jax.py -o evolved

The learner of ppo_jax.py plays levels that compiled code makes from one empty room. In each update
it learns from a batch of levels:

- `--method dr`, domain randomisation: new ones, each the room with a random number of edits;
- `--method plr`, robust prioritised level replay: from a buffer of those levels that have had the
  highest scores, drawn by rank and staleness; new ones are only scored;
- `--method accel`: likewise, and mutants of the levels that were replayed are scored, too.

`--score regret` is the exact regret of the policy, for which nothing is played. `pvl`, `maxmc` and
`learnability` are estimates from rollouts in the same levels, without learning where these are new.
Policies are tested in carved mazes, which no method draws from, and in new levels; `-o` saves the
levels that the buffer of the first seed has at the end, that with the highest score first. It needs
the extra `jax`: pip install ".[jax]"

`Curriculum` has all that a method does in one update, as functions to compile: `new` levels, their
`scored` values, what is `kept` in a `Buffer`, and `update`. `run` repeats it, for each seed.

After J. Parker-Holder et al.: Evolving Curricula with Regret-Based Environment Design (2022), and
M. Jiang et al.: Replay-Guided Adversarial Environment Design (2021). Results may differ between
devices.
"""

from __future__ import annotations

import time
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from arguments import at_least, parser_of
from jax import Array
from level_replay_jax import priorities
from ppo_jax import DISCOUNT, Learner, State, Steps, advantages_of, figures_of, scale_of

import babyrobot_levels.jax as brl_jax

ROOM = {
    "version": 1,
    "size": [5, 5],
    "start": [0, 0],
    "exit": [4, 4],
    "rewards": {"step": -1, "exit": 100},
    "max_steps": 50,
}
METHODS = ("dr", "plr", "accel")
SCORES = ("regret", "pvl", "maxmc", "learnability")
BATCH, BUFFER = 64, 256  # levels of an update and of a test, and of the buffer
COPIES, LENGTH = 2, 64  # environments in each level of a batch, and the steps that each takes
MOST_EDITS = 60  # of new levels
EDITS = 3  # of mutants
KINDS = ("wall", "puddle", "start")  # of edits; the exit stays


class Buffer(NamedTuple):
    """Levels to be replayed, along the first axis of all arrays."""

    layouts: brl_jax.Layout
    scores: Array
    highest: Array  # the highest return of an episode so far
    ages: Array  # how many updates ago they were played last


class Curriculum:
    """Which levels are played, as functions to compile.

    Args:
        learner: who learns in them.
        designs: makes the tables of a batch of levels.
        method: one of `METHODS`.
        score: one of `SCORES`.
    """

    def __init__(self, learner: Learner, designs: Any, method: str, score: str) -> None:
        self.learner, self.designs, self.method, self.score = learner, designs, method, score
        self.room = designs.layout(designs.base)
        self.mutate = partial(designs.mutate, kinds=KINDS)

    def new(self, key: Array, count: int) -> brl_jax.Layout:
        """Return new levels: the room with 0 to `MOST_EDITS` edits."""
        edits_key, key = jax.random.split(key)
        edits = jax.random.randint(edits_key, (count,), 0, MOST_EDITS + 1)
        mutate = jax.vmap(self.mutate, (0, None, 0))
        layouts: brl_jax.Layout = mutate(jax.random.split(key, count), self.room, edits)
        return layouts

    def played(self, weights: Any, params: Any, key: Array) -> Steps:
        """Play a batch of levels, each in some environments, which stay in it."""
        params = replace(params, draws_levels=False)
        reset_key, key = jax.random.split(key)
        levels = jnp.tile(jnp.arange(BATCH), COPIES)
        reset = jax.vmap(self.learner.env.reset_to_level, (0, 0, None))
        begun = reset(jax.random.split(reset_key, levels.size), levels, params)
        return self.learner.play(weights, params, begun, key, LENGTH)[1]

    def scored(
        self, weights: Any, layouts: brl_jax.Layout, highest: Array, key: Array
    ) -> tuple[Array, Array]:
        """Return the scores of a batch of levels, and the highest return in each so far."""
        params = self.designs.params(layouts)
        steps = None if self.score == "regret" else self.played(weights, params, key)
        return self.estimated(weights, params, steps, highest)

    def estimated(
        self, weights: Any, params: Any, steps: Steps | None, highest: Array
    ) -> tuple[Array, Array]:
        """Return the same, once they are played."""
        if steps is None or self.score == "regret":
            best = brl_jax.optimum(params, within="max_steps").returns
            return best - self.learner.returns(weights, params), highest
        highest = jnp.maximum(highest, highest_returns(steps, BATCH))
        return estimates(steps, highest)[self.score], highest

    def start(self, key: Array) -> Buffer:
        """Return a buffer of new levels without scores: all that have one go before them."""
        unknown = jnp.full(BUFFER, -jnp.inf)
        return Buffer(self.new(key, BUFFER), unknown, unknown, jnp.zeros(BUFFER))

    def kept(self, buffer: Buffer, weights: Any, layouts: brl_jax.Layout, key: Array) -> Buffer:
        """Return the buffer with those of some levels that have higher scores than others.

        Args:
            buffer: the buffer.
            weights: those of the policy.
            layouts: batches of levels, `[batches, BATCH, …]`.
            key: the source of randomness.
        """
        unknown = jnp.full(BATCH, -jnp.inf)
        keys = jax.random.split(key, layouts.start.shape[0])
        scores, highest = jax.lax.map(
            lambda batch: self.scored(weights, batch[0], unknown, batch[1]), (layouts, keys)
        )
        more = Buffer(layouts, scores, highest, jnp.zeros(scores.shape))
        both: Any = jax.tree.map(
            lambda one, other: jnp.concatenate([one, other.reshape(-1, *one.shape[1:])]),
            buffer, more,
        )  # fmt: skip
        # Of levels that are the same, the first one stays.
        flat = [each.reshape(both.scores.size, -1) for each in jax.tree.leaves(both.layouts)]
        bits = jnp.concatenate(flat, axis=1, dtype=jnp.int32)
        is_same = (bits[:, None] == bits).all(axis=-1)
        is_first = is_same.argmax(axis=1) == jnp.arange(len(bits))
        _, chosen = jax.lax.top_k(jnp.where(is_first, both.scores, -jnp.inf), BUFFER)
        best: Buffer = jax.tree.map(lambda each: each[chosen], both)
        return best

    def update(self, carry: tuple[State, Buffer], key: Array) -> tuple[Any, None]:
        """Learn from one batch of levels, after looking for others."""
        state, buffer = carry
        keys = jax.random.split(key, 6)
        layouts = self.new(keys[0], BATCH)
        if self.method == "dr":
            params = self.designs.params(layouts)
            steps = self.played(state.weights, params, keys[1])
            return (self.learner.learn(state, steps, keys[2]), buffer), None

        found = [layouts]
        if self.method == "accel":
            # Mutants of those levels that were replayed last.
            parents = jax.tree.map(lambda each: each[jnp.argsort(buffer.ages)[:BATCH]], buffer)
            mutate = jax.vmap(self.mutate, (0, 0, None))
            found.append(mutate(jax.random.split(keys[3], BATCH), parents.layouts, EDITS))
        batches = jax.tree.map(lambda *each: jnp.stack(each), *found)
        buffer = self.kept(buffer, state.weights, batches, keys[4])
        chances = priorities(buffer.scores, buffer.ages)
        rows = jax.random.choice(keys[5], BUFFER, (BATCH,), replace=False, p=chances)
        params = self.designs.params(jax.tree.map(lambda each: each[rows], buffer.layouts))
        steps = self.played(state.weights, params, keys[1])
        scores, highest = self.estimated(state.weights, params, steps, buffer.highest[rows])
        buffer = Buffer(
            buffer.layouts,
            buffer.scores.at[rows].set(scores),
            buffer.highest.at[rows].set(highest),
            (buffer.ages + 1).at[rows].set(0),
        )
        return (self.learner.learn(state, steps, keys[2]), buffer), None


def highest_returns(steps: Steps, count: int) -> Array:
    """Return the highest discounted return of an episode in each level, -inf without one."""

    def step(carry: tuple[Array, Array], now: tuple[Array, Array]) -> tuple[Any, Array]:
        (total, factor), (reward, done) = carry, now
        total = total + factor * reward
        after = jnp.where(done, 0, total), jnp.where(done, 1, factor * DISCOUNT)
        return after, jnp.where(done, total, -jnp.inf)

    begin = jnp.zeros_like(steps.reward[0]), jnp.ones_like(steps.reward[0])
    _, returns = jax.lax.scan(step, begin, (steps.reward, steps.done))
    return jax.ops.segment_max(returns.reshape(-1), steps.level.reshape(-1), count)


def estimates(steps: Steps, highest: Array) -> dict[str, Array]:
    """Return the published estimates of what is to be learnt in each level, from the same rollouts.

    In these levels, episodes end at the exit only.

    Args:
        steps: the rollouts.
        highest: the highest return in each level so far, discounted as the values are.
    """
    count = len(highest)
    ended = jnp.where(steps.done, steps.level, count)
    return {
        "pvl": brl_jax.positive_value_loss(advantages_of(steps), steps.level, count),
        "maxmc": brl_jax.max_monte_carlo(steps.value, steps.level, highest),
        "learnability": brl_jax.learnability(steps.terminated, ended, count),
    }


@partial(jax.jit, static_argnames=("curriculum", "stages", "every"))
def run(keys: Array, tests: list[Any], *, curriculum: Curriculum, stages: int, every: int) -> Any:
    """Learn once for each key; return `Figures`, `[keys, stages]`, of each test, and buffers."""
    scales, learner = [scale_of(params) for params in tests], curriculum.learner

    def learn(key: Array) -> Any:
        start_key, buffer_key, key = jax.random.split(key, 3)

        def stage(carry: Any, keys: Array) -> Any:
            carry, _ = jax.lax.scan(curriculum.update, carry, keys)
            returns = [learner.returns(carry[0].weights, scale.params) for scale in scales]
            return carry, list(map(figures_of, returns, scales))

        begin = learner.new(start_key), curriculum.start(buffer_key)
        (_, buffer), figures = jax.lax.scan(stage, begin, jax.random.split(key, (stages, every)))
        return figures, buffer

    return jax.lax.map(learn, keys)


def made(method: str, score: str, updates: int) -> tuple[Curriculum, list[Any]]:
    """Return a curriculum, and the levels of two tests: mazes, and new levels."""
    env, designs = brl_jax.designs(ROOM, BATCH, observation="planes")
    mazes = [
        designs.layout(ROOM | {"maze": {"algorithm": "wilson", "seed": seed}})
        for seed in range(BATCH)
    ]
    first = Curriculum(Learner(env, env.default_params, updates), designs, method, score)
    levels = [
        jax.tree.map(lambda *each: jnp.stack(each), *mazes),
        first.new(jax.random.key(0), BATCH),
    ]
    tests = [*map(designs.params, levels)]
    return Curriculum(Learner(env, tests[1], updates), designs, method, score), tests


def main() -> None:
    parser = parser_of(__doc__, steps=2_000_000, steps_help="steps that are learned from",
                       level=None)  # fmt: skip
    parser.add_argument("--method", choices=METHODS, default="accel", help="the curriculum")
    parser.add_argument("--score", choices=SCORES, default="regret", help="what is replayed")
    parser.add_argument("--seeds", type=at_least(1), default=1, help="number of seeds")
    parser.add_argument("--every", type=at_least(1), default=50, help="updates per evaluation")
    parser.add_argument("-o", "--output", type=Path, help="the folder for the levels at the end")
    args = parser.parse_args()
    if args.method == "dr" and args.output is not None:
        parser.error("--method dr keeps no levels for --output")
    per_stage = args.every * BATCH * COPIES * LENGTH
    stages = max(1, round(args.steps / per_stage))
    curriculum, tests = made(args.method, args.score, stages * args.every)
    seeds = range(args.seed, args.seed + args.seeds)
    keys = jnp.stack([jax.random.key(seed) for seed in seeds])
    sizes = {"curriculum": curriculum, "stages": stages, "every": args.every}
    began = time.perf_counter()
    compiled = run.lower(keys, tests, **sizes).compile()
    ready = time.perf_counter()
    (mazes, others), buffer = jax.block_until_ready(compiled(keys, tests))
    ended = time.perf_counter()

    by = "" if args.method == "dr" else f" by {args.score}"
    print(f"{args.method}{by}, tested in {BATCH} mazes and {BATCH} new levels")
    print("      steps  share in mazes  regret  share in new levels  regret")
    for stage in range(stages):
        means = [each[:, stage].mean() for each in (*mazes, *others)]
        print(f"{(stage + 1) * per_stage:11,}{means[0]:16.3f}{means[1]:8.2f}"
              f"{means[2]:21.3f}{means[3]:8.2f}")  # fmt: skip
    shares = "  ".join(f"{share[-1]:.3f}" for share in mazes.share)
    print(f"seeds {', '.join(map(str, seeds))}: share in mazes {shares}")
    print(f"{ready - began:.1f} s to compile, {ended - ready:.1f} s to run on {jax.devices()[0]}")
    if args.output is not None:
        args.output.mkdir(parents=True, exist_ok=True)
        for number, row in enumerate(jnp.argsort(-buffer.scores[0])):
            layout = jax.tree.map(lambda each, row=row: each[0, row], buffer.layouts)
            level = curriculum.designs.level(layout, name=f"evolved-{number:03}")
            level.save(args.output / f"{level.name}.yaml")
        print(f"wrote {BUFFER} levels to {args.output}")


if __name__ == "__main__":
    main()
