"""Estimates of regret beside exact regret, in all levels of a buffer, while agents learn in them.

All seeds are computed at once.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from families import MAX_STEPS
from jax import Array
from ppo_jax import DISCOUNT, LAMBDA, REWARD_SCALE, Learner, Scale, State, network

import babyrobot_levels.jax as brl_jax
from babyrobot_levels.jax.params import TERMINAL

EPISODES = (1, 8, 64)
"""How many episodes of each level the estimates are made from."""


class Episodes(NamedTuple):
    """One episode of each environment, `[steps, levels, episodes]`.

    Attributes:
        alive: whether the step was taken: the episode was not over yet.
        reward: as the learner gets them, scaled.
        value: what the network says of the state before the step.
        advantage: by generalised advantage estimation, with the learner's discount and lambda.
        error: the temporal difference error, 0 after the end.
        done: whether the episode ended with the step.
        reached: whether the step led to the exit.
    """

    alive: Array
    reward: Array
    value: Array
    advantage: Array
    error: Array
    done: Array
    reached: Array


class Truth(NamedTuple):
    """What is computed exactly, `[levels]`: the regret as the learner's rewards are scaled."""

    regret: Array
    share: Array
    success: Array


def tables(learner: Learner, weights: Any, params: Any) -> tuple[Array, Array]:
    """Return the logarithms of the actions' probabilities, and the value, in all states."""
    return network(weights, learner.inputs(learner.env.observations(params)))


def truth_of(params: Any, log_chances: Array, scale: Scale) -> Truth:
    policy = jnp.exp(log_chances)
    returns = brl_jax.evaluate(params, policy, within="max_steps").returns
    # Episodes end at the exit only: that is all that this reward tells.
    reached = ((params.outcome & TERMINAL) > 0).astype(params.reward.dtype)
    told = replace(params, reward=reached)
    success = brl_jax.evaluate(told, policy, discount=1.0, within="max_steps").returns
    lost, most = scale.best - returns, scale.best - scale.random
    return Truth(lost * REWARD_SCALE, 1 - lost / jnp.maximum(most, 1e-6), success)


def play(env: Any, params: Any, log_chances: Array, values: Array, key: Array, count: int) -> Any:
    """Play so many episodes of each level, to the end or to the time limit.

    The network's answers are looked up in tables, which makes no difference to what is played.
    """
    levels = jnp.repeat(jnp.arange(params.num_levels), count)
    reset_key, key = jax.random.split(key)
    keys = jax.random.split(reset_key, levels.size)
    _, begun = jax.vmap(env.reset_to_level, (0, 0, None))(keys, levels, params)

    def step(carry: tuple[Any, Array], key: Array) -> tuple[Any, Any]:
        states, alive = carry
        action_key, words_key = jax.random.split(key)
        actions = jax.random.categorical(action_key, log_chances[states.state])
        words = jax.random.bits(words_key, (levels.size, params.step_words), jnp.uint32)
        after, rewards, terminated, _ = jax.vmap(env.transition, (0, 0, 0, None))(
            words, states, actions, params
        )
        rewards = jnp.where(alive, rewards * REWARD_SCALE, 0)
        value, ahead = values[states.state], values[after.state]
        discounts = params.discount[states.level]
        # As the learner has it: the value ahead counts at the time limit, but not at the exit.
        error = jnp.where(alive, rewards + discounts * ahead * ~terminated - value, 0)
        done = terminated | env.is_truncated(after, params)
        told = alive, rewards, value, error, done, alive & terminated, discounts * LAMBDA * ~done
        return (after, alive & ~done), told

    begin = begun, jnp.ones(levels.size, bool)
    _, told = jax.lax.scan(step, begin, jax.random.split(key, MAX_STEPS))
    alive, reward, value, error, done, reached, factor = told

    def back(ahead: Array, now: tuple[Array, Array]) -> tuple[Array, Array]:
        advantage = now[0] + now[1] * ahead
        return advantage, advantage

    _, advantage = jax.lax.scan(back, jnp.zeros_like(error[0]), (error, factor), reverse=True)
    shape = (MAX_STEPS, params.num_levels, count)
    parts = alive, reward, value, advantage, error, done & alive, reached
    return Episodes(*(each.reshape(shape) for each in parts))


def rollouts(learner: Learner, weights: Any, params: Any, key: Array, count: int) -> Any:
    """Play as many steps in each level as learners do, with the network; only to be timed."""
    fixed = replace(params, draws_levels=False)
    levels = jnp.repeat(jnp.arange(params.num_levels), count)
    keys = jax.random.split(key, levels.size)
    begun = jax.vmap(learner.env.reset_to_level, (0, 0, None))(keys, levels, fixed)
    _, steps = learner.play(weights, fixed, begun, key, MAX_STEPS)
    return steps.value, steps.reward, steps.done


def returns_of(episodes: Episodes, discount: Array) -> Array:
    """Return the discounted return of each episode, `[levels, episodes]`."""
    powers = discount[:, None] ** jnp.arange(len(episodes.reward))[:, None, None]
    return (powers * episodes.reward).sum(axis=0)


def estimates(
    episodes: Episodes, params: Any, best: Array, highest: Array
) -> tuple[dict[str, Array], Array]:
    """Return the estimates, `[levels]`, and the highest return of each level so far."""
    count = params.num_levels
    numbers = jnp.broadcast_to(jnp.arange(count)[:, None], episodes.alive.shape)
    taken = jnp.where(episodes.alive, numbers, count)  # steps after the end are of no level
    returns = returns_of(episodes, params.discount)
    highest = jnp.maximum(highest, returns.max(axis=1))
    reached = episodes.reached.any(axis=0)
    found = {
        "pvl": brl_jax.positive_value_loss(episodes.advantage, taken, count),
        "maxmc": brl_jax.max_monte_carlo(episodes.value, taken, highest),
        "learnability": brl_jax.learnability(reached, numbers[0], count),
        "mna": brl_jax.maximised_negative_advantage(
            *(each.reshape(MAX_STEPS, -1) for each in (episodes.error, episodes.done, taken)),
            highest > 0,
            discount=DISCOUNT,
            decay=LAMBDA,
        ),
        # What is easily had, to compare with: how often it fails, and regret by the true optimum.
        "failures": 1 - reached.mean(axis=1),
        "optimum-less-returns": best * REWARD_SCALE - returns.mean(axis=1),
    }
    return found, highest


@partial(jax.jit, static_argnames="learner")
def start(keys: Array, params: Any, *, learner: Learner) -> State:
    """Return a new learner for each key."""
    return jax.vmap(learner.start, (0, None))(keys, params)


@partial(jax.jit, static_argnames="learner")
def learn(states: State, keys: Array, params: Any, *, learner: Learner) -> State:
    """Learn for some updates; keys are `[seeds, updates]`."""

    def of_seed(state: State, keys: Array) -> State:
        update = lambda now, key: (learner.update(now, params, key)[0], None)  # noqa: E731
        return jax.lax.scan(update, state, keys)[0]

    return jax.vmap(of_seed)(states, keys)


@partial(jax.jit, static_argnames=("learner", "episodes"))
def judged(
    weights: Any,
    highest: Array,
    keys: Array,
    params: Any,
    scale: Scale,
    *,
    learner: Learner,
    episodes: tuple[int, ...],
) -> tuple[Array, dict[str, Array], Truth]:
    """Return the highest returns so far, the estimates, and what is true.

    Args:
        weights: of the network of each seed.
        highest: `[seeds, numbers of episodes, levels]`: the highest returns before.
        keys: `[seeds]`.
        params: the levels.
        scale: the exact returns of random moves and of the optimum in them.
        learner: the learner.
        episodes: from how many episodes estimates are made, ascending.

    Returns:
        The highest returns; the estimates by their names, likewise `[seeds, numbers of episodes,
        levels]`; and the `Truth`, `[seeds, levels]`.
    """

    def of_seed(weights: Any, highest: Array, key: Array) -> Any:
        log_chances, values = tables(learner, weights, params)
        truth = truth_of(params, log_chances, scale)
        played = play(learner.env, params, log_chances, values, key, episodes[-1])
        found = []
        for number, count in enumerate(episodes):
            first = Episodes(*(each[..., :count] for each in played))
            found.append(estimates(first, params, scale.best, highest[number]))
        scores = jax.tree.map(lambda *each: jnp.stack(each), *(scores for scores, _ in found))
        return jnp.stack([most for _, most in found]), scores, truth

    return jax.vmap(of_seed)(weights, highest, keys)
