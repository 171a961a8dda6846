"""Tabular Q-learning in all levels of a suite at once: python examples/q_learning_jax.py

The states of all levels are numbered one after another, so that one table has the action values of
all of them. Each level has the same number of environments, and all of them step together. Every
few hundred steps, the greedy policy is evaluated exactly in each level. All of this is one
`jax.jit`. It needs the extra `jax`: pip install ".[jax]"

After Watkins and Dayan, Q-learning (1992). Results may differ between devices.
"""

from __future__ import annotations

import time
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from arguments import at_least, parser_of, suite_of
from jax import Array

import babyrobot_levels as brl
import babyrobot_levels.jax as brl_jax

MAZES = {
    "version": 1,
    "kind": "suite",
    "name": "wet-mazes",
    "seed": 5,
    "count": 100,
    "size": {"min": [4, 4], "max": [8, 8]},
    "maze": {"algorithm": ["wilson", "depth-first"], "loops": {"max": 0.5}},
    "puddles": {"max": 4},
    "max_steps": 200,
}
STEP_SIZE_POWER = 0.6  # the n-th change of a value has the step size n ** -0.6


class Figures(NamedTuple):
    """How good greedy policies are, exactly, `[evaluations, levels]`."""

    share: Array  # (return - random) / (optimum - random)
    regret: Array  # optimum - return


class Carry(NamedTuple):
    """What one step hands to the next."""

    values: Array  # [states, actions]
    changes: Array  # how often each of them was changed
    states: Any
    key: Array


@partial(jax.jit, static_argnames=("env", "num_envs", "stages", "every"))
def run(key: Array, params: Any, *, env: Any, num_envs: int, stages: int, every: int) -> Any:
    """Learn, and return the `Figures` after each stage.

    Args:
        key: the source of randomness.
        params: the levels.
        env: the environment.
        num_envs: how many environments each level has.
        stages: how many stages there are.
        every: how many steps each environment takes in a stage.
    """
    chances = brl_jax.random_policy(params)
    random = brl_jax.evaluate(params, chances, within="max_steps").returns
    best = brl_jax.optimum(params, within="max_steps").returns
    levels = jnp.repeat(jnp.arange(params.num_levels), num_envs)
    # In each level, from 5 % of random actions to random actions only.
    epsilon = jnp.tile(jnp.linspace(0.05, 1.0, num_envs), params.num_levels)

    def step_env(key: Array, state: Any, action: Array) -> tuple[Array, Any, Array, Array]:
        """Return the next state, the same or that of the next episode, reward and termination."""
        step_key, reset_key = jax.random.split(key)
        _, after, reward, terminated, _ = env.step_env(step_key, state, action, params)
        _, start = env.reset_to_level(reset_key, state.level, params)
        done = terminated | env.is_truncated(after, params)
        now = jax.tree.map(partial(jnp.where, done), start, after)
        return after.state, now, reward, terminated

    def step(carry: Carry, _: None) -> tuple[Carry, None]:
        key, explore_key, act_key, step_key = jax.random.split(carry.key, 4)
        state = carry.states.state
        explores = jax.random.uniform(explore_key, epsilon.shape) < epsilon
        drawn = jax.random.categorical(act_key, jnp.log(chances[state]))
        actions = jnp.where(explores, drawn, greedy(carry.values)[state])
        following, states, rewards, terminated = jax.vmap(step_env)(
            jax.random.split(step_key, levels.size), carry.states, actions
        )
        ahead = jnp.where(terminated, 0, possible(carry.values).max(axis=1)[following])
        targets = rewards + params.discount[levels] * ahead

        # A value moves towards the mean of the targets in the environments that took the action.
        count = jnp.zeros_like(carry.changes).at[state, actions].add(1)
        total = jnp.zeros_like(carry.values).at[state, actions].add(targets)
        changes = carry.changes + (count > 0)
        step_size = jnp.maximum(changes, 1.0) ** -STEP_SIZE_POWER
        change = step_size * (total / jnp.maximum(count, 1) - carry.values)
        values = jnp.where(count > 0, carry.values + change, carry.values)
        return Carry(values, changes, states, key), None

    def possible(values: Array) -> Array:
        """Return the values, minus infinity for what the masks refuse."""
        return jnp.where(chances > 0, values, -jnp.inf)

    def greedy(values: Array) -> Array:
        return possible(values).argmax(axis=1)

    def stage(carry: Carry, _: None) -> tuple[Carry, Figures]:
        carry, _ = jax.lax.scan(step, carry, None, every)
        worth = brl_jax.evaluate(params, greedy(carry.values), within="max_steps")
        lost = best - worth.returns
        return carry, Figures(1 - lost / (best - random), lost)

    reset_key, key = jax.random.split(key)
    reset_keys = jax.random.split(reset_key, levels.size)
    _, states = jax.vmap(env.reset_to_level, in_axes=(0, 0, None))(reset_keys, levels, params)
    nothing = jnp.zeros(chances.shape)
    start = Carry(nothing, nothing, states, key)
    return jax.lax.scan(stage, start, None, stages)[1]


def main() -> None:
    parser = parser_of(__doc__, steps=8_000_000, level=None)
    parser.add_argument(
        "--suite", type=suite_of, default=brl.load_suite(MAZES),
        help="a name or a path; its levels need a time limit",
    )  # fmt: skip
    parser.add_argument("--num-envs", type=at_least(2), default=16, help="environments per level")
    parser.add_argument("--every", type=at_least(1), default=500, help="steps per evaluation")
    args = parser.parse_args()
    # Observations are not used: the table has a row for each state.
    env, params = brl_jax.make(args.suite, actions="moves", draw_levels=False)

    num_envs = params.num_levels * args.num_envs
    stages = max(1, round(args.steps / (num_envs * args.every)))
    sizes = {"env": env, "num_envs": args.num_envs, "stages": stages, "every": args.every}
    key = jax.random.key(args.seed)
    began = time.perf_counter()
    compiled = run.lower(key, params, **sizes).compile()
    ready = time.perf_counter()
    figures = jax.block_until_ready(compiled(key, params))
    ended = time.perf_counter()

    print(f"{params.num_levels} levels, {params.num_states:,} states")
    print("      steps  mean share  least share  optimal levels  mean regret")
    for stage, (shares, regrets) in enumerate(zip(*figures, strict=True), start=1):
        optimal = (regrets < 1e-3).mean()
        print(
            f"{stage * args.every * num_envs:11,}{shares.mean():12.3f}{shares.min():13.3f}"
            f"{optimal:16.1%}{regrets.mean():13.3f}"
        )
    print(f"{ready - began:.1f} s to compile, {ended - ready:.1f} s to run on {jax.devices()[0]}")


if __name__ == "__main__":
    main()
