"""ACCEL with the sampler, wrappers and scores of JaxUED: python examples/jaxued_levels.py

The levels, the learner and the tests are those of accel_jax.py; the buffer is JaxUED's
`LevelSampler`, environments are in its `AutoReplayWrapper`, or with `--method dr` in its
`AutoResetWrapper`, and MaxMC and the positive value loss are its own. It needs the extra `jax` and
JaxUED: pip install ".[jax]" jaxued

A level of the sampler is a `Layout`; a level of the wrapped environment is a number in the tables
that are made of a batch of them. Two things of JaxUED 0.0.1 are old: it calls `jax.tree_map`, which
JAX no longer has, and its `AutoResetWrapper` takes keys of `jax.random.PRNGKey` only.
"""

from __future__ import annotations

import time
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
from accel_jax import BATCH, BUFFER, EDITS, Curriculum, made
from arguments import at_least, parser_of
from jax import Array
from ppo_jax import REWARD_SCALE, Learner, State, Steps, advantages_of, figures_of, network

from ppo_jax import of_actions, scale_of  # isort: skip

import babyrobot_levels.jax as brl_jax

jax.tree_map = jax.tree.map
from jaxued.level_sampler import LevelSampler  # noqa: E402
from jaxued.utils import compute_max_returns, max_mc, positive_value_loss  # noqa: E402
from jaxued.wrappers import AutoReplayWrapper, AutoResetWrapper  # noqa: E402

LENGTH = 128  # steps of each environment in an update; each level of a batch has one


class Program:
    """What is done in an update, as functions to compile.

    Args:
        curriculum: makes new levels and mutants.
        method: `"dr"` or `"accel"`.
        score: `"regret"`, `"pvl"` or `"maxmc"`.
    """

    def __init__(self, curriculum: Curriculum, method: str, score: str) -> None:
        self.curriculum, self.method, self.score = curriculum, method, score
        self.learner: Learner = curriculum.learner
        env = brl_jax.UnderspecifiedEnv(self.learner.env)
        self.env: Any = AutoReplayWrapper(env)
        if method == "dr":
            self.env = AutoResetWrapper(env, lambda key: jax.random.randint(key, (), 0, BATCH))
        # Half of the updates replay, as in accel_jax.py.
        self.sampler = LevelSampler(BUFFER, replay_prob=0.5, duplicate_check=True)

    def start(self, key: Array) -> tuple[State, Any]:
        room = self.curriculum.room
        return self.learner.new(key), self.sampler.initialize(room, {"highest": -jnp.inf})

    def played(self, weights: Any, params: Any, key: Array) -> Steps:
        """Play a batch of levels."""
        reset_key, key = jax.random.split(key)
        over_levels = jax.vmap(self.env.reset_to_level, (0, 0, None))
        begun = over_levels(jax.random.split(reset_key, BATCH), jnp.arange(BATCH), params)

        def step(carry: Any, key: Array) -> tuple[Any, Steps]:
            views, states = carry
            action_key, step_key = jax.random.split(key)
            inputs, level = self.learner.inputs(views), states.env_state.level
            log_chances, values = network(weights, inputs)
            actions = jax.random.categorical(action_key, log_chances)
            views, states, rewards, done, _ = jax.vmap(self.env.step, (0, 0, 0, None))(
                jax.random.split(step_key, BATCH), states, actions, params
            )
            # JaxUED does not tell what is seen at the end: a limit counts as an end, as there.
            _, ahead = network(weights, self.learner.inputs(views))
            before, rewards = of_actions(log_chances, actions), rewards * REWARD_SCALE
            steps = Steps(level, inputs, actions, before, values, ahead, rewards, done, done)
            return (views, states), steps

        played: tuple[Any, Steps] = jax.lax.scan(step, begun, jax.random.split(key, LENGTH))
        return played[1]

    def scored(
        self, weights: Any, params: Any, steps: Steps, highest: Array
    ) -> tuple[Array, dict[str, Array]]:
        """Return the scores of a batch of levels, and what is kept with each."""
        highest = jnp.maximum(highest, compute_max_returns(steps.done, steps.reward))
        if self.score == "regret":
            best = brl_jax.optimum(params, within="max_steps").returns
            scores = best - self.learner.returns(weights, params)
        elif self.score == "pvl":
            scores = positive_value_loss(steps.done, advantages_of(steps))
        else:
            scores = max_mc(steps.done, steps.value, highest)
        return scores, {"highest": highest}

    def explored(self, state: State, sampler: Any, layouts: brl_jax.Layout, key: Array) -> Any:
        """Return the sampler with a batch of levels, played without learning."""
        params = self.curriculum.designs.params(layouts)
        steps = self.played(state.weights, params, key)
        found = self.scored(state.weights, params, steps, jnp.full(BATCH, -jnp.inf))
        return self.sampler.insert_batch(sampler, layouts, *found)[0]

    def replay(self, state: State, sampler: Any, key: Array) -> tuple[Any, brl_jax.Layout]:
        """Learn from levels of the sampler; return mutants of them, too."""
        keys = jax.random.split(key, 4)
        sampler, (rows, layouts) = self.sampler.sample_replay_levels(sampler, keys[0], BATCH)
        params = self.curriculum.designs.params(layouts)
        steps = self.played(state.weights, params, keys[1])
        highest = sampler["levels_extra"]["highest"][rows]
        found = self.scored(state.weights, params, steps, highest)
        sampler = self.sampler.update_batch(sampler, rows, *found)
        state = self.learner.learn(state, steps, keys[2])
        mutate = jax.vmap(self.curriculum.mutate, (0, 0, None))
        return (state, sampler), mutate(jax.random.split(keys[3], BATCH), layouts, EDITS)

    def update(self, carry: tuple[State, Any], key: Array) -> tuple[Any, None]:
        (state, sampler), keys = carry, jax.random.split(key, 3)
        if self.method == "dr":
            params = self.curriculum.designs.params(self.curriculum.new(keys[0], BATCH))
            steps = self.played(state.weights, params, keys[1])
            return (self.learner.learn(state, steps, keys[2]), sampler), None
        (state, sampler), layouts = jax.lax.cond(
            self.sampler.sample_replay_decision(sampler, keys[0]),
            self.replay,
            lambda state, sampler, key: ((state, sampler), self.curriculum.new(key, BATCH)),
            state, sampler, keys[1],
        )  # fmt: skip
        return (state, self.explored(state, sampler, layouts, keys[2])), None


@partial(jax.jit, static_argnames=("program", "stages", "every"))
def run(key: Array, tests: list[Any], *, program: Program, stages: int, every: int) -> Any:
    """Learn; return `Figures`, `[stages]`, of each test, and the sampler at the end."""
    scales, start_key = [scale_of(params) for params in tests], jax.random.fold_in(key, 0)

    def stage(carry: Any, keys: Array) -> Any:
        carry, _ = jax.lax.scan(program.update, carry, keys)
        returns = [program.learner.returns(carry[0].weights, scale.params) for scale in scales]
        return carry, (carry[0].updates, list(map(figures_of, returns, scales)))

    keys = jax.random.split(key, (stages, every))
    (_, sampler), figures = jax.lax.scan(stage, program.start(start_key), keys)
    return figures, sampler


def main() -> None:
    parser = parser_of(__doc__, steps=2_000_000, steps_help="steps of all updates together",
                       level=None)  # fmt: skip
    parser.add_argument("--method", choices=("dr", "accel"), default="accel")
    parser.add_argument("--score", choices=("regret", "pvl", "maxmc"), default="regret")
    parser.add_argument("--every", type=at_least(1), default=50, help="updates per evaluation")
    args = parser.parse_args()
    stages = max(1, round(args.steps / (args.every * BATCH * LENGTH)))
    curriculum, tests = made(args.method, args.score, stages * args.every)
    program = Program(curriculum, args.method, args.score)
    began = time.perf_counter()
    # The wrapper that draws levels joins this key with one of the same, older kind.
    (learned, (mazes, others)), sampler = jax.block_until_ready(
        run(jax.random.PRNGKey(args.seed), tests, program=program, stages=stages, every=args.every)
    )
    print("updates  learned from  share in mazes  regret  share in new levels  regret")
    for stage in range(stages):
        rows = [each[stage] for each in (*mazes, *others)]
        print(f"{(stage + 1) * args.every:7}{learned[stage]:14}{rows[0]:16.3f}{rows[1]:8.2f}"
              f"{rows[2]:21.3f}{rows[3]:8.2f}")  # fmt: skip
    if args.method != "dr":
        best = int(sampler["scores"].argmax())
        layout = jax.tree.map(lambda each: each[best], sampler["levels"])
        print(f"{sampler['size']} levels in the buffer; that with the highest score:")
        print(curriculum.designs.level(layout, name="hardest").to_yaml(), end="")
    print(f"{time.perf_counter() - began:.1f} s on {jax.devices()[0]}")


if __name__ == "__main__":
    main()
