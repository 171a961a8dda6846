"""PPO in small mazes, all of it in one `jax.jit`: python examples/ppo_jax.py

A network learns in the levels of a suite's split `train`. Every few updates, it is applied to all
states of the split `test`, and its exact expected return there is compared with the optimum and
with random moves. All of this is compiled together, for several seeds at once. It needs the extra
`jax`: pip install ".[jax]"

After Schulman and others, Proximal Policy Optimization Algorithms (2017), in the style of Lu and
others, Discovered Policy Optimisation (2022). Results may differ between devices.
"""

from __future__ import annotations

import time
from functools import partial
from itertools import pairwise
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import optax
from arguments import at_least, parser_of, suite_of
from jax import Array

import babyrobot_levels as brl
import babyrobot_levels.jax as brl_jax

MAZES = {
    "version": 1,
    "kind": "suite",
    "name": "tiny-mazes",
    "seed": 7,
    "count": 12000,
    "splits": {"train": 0.9, "test": 0.1},
    "size": {"min": [3, 3], "max": [5, 5]},
    "maze": {"algorithm": ["wilson", "depth-first"], "loops": {"max": 0.5}},
    "puddles": {"max": 2},
    "rewards": {"step": -1, "exit": 100},
    "max_steps": 50,
}
# What is within four cells of the robot, also behind walls: the whole of these mazes.
VIEW: dict[str, Any] = {"observation": "view", "view_radius": 4, "see_through": True}

NUM_ENVS, NUM_STEPS = 512, 16  # environments, and steps of each between two updates
EPOCHS, BATCHES, LEARNING_RATE = 4, 8, 2e-3
DISCOUNT, LAMBDA, REWARD_SCALE = 0.95, 0.9, 0.02
CLIP, ENTROPY_WEIGHT, VALUE_WEIGHT, LARGEST_GRADIENT = 0.2, 0.01, 0.5, 0.5
HIDDEN = (128, 128)


Weights = list[tuple[Array, Array]]
"""Of a network: a matrix and a bias for each layer."""


class Steps(NamedTuple):
    """What is learned from, `[steps, environments]`."""

    level: Array
    observation: Array
    action: Array
    log_chance: Array
    value: Array
    value_ahead: Array
    reward: Array
    terminated: Array
    done: Array


class State(NamedTuple):
    """What an update hands to the next one."""

    weights: Weights
    optimizer: Any
    updates: Array  # how many there were
    begun: Any  # the observations and the states of the environments


class Scale(NamedTuple):
    """Levels, and the exact expected returns in them, `[levels]`, that others are compared with."""

    params: Any
    random: Array
    best: Array


class Figures(NamedTuple):
    """How good a policy is, exactly: means over levels."""

    share: Array  # (return - random) / (optimum - random)
    regret: Array  # optimum - return


class Learner:
    """PPO, as functions to compile.

    Args:
        env: the environment.
        params: the levels to learn in.
        updates: how many updates there will be.
    """

    def __init__(self, env: Any, params: Any, updates: int) -> None:
        self.env, self.updates = env, updates
        self.told = jnp.flatnonzero(varying(env, params))
        schedule = optax.linear_schedule(LEARNING_RATE, 0, updates * EPOCHS * BATCHES)
        limited = optax.clip_by_global_norm(LARGEST_GRADIENT)
        self.optimizer = optax.chain(limited, optax.adam(schedule))

    def new(self, key: Array) -> State:
        sizes = (len(self.told), *HIDDEN, self.env.num_actions + 1)
        weights = new_weights(key, sizes)
        return State(weights, self.optimizer.init(weights), jnp.int32(0), None)

    def start(self, key: Array, params: Any) -> State:
        weights_key, reset_key = jax.random.split(key)
        reset = jax.vmap(self.env.reset, in_axes=(0, None))
        begun = reset(jax.random.split(reset_key, NUM_ENVS), params)
        return self.new(weights_key)._replace(begun=begun)

    def update(self, state: State, params: Any, key: Array) -> tuple[State, Array]:
        """Play and learn; return also the levels that were played, `[steps, environments]`."""
        steps_key, epochs_key = jax.random.split(key)
        begun, steps = self.play(state.weights, params, state.begun, steps_key, NUM_STEPS)
        return self.learn(state._replace(begun=begun), steps, epochs_key), steps.level

    def play(
        self, weights: Weights, params: Any, begun: Any, key: Array, length: int
    ) -> tuple[Any, Steps]:
        """Take a number of steps in all environments."""
        step = partial(self.step, weights, params)
        played: tuple[Any, Steps] = jax.lax.scan(step, begun, jax.random.split(key, length))
        return played

    def learn(self, state: State, steps: Steps, key: Array) -> State:
        data = (steps, advantages_of(steps))
        flat = jax.tree.map(lambda each: each.reshape(-1, *each.shape[2:]), data)
        entropy_weight = ENTROPY_WEIGHT * (1 - state.updates / self.updates)

        def batch(carry: Any, rows: Array) -> tuple[Any, None]:
            weights, optimizer = carry
            drawn = jax.tree.map(lambda each: each[rows], flat)
            slopes = jax.grad(loss_of)(weights, *drawn, entropy_weight)
            changes, optimizer = self.optimizer.update(slopes, optimizer)
            return (optax.apply_updates(weights, changes), optimizer), None

        orders = [
            jax.random.permutation(key, steps.level.size).reshape(BATCHES, -1)
            for key in jax.random.split(key, EPOCHS)
        ]
        learned = state.weights, state.optimizer
        (weights, optimizer), _ = jax.lax.scan(batch, learned, jnp.concatenate(orders))
        return State(weights, optimizer, state.updates + 1, state.begun)

    def step(self, weights: Weights, params: Any, carry: Any, key: Array) -> tuple[Any, Steps]:
        views, envs = carry
        action_key, step_key = jax.random.split(key)
        inputs, level = self.inputs(views), envs.level
        log_chances, values = network(weights, inputs)
        actions = jax.random.categorical(action_key, log_chances)
        views, envs, rewards, terminated, truncated, info = jax.vmap(
            self.env.step, in_axes=(0, 0, 0, None)
        )(jax.random.split(step_key, len(actions)), envs, actions, params)
        # At the end of an episode, `views` are already of the next one.
        _, ahead = network(weights, self.inputs(info["final_observation"]))
        before = of_actions(log_chances, actions)
        rewards, done = rewards * REWARD_SCALE, terminated | truncated
        steps = Steps(level, inputs, actions, before, values, ahead, rewards, terminated, done)
        return (views, envs), steps

    def inputs(self, views: Array) -> Array:
        return views.reshape(len(views), -1)[:, self.told].astype(jnp.float32)

    def returns(self, weights: Weights, params: Any) -> Array:
        """Apply the network to all states, and return the exact expected returns, `[levels]`."""
        log_chances, _ = network(weights, self.inputs(self.env.observations(params)))
        return brl_jax.evaluate(params, jnp.exp(log_chances), within="max_steps").returns


@partial(jax.jit, static_argnums=0)
def varying(env: Any, params: Any) -> Array:
    """Return which entries of a view differ between states: most are the same, and tell nothing."""
    views = env.observations(params).reshape(params.num_states, -1)
    return views.any(axis=0) & ~views.all(axis=0)


def new_weights(key: Array, sizes: tuple[int, ...]) -> Weights:
    scales = [2**0.5] * (len(sizes) - 2) + [0.01]
    initial = [jax.nn.initializers.orthogonal(scale) for scale in scales]
    keys = jax.random.split(key, len(scales))
    return [
        (make(k, shape), jnp.zeros(shape[1]))
        for make, k, shape in zip(initial, keys, pairwise(sizes), strict=True)
    ]


def network(weights: Weights, inputs: Array) -> tuple[Array, Array]:
    """Return the logarithms of the actions' probabilities, and the value."""
    *hidden, (last, bias) = weights
    for weight, each in hidden:
        inputs = jax.nn.relu(inputs @ weight + each)
    outputs = inputs @ last + bias
    return jax.nn.log_softmax(outputs[..., :-1]), outputs[..., -1]


def of_actions(log_chances: Array, actions: Array) -> Array:
    return jnp.take_along_axis(log_chances, actions[..., None], axis=-1)[..., 0]


def advantages_of(steps: Any, discount: float = DISCOUNT, decay: float = LAMBDA) -> Array:
    """Return advantages by generalised advantage estimation.

    The value of the state after a step counts also where the time limit is reached, but not where
    the episode is over.
    """
    errors = steps.reward + discount * steps.value_ahead * ~steps.terminated - steps.value

    def back(ahead: Array, step: tuple[Array, Array]) -> tuple[Array, Array]:
        error, done = step
        advantage = error + discount * decay * ahead * ~done
        return advantage, advantage

    last = jnp.zeros_like(errors[0])
    return jax.lax.scan(back, last, (errors, steps.done), reverse=True)[1]


def loss_of(weights: Any, steps: Steps, advantages: Array, entropy_weight: Array) -> Array:
    log_chances, values = network(weights, steps.observation)
    ratio = jnp.exp(of_actions(log_chances, steps.action) - steps.log_chance)
    scaled = (advantages - advantages.mean()) / (advantages.std() + 1e-8)
    gain = jnp.minimum(ratio * scaled, jnp.clip(ratio, 1 - CLIP, 1 + CLIP) * scaled)
    value_loss = jnp.square(values - steps.value - advantages)
    entropy = -(jnp.exp(log_chances) * log_chances).sum(axis=-1)
    return jnp.mean(VALUE_WEIGHT * value_loss - gain - entropy_weight * entropy)


def scale_of(params: Any) -> Scale:
    """Return random moves and the optimum, within the time limit."""
    random = brl_jax.evaluate(params, brl_jax.random_policy(params), within="max_steps")
    return Scale(params, random.returns, brl_jax.optimum(params, within="max_steps").returns)


def figures_of(returns: Array, scale: Scale) -> Figures:
    lost = scale.best - returns
    # Where random moves are optimal, there is nothing to be lost.
    share = 1 - lost / jnp.maximum(scale.best - scale.random, 1e-6)
    return Figures(share.mean(), lost.mean())


@partial(jax.jit, static_argnames=("learner", "every"))
def run(keys: Array, train: Any, evaluated: list[Any], *, learner: Learner, every: int) -> Any:
    """Learn once for each key; return `Figures`, `[keys, stages]`, for each set of levels."""
    scales = [scale_of(params) for params in evaluated]

    def learn(key: Array) -> Any:
        start_key, key = jax.random.split(key)

        def stage(state: State, keys: Array) -> tuple[State, list[Figures]]:
            state, _ = jax.lax.scan(lambda now, key: learner.update(now, train, key), state, keys)
            found = [learner.returns(state.weights, scale.params) for scale in scales]
            return state, list(map(figures_of, found, scales))

        keys = jax.random.split(key, (learner.updates // every, every))
        return jax.lax.scan(stage, learner.start(start_key, train), keys)[1]

    return jax.lax.map(learn, keys)


def main() -> None:
    parser = parser_of(__doc__, steps=2_000_000, level=None)
    parser.add_argument(
        "--suite", type=partial(suite_of, splits=("train", "test")), default=brl.load_suite(MAZES),
        help="a name or a path; its levels need a time limit",
    )  # fmt: skip
    parser.add_argument("--seeds", type=at_least(1), default=3, help="number of seeds")
    parser.add_argument("--every", type=at_least(1), default=40, help="updates per evaluation")
    args = parser.parse_args()
    env, train = brl_jax.make(args.suite.split("train"), **VIEW)
    _, test = brl_jax.make(args.suite.split("test"), **VIEW)
    _, first = brl_jax.make(args.suite.split("train")[:100], **VIEW)
    stages = max(1, round(args.steps / (NUM_ENVS * NUM_STEPS * args.every)))
    sizes = {"learner": Learner(env, train, stages * args.every), "every": args.every}
    seeds = range(args.seed, args.seed + args.seeds)
    inputs = jnp.stack([jax.random.key(seed) for seed in seeds]), train, [first, test]
    began = time.perf_counter()
    compiled = run.lower(*inputs, **sizes).compile()
    ready = time.perf_counter()
    in_train, in_test = jax.block_until_ready(compiled(*inputs))
    ended = time.perf_counter()

    print(f"{train.num_levels} levels to learn in, {test.num_levels} to be tested on")
    print("updates       steps  share in train  in test  regret")
    for stage in range(stages):
        updates = (stage + 1) * args.every
        means = [each[:, stage].mean() for each in (in_train.share, *in_test)]
        print(
            f"{updates:7} {updates * NUM_ENVS * NUM_STEPS:11,}"
            f"{means[0]:16.3f}{means[1]:9.3f}{means[2]:8.2f}"
        )
    shares = "  ".join(f"{seed[-1]:.3f}" for seed in in_test.share)
    print(f"seeds {', '.join(map(str, seeds))}: share in test {shares}")
    print(f"{ready - began:.1f} s to compile, {ended - ready:.1f} s to run on {jax.devices()[0]}")


if __name__ == "__main__":
    main()
