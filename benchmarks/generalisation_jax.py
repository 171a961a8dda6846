"""Generalisation: networks that learn in JAX until they converge, five seeds at once.

python benchmarks/generalisation_jax.py --prepare  # the tables of the levels, on any machine
python benchmarks/generalisation_jax.py --train    # networks and learning curves: minutes on a GPU

Both leave out what is there. PPO and prioritised level replay (PLR) learn in one compiled program
for all seeds, recurrent PPO in another. generalisation.py scores the networks. Needs the extra
`jax`.

After Schulman and others, Proximal Policy Optimization Algorithms (2017), and M. Jiang and others,
Prioritized Level Replay (2021).
"""

from __future__ import annotations

import argparse
import gzip
import io
import pickle
import sys
import time
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

sys.path.append(str(Path(__file__).parents[1] / "examples"))

import jax
import jax.numpy as jnp
import numpy as np
import optax
from generalisation import NETWORKS, PROGRAMS, TRAINED
from jax import Array
from level_replay_jax import priorities
from ppo_jax import advantages_of, of_actions

import babyrobot_levels as brl
import babyrobot_levels.jax as brl_jax
from babyrobot_levels.text.files import write_bytes

SEEDS = 5
STEPS = 10_485_760
"""The steps of each run."""

VIEW: dict[str, Any] = {"observation": "view", "actions": "moves"}
ENVS, LENGTH = 1024, 32  # environments of a run, and steps of each between two updates
EPOCHS, BATCHES, LEARNING_RATE, LARGEST_GRADIENT = 4, 8, 1e-3, 0.5
DISCOUNT, LAMBDA, REWARD_SCALE = 0.99, 0.9, 0.05
CLIP, ENTROPY_WEIGHT, VALUE_WEIGHT = 0.2, 0.01, 0.5
HIDDEN, MEMORY = 256, 128
TEMPERATURE, STALENESS = 1.0, 0.3

REFRESHED = 4
"""After so many updates, exact regrets are computed anew."""

STAGES = 20
"""How often the learning curve is measured."""

PLAYED = 2
"""The episodes in each level by which agents with memory are measured."""


class Steps(NamedTuple):
    """What is learned from, `[steps, environments]`."""

    inputs: Array
    fresh: Array  # whether an episode begins
    action: Array
    log_chance: Array
    value: Array
    value_ahead: Array
    reward: Array
    terminated: Array
    done: Array
    level: Array


class State(NamedTuple):
    """What an update hands to the next one."""

    weights: Any
    optimizer: Any
    envs: Any
    inputs: Array
    fresh: Array
    memory: Array
    estimates: Array  # `[levels]`: the positive value loss
    ages: Array  # `[levels]`: how many updates ago each was played


# -- the network -----------------------------------------------------------------------------


def new_weights(key: Array, inputs: int, actions: int, *, has_memory: bool) -> dict[str, Array]:
    """Return the weights: a layer, then another one or a gated recurrent unit, then the heads."""
    core = 3 * MEMORY if has_memory else HIDDEN
    shapes = {
        "inputs": (inputs, HIDDEN),
        "core": (HIDDEN, core),
        "heads": (MEMORY if has_memory else HIDDEN, actions + 1),
    }
    if has_memory:
        shapes["memory"] = (MEMORY, core)
    weights = {}
    for name, shape in shapes.items():
        key, own = jax.random.split(key)
        scale = 0.01 if name == "heads" else 1.0 if has_memory and name != "inputs" else 2**0.5
        weights[name] = jax.nn.initializers.orthogonal(scale)(own, shape)
        weights[f"{name}-bias"] = jnp.zeros(shape[1])
    return weights


def before_core(weights: Any, inputs: Array) -> Array:
    hidden = jax.nn.relu(inputs.astype(jnp.float32) @ weights["inputs"] + weights["inputs-bias"])
    return hidden @ weights["core"] + weights["core-bias"]


def after_core(weights: Any, memory: Array, entered: Array) -> tuple[Array, Array]:
    """Return the memory after a step, and what the heads read."""
    if "memory" not in weights:
        return memory, jax.nn.relu(entered)
    reset, update, new = jnp.split(entered, 3, axis=-1)
    kept = jnp.split(memory @ weights["memory"] + weights["memory-bias"], 3, axis=-1)
    gate = jax.nn.sigmoid(update + kept[1])
    candidate = jnp.tanh(new + jax.nn.sigmoid(reset + kept[0]) * kept[2])
    memory = (1 - gate) * candidate + gate * memory
    return memory, memory


def heads(weights: Any, read: Array) -> tuple[Array, Array]:
    """Return the logarithms of the actions' probabilities, and the value."""
    outputs = read @ weights["heads"] + weights["heads-bias"]
    return jax.nn.log_softmax(outputs[..., :-1]), outputs[..., -1]


def network(weights: Any, memory: Array, inputs: Array) -> tuple[Array, Array, Array]:
    """Return the memory after a step, the logarithms of probabilities, and the value."""
    memory, read = after_core(weights, memory, before_core(weights, inputs))
    return memory, *heads(weights, read)


def over_time(weights: Any, memory: Array, inputs: Array, fresh: Array) -> tuple[Array, Array]:
    """Return the same of steps that follow each other, `[steps, environments]`, but no memory."""
    entered = before_core(weights, inputs)
    if "memory" not in weights:
        return heads(weights, jax.nn.relu(entered))

    def step(memory: Array, each: tuple[Array, Array]) -> tuple[Array, Array]:
        return after_core(weights, memory * ~each[1][:, None], each[0])

    return heads(weights, jax.lax.scan(step, memory, (entered, fresh))[1])


# -- learning --------------------------------------------------------------------------------


class Learner:
    """PPO, as functions to compile.

    Args:
        env: the environment.
        train: the levels to learn in.
        longest: the most steps of an episode.
        updates: how many updates there will be.
        has_memory: whether the network has memory.
    """

    def __init__(
        self, env: Any, train: Any, longest: int, updates: int, *, has_memory: bool
    ) -> None:
        self.env, self.longest, self.has_memory = env, longest, has_memory
        self.told = told_in(train.observations.rows)
        schedule = optax.linear_schedule(LEARNING_RATE, 0, updates * EPOCHS * BATCHES)
        limited = optax.clip_by_global_norm(LARGEST_GRADIENT)
        self.optimizer = optax.chain(limited, optax.adam(schedule))

    def inputs(self, views: Array) -> Array:
        return views.reshape(*views.shape[:-3], -1)[..., self.told].astype(jnp.bool_)

    def start(self, params: Any, key: Array) -> State:
        weights_key, reset_key = jax.random.split(key)
        actions = self.env.num_actions
        weights = new_weights(weights_key, len(self.told), actions, has_memory=self.has_memory)
        reset = jax.vmap(self.env.reset, in_axes=(0, None))
        views, envs = reset(jax.random.split(reset_key, ENVS), params)
        return State(
            weights,
            self.optimizer.init(weights),
            envs,
            self.inputs(views),
            jnp.ones(ENVS, jnp.bool_),
            jnp.zeros((ENVS, MEMORY if self.has_memory else 1)),
            # Levels that were not played yet come first.
            jnp.full(params.num_levels, 1e6, jnp.float32),
            jnp.ones(params.num_levels),
        )

    def update(self, params: Any, state: State, weights: Array, key: Array) -> State:
        """Play in levels that are drawn by weights `[levels]`, and learn."""
        steps_key, epochs_key = jax.random.split(key)
        step = partial(self.step, state.weights, params.weighted(weights))
        begun = (state.envs, state.inputs, state.fresh, state.memory)
        keys = jax.random.split(steps_key, LENGTH)
        (envs, inputs, fresh, memory), steps = jax.lax.scan(step, begun, keys)
        advantages = advantages_of(steps, DISCOUNT, LAMBDA)
        data = steps, advantages

        def batch(carry: Any, rows: Array) -> tuple[Any, None]:
            drawn = jax.tree.map(lambda each: each[:, rows], data)
            slopes = jax.grad(loss_of)(carry[0], state.memory[rows], *drawn)
            changes, optimizer = self.optimizer.update(slopes, carry[1])
            return (optax.apply_updates(carry[0], changes), optimizer), None

        orders = [
            jax.random.permutation(key, ENVS).reshape(BATCHES, -1)
            for key in jax.random.split(epochs_key, EPOCHS)
        ]
        learned = state.weights, state.optimizer
        (learned_weights, optimizer), _ = jax.lax.scan(batch, learned, jnp.concatenate(orders))
        loss = brl_jax.positive_value_loss(advantages, steps.level, params.num_levels)
        estimates = jnp.where(jnp.isnan(loss), state.estimates, loss)
        ages = (state.ages + 1).at[steps.level].set(0)
        return State(learned_weights, optimizer, envs, inputs, fresh, memory, estimates, ages)

    def step(self, weights: Any, params: Any, carry: Any, key: Array) -> tuple[Any, Steps]:
        envs, inputs, fresh, memory = carry
        action_key, step_key = jax.random.split(key)
        memory, log_chances, value = network(weights, memory * ~fresh[:, None], inputs)
        action = jax.random.categorical(action_key, log_chances)
        level = envs.level
        views, envs, reward, terminated, truncated, info = jax.vmap(
            self.env.step, in_axes=(0, 0, 0, None)
        )(jax.random.split(step_key, ENVS), envs, action, params)
        # At the end of an episode, `views` are already of the next one.
        *_, ahead = network(weights, memory, self.inputs(info["final_observation"]))
        done = terminated | truncated
        steps = Steps(
            inputs, fresh, action, of_actions(log_chances, action), value, ahead,
            reward * REWARD_SCALE, terminated, done, level,
        )  # fmt: skip
        return (envs, self.inputs(views), done, memory), steps

    def returns(self, params: Any, weights: Any) -> Array:
        """Return the expected returns, `[levels]`: exactly, or from episodes with memory."""
        if self.has_memory:
            return self.played(params, weights)
        views = self.inputs(self.env.observations(params))
        _, log_chances, _ = network(weights, jnp.zeros((len(views), 1)), views)
        return brl_jax.evaluate(params, jnp.exp(log_chances), within="max_steps").returns

    def played(self, params: Any, weights: Any) -> Array:
        """Return the mean return of episodes, `[levels]`."""
        levels = jnp.tile(jnp.arange(params.num_levels), PLAYED)
        count = len(levels)
        reset_key, key = jax.random.split(jax.random.key(0))

        def step(carry: Any, key: Array) -> tuple[Any, None]:
            action_key, step_key = jax.random.split(key)
            envs, inputs, memory, goes_on, total = carry
            memory, log_chances, _ = network(weights, memory, inputs)
            action = jax.random.categorical(action_key, log_chances)
            views, envs, reward, terminated, _ = jax.vmap(
                self.env.step_env, in_axes=(0, 0, 0, None)
            )(jax.random.split(step_key, count), envs, action, params)
            total = total + reward * goes_on
            goes_on &= ~terminated & ~jax.vmap(self.env.is_truncated, in_axes=(0, None))(
                envs, params
            )
            return (envs, self.inputs(views), memory, goes_on, total), None

        reset = jax.vmap(self.env.reset_to_level, in_axes=(0, 0, None))
        views, envs = reset(jax.random.split(reset_key, count), levels, params)
        begun = (envs, self.inputs(views), jnp.zeros((count, MEMORY)), jnp.ones(count, jnp.bool_))
        keys = jax.random.split(key, self.longest)
        carry, _ = jax.lax.scan(step, (*begun, jnp.zeros(count)), keys)
        return carry[-1].reshape(PLAYED, -1).mean(axis=0)


def told_in(rows: Array) -> np.ndarray[Any, Any]:
    """Return which entries of views, kept as bits, differ between states."""
    kept = np.asarray(rows)
    varies = np.bitwise_or.reduce(kept) & ~np.bitwise_and.reduce(kept)
    return np.flatnonzero(np.concatenate([varies >> place & 1 for place in range(8)]))


def loss_of(weights: Any, memory: Array, steps: Steps, advantages: Array) -> Array:
    log_chances, values = over_time(weights, memory, steps.inputs, steps.fresh)
    ratio = jnp.exp(of_actions(log_chances, steps.action) - steps.log_chance)
    scaled = (advantages - advantages.mean()) / (advantages.std() + 1e-8)
    gain = jnp.minimum(ratio * scaled, jnp.clip(ratio, 1 - CLIP, 1 + CLIP) * scaled)
    value_loss = jnp.square(values - steps.value - advantages)
    entropy = -(jnp.exp(log_chances) * log_chances).sum(axis=-1)
    return jnp.mean(VALUE_WEIGHT * value_loss - gain - ENTROPY_WEIGHT * entropy)


# -- several runs ----------------------------------------------------------------------------


@partial(jax.jit, static_argnames=("learner", "methods"), donate_argnames="states")
def stage(
    learner: Learner, methods: tuple[str, ...], train: Any, test: Any, best: Array,
    states: State, keys: Array,
) -> tuple[State, Array]:  # fmt: skip
    """Learn for a while in all runs; return also the returns in `test`, `[runs, levels]`.

    Args:
        learner: the learner.
        methods: that of each run.
        train: the levels to learn in.
        test: the levels of the learning curve.
        best: the optima in `train`, `[levels]`.
        states: those of all runs.
        keys: `[groups, updates, runs]`.
    """
    by_regret = np.array([method == "jax-plr-regret" for method in methods])
    by_estimate = jnp.array([method == "jax-plr-estimate" for method in methods])
    chosen = np.flatnonzero(by_regret)

    def group(states: State, keys: Array) -> tuple[State, None]:
        regrets = jnp.zeros((len(methods), train.num_levels))
        if len(chosen):
            weights = jax.tree.map(lambda each: each[chosen], states.weights)
            returns = jax.lax.map(partial(learner.returns, train), weights, batch_size=5)
            regrets = regrets.at[chosen].set(best - returns)

        def update(states: State, keys: Array) -> tuple[State, None]:
            scores = jnp.where(by_estimate[:, None], states.estimates, regrets)
            ranked = partial(priorities, temperature=TEMPERATURE, staleness=STALENESS)
            drawn = jax.vmap(ranked)(scores, states.ages)
            is_drawn = by_estimate | jnp.asarray(by_regret)
            drawn = jnp.where(is_drawn[:, None], drawn, 1.0)
            return jax.vmap(learner.update, (None, 0, 0, 0))(train, states, drawn, keys), None

        return jax.lax.scan(update, states, keys)[0], None

    states, _ = jax.lax.scan(group, states, keys)
    return states, jax.lax.map(partial(learner.returns, test), states.weights, batch_size=5)


def ends(params: Any) -> tuple[Array, Array]:
    """Return the expected returns of random moves and the optima, `[levels]`."""
    random = brl_jax.evaluate(params, brl_jax.random_policy(params), within="max_steps")
    return random.returns, brl_jax.optimum(params, within="max_steps").returns


def prepared(suite: str, split: str) -> Any:
    """Return a split as `EnvParams` of NumPy arrays, from a file if it is there."""
    path = TRAINED / f"{suite}-{split}.gz"
    if path.exists():
        return pickle.loads(gzip.decompress(path.read_bytes()))
    levels = [*brl.load_suite(suite).split(split)]
    params = jax.tree.map(np.asarray, brl_jax.make(levels, **VIEW)[1])
    TRAINED.mkdir(parents=True, exist_ok=True)
    write_bytes(path, gzip.compress(pickle.dumps(params)))
    return params


def learn(suite: str, program: str, folder: Path, seeds: int, steps: int) -> None:
    """Train the networks of a program, and write them with their learning curves."""
    train, test = (prepared(suite, split) for split in ("train", "test"))
    methods = tuple(method for method in PROGRAMS[program] for _ in range(seeds))
    groups = max(1, round(steps / (STAGES * REFRESHED * ENVS * LENGTH)))
    env, _ = brl_jax.make(brl.load_suite(suite).split("train")[:2], **VIEW)
    updates, longest = STAGES * groups * REFRESHED, int(test.limit.max())
    learner = Learner(env, train, longest, updates, has_memory=program == "recurrent")
    train, test = jax.tree.map(jnp.asarray, (train, test))
    best, (random, optimum) = jax.jit(ends)(train)[1], jax.jit(ends)(test)
    began = time.perf_counter()
    # The same seeds with all methods.
    keys = jnp.stack([jax.random.key(seed) for seed in range(seeds)] * (len(methods) // seeds))
    states = jax.jit(jax.vmap(partial(learner.start, train)))(keys)
    split = jax.vmap(partial(jax.random.split, num=updates))(keys)
    split = split.T.reshape(STAGES, groups, REFRESHED, len(methods))
    curve = []
    for number in range(STAGES):
        states, returns = stage(learner, methods, train, test, best, states, split[number])
        curve.append(np.asarray((returns - random) / (optimum - random)))
        means = curve[-1].mean(axis=1).reshape(-1, seeds).mean(axis=1).round(3).tolist()
        seconds = time.perf_counter() - began
        print(f"{suite} {program} {number + 1}/{STAGES} {seconds:.0f} s {means}", flush=True)
    out = io.BytesIO()
    kept: dict[str, Any] = dict(
        methods=np.array(methods),
        seeds=np.tile(np.arange(seeds), len(methods) // seeds),
        steps=updates * ENVS * LENGTH,
        seconds=time.perf_counter() - began,
        device=str(jax.devices()[0].device_kind),
        told=learner.told,
        curve=np.stack(curve, axis=1),
        **{f"weights-{name}": np.asarray(each) for name, each in states.weights.items()},
    )
    np.savez_compressed(out, **kept)
    folder.mkdir(parents=True, exist_ok=True)
    write_bytes(folder / f"{suite}-{program}.npz", out.getvalue())


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--prepare", action="store_true", help="make the tables that are missing")
    what.add_argument("--train", action="store_true", help="train the networks that are missing")
    parser.add_argument("--suite", action="append", choices=NETWORKS, help="only this suite")
    parser.add_argument("--program", action="append", choices=PROGRAMS, help="only this one")
    parser.add_argument("--seeds", type=int, default=SEEDS, help="number of seeds")
    parser.add_argument("--steps", type=int, default=STEPS, help="steps of each run")
    parser.add_argument("--folder", type=Path, default=TRAINED, help="where networks are written")
    args = parser.parse_args()
    for suite in args.suite or NETWORKS:
        if args.prepare:
            for split in ("train", "test"):
                prepared(suite, split)
            continue
        for program in args.program or PROGRAMS:
            if not (args.folder / f"{suite}-{program}.npz").exists():
                learn(suite, program, args.folder, args.seeds, args.steps)


if __name__ == "__main__":
    main()
