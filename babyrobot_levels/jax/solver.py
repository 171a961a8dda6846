"""Solving levels in JAX: the optimum and the worth of policies, for all levels in one call.

The states of all levels are swept together: the values with k + 1 steps left follow from those with
k. So a time limit is exact; without one, sweeps go on until no value changes any more.
"""

from __future__ import annotations

import operator
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
from jax import Array, lax
from jax.tree_util import register_dataclass

from babyrobot_levels.jax.params import TERMINAL, UNLIMITED, EnvParams

MAX_SWEEPS = 10_000
"""Without a time limit, what has not converged after so many sweeps is nan."""


@register_dataclass
@dataclass(frozen=True)
class Optimum:
    """The optimum of levels.

    Attributes:
        values: `[states]`: the optimal expected return from each state; 0 where the episode is
            over.
        returns: `[levels]`: the optimal expected return of an episode, over the level's starts.
        actions: int32 `[states]`: an optimal action, within a limit with all steps left.
    """

    values: Array
    returns: Array
    actions: Array


@register_dataclass
@dataclass(frozen=True)
class Worth:
    """What a policy is worth in levels.

    Attributes:
        values: `[states]`: the expected return from each state; 0 where the episode is over.
        returns: `[levels]`: the expected return of an episode, over the level's starts.
    """

    values: Array
    returns: Array


def optimum(
    params: EnvParams, *, discount: float | None = None, within: int | str | None = None
) -> Optimum:
    """Return the optimum of all levels.

    It is that of `babyrobot_levels.solve`, to rounding. Actions that the mask refuses can be taken,
    too; mostly, they leave the robot where it is. Without a limit, values that are infinite, or
    that have not converged after 10,000 sweeps, are nan.

    Args:
        params: the levels.
        discount: above 0 and at most 1; by default, that of each level.
        within: the number of steps after which episodes are truncated, or `"max_steps"` for each
            level's own limit; None for no limit.

    Raises:
        ValueError: an argument has another value.
    """
    return _optimum(params, _factors(params, discount), _limits(params, within))


def evaluate(
    params: EnvParams,
    policy: Any,
    *,
    discount: float | None = None,
    within: int | str | None = None,
) -> Worth:
    """Return what a policy is worth in all levels.

    It is what `babyrobot_levels.evaluate` returns, to rounding, and nan as `optimum` tells.

    Args:
        params: the levels.
        policy: the action of each state, int `[states]`, or the probabilities of all actions,
            float `[states, actions]`, which are scaled to add up to 1. Where the episode is over,
            it does not matter.
        discount: above 0 and at most 1; by default, that of each level.
        within: as in `optimum`.

    Raises:
        ValueError: an argument has another shape or value.
    """
    policy = _checked(params, policy)
    return _evaluate(params, policy, _factors(params, discount), _limits(params, within))


def regret(
    params: EnvParams,
    policy: Any,
    *,
    best: Array | None = None,
    discount: float | None = None,
    within: int | str | None = None,
) -> Array:
    """Return by how much a policy falls short of the optimal expected return, float `[levels]`.

    Args:
        params: the levels.
        policy: as in `evaluate`.
        best: `returns` of the optimum, where it is known already: that saves half the time.
        discount: above 0 and at most 1; by default, that of each level.
        within: as in `optimum`.

    Raises:
        ValueError: an argument has another shape or value.
    """
    worth = evaluate(params, policy, discount=discount, within=within)
    if best is None:
        best = optimum(params, discount=discount, within=within).returns
    return best - worth.returns


def random_policy(params: EnvParams) -> Array:
    """Return the policy that takes all actions equally often that the mask allows.

    Where it allows none, these are all actions. It is the policy `"random"` of
    `babyrobot_levels.evaluate`.

    Args:
        params: the levels.

    Returns:
        The probabilities, float `[states, actions]`.
    """
    bits = params.mask[:, None] >> jnp.arange(params.num_actions, dtype=params.mask.dtype)
    allowed = (bits & 1).astype(params.reward.dtype)
    allowed = jnp.where(allowed.any(axis=1, keepdims=True), allowed, 1)
    return allowed / allowed.sum(axis=1, keepdims=True)


# -- the model -------------------------------------------------------------------------------


@register_dataclass
@dataclass(frozen=True)
class _Model:
    """Levels as expectations: what an action gives at once, and where its value comes from.

    The values of states are followed by a 0, for the end, and by those of stochastic rows.

    Attributes:
        reward: `[actions, states]`: the expected reward.
        target: int32 `[actions, states]`: which value an action has ahead of it.
        weight: `[outcomes, stochastic rows]`: the probabilities of a row.
        outcome: int32 `[outcomes, stochastic rows]`: the values that it draws from.
        level: int32 `[states]`: the level of each state.
    """

    reward: Array
    target: Array
    weight: Array
    outcome: Array
    level: Array

    def ahead(self, values: Array, target: Array) -> Array:
        """Return what is expected after some actions, as `target`."""
        known = jnp.append(values, 0)
        if self.weight.size:
            drawn = (self.weight * _at(known, self.outcome)).sum(axis=0)
            known = jnp.concatenate([known, drawn])
        return _at(known, target)


def _at(array: Array, index: Array) -> Array:
    return array.at[index].get(mode="promise_in_bounds")


def _model(params: EnvParams) -> _Model:
    states, actions, rows = params.num_states, params.num_actions, params.num_rows
    here = jnp.arange(states)
    ends = (params.outcome & TERMINAL) > 0
    following = jnp.where(ends, states, params.next_state)
    row_next = params.next_state[:rows]
    is_drawn = row_next < 0
    target = jnp.where(is_drawn, states - row_next, following[:rows])
    reward = params.reward[:rows]
    shape = (params.probability.shape[0], params.most_outcomes)
    weight, outcome = params.probability, following[rows:].reshape(shape)
    if params.draws_outcomes:
        drawn = (weight * params.reward[rows:].reshape(shape)).sum(axis=1)
        reward = jnp.where(is_drawn, drawn[jnp.maximum(-1 - row_next, 0)], reward)
    # A single level has the room of the largest one: beyond its own states, nothing happens.
    exists = here < params.offset[-1]
    return _Model(
        reward=jnp.where(exists, reward.reshape(states, actions).T, 0),
        target=jnp.where(exists, target.reshape(states, actions).T, states),
        weight=weight.T,
        outcome=jnp.clip(outcome.T, 0, states),
        level=jnp.searchsorted(params.offset[1:-1], here, side="right").astype(jnp.int32),
    )


def _at_starts(params: EnvParams, values: Array) -> Array:
    """Return the expectation of values over each level's starts, `[levels]`."""
    first = params.first_start
    number = jnp.arange(params.starts.shape[0])
    level = jnp.searchsorted(first[1:-1], number, side="right")
    sums = jax.ops.segment_sum(
        jnp.where(number < first[-1], values[params.starts], 0), level, params.num_levels
    )
    return sums / jnp.diff(first)


# -- sweeps ----------------------------------------------------------------------------------


@jax.jit
def _optimum(params: EnvParams, discount: Array, limit: Array) -> Optimum:
    model = _model(params)
    factor, number = discount[model.level], jnp.arange(params.num_actions)[:, None]
    # Among actions whose values differ by rounding, the one stays that led to the value first: in
    # a loop without rewards, another one may go round for ever.
    tie = 8 * jnp.finfo(factor.dtype).eps

    def sweep(values: Array, actions: Array) -> tuple[Array, Array]:
        found = model.reward + factor * model.ahead(values, model.target)
        preferred = jnp.where(number == actions, found + tie * jnp.abs(found), found)
        return found.max(axis=0), preferred.argmax(axis=0).astype(jnp.int32)

    nothing = jnp.zeros(params.num_states, factor.dtype)
    first = nothing.astype(jnp.int32)
    values, actions = _swept(sweep, nothing, first, limit[model.level])
    return Optimum(values, _at_starts(params, values), actions)


@jax.jit
def _evaluate(params: EnvParams, policy: Array, discount: Array, limit: Array) -> Worth:
    model = _model(params)
    factor = discount[model.level]
    if policy.ndim == 1:
        chosen = jnp.clip(policy, 0, params.num_actions - 1)[None]
        reward = jnp.take_along_axis(model.reward, chosen, axis=0)[0]
        target = jnp.take_along_axis(model.target, chosen, axis=0)[0]

        def ahead(values: Array) -> Array:
            return model.ahead(values, target)
    else:
        weights = policy.astype(factor.dtype).T
        total = weights.sum(axis=0)
        weights = weights / jnp.where(total > 0, total, 1)
        reward = (weights * model.reward).sum(axis=0)

        def ahead(values: Array) -> Array:
            return (weights * model.ahead(values, model.target)).sum(axis=0)

    def sweep(values: Array, _: None) -> tuple[Array, None]:
        return reward + factor * ahead(values), None

    nothing = jnp.zeros(params.num_states, factor.dtype)
    values, _ = _swept(sweep, nothing, None, limit[model.level])
    return Worth(values, _at_starts(params, values))


def _swept(sweep: Any, values: Array, extra: Any, limit: Array) -> tuple[Array, Any]:
    """Sweep until each state's limit, or until nothing changes; return values and more.

    Args:
        sweep: from values `[states]` and more to the next ones.
        values: the values with no steps left.
        extra: what else there is of each state.
        limit: int32 `[states]`: the number of sweeps.
    """
    last = jnp.where(limit == UNLIMITED, MAX_SWEEPS, limit)

    def going(carry: Any) -> Any:
        return carry[-1].any()

    def step(carry: Any) -> Any:
        count, values, extra, _ = carry
        due = count < last
        swept, more = sweep(values, extra)
        changed = due & ((swept > values) | (swept < values))
        now, extra = jax.tree.map(partial(jnp.where, due), (swept, more), (values, extra))
        return count + 1, now, extra, changed

    start = jnp.int32(0), values, extra, jnp.ones(values.shape, bool)
    _, values, extra, changed = lax.while_loop(going, step, start)
    return jnp.where(changed & (limit == UNLIMITED), jnp.nan, values), extra


# -- arguments -------------------------------------------------------------------------------


def _factors(params: EnvParams, discount: float | None) -> Array:
    """Return the discount of each level, `[levels]`.

    Raises:
        ValueError: it is not above 0 and at most 1.
    """
    if discount is None:
        return params.discount
    with suppress(TypeError):
        if 0 < discount <= 1:
            return jnp.full(params.num_levels, discount, params.reward.dtype)
    raise ValueError(f"discount must be above 0 and at most 1, not {discount!r}")


def _limits(params: EnvParams, within: int | str | None) -> Array:
    """Return the number of steps in which episodes of each level end, int32 `[levels]`.

    Raises:
        ValueError: it is no such number.
    """
    if within is None:
        return jnp.full(params.num_levels, UNLIMITED, jnp.int32)
    if within == "max_steps":
        return params.limit
    with suppress(TypeError):
        if not isinstance(within, bool | str) and operator.index(within) >= 1:
            return jnp.full(params.num_levels, min(operator.index(within), UNLIMITED), jnp.int32)
    raise ValueError(f"within must be a number of steps from 1 on, or 'max_steps', not {within!r}")


def _checked(params: EnvParams, policy: Any) -> Array:
    """Return a policy as an array.

    Raises:
        ValueError: it does not fit the levels.
    """
    policy = jnp.asarray(policy)
    states, actions = params.num_states, params.num_actions
    if policy.shape == (states,) and jnp.issubdtype(policy.dtype, jnp.integer):
        return policy
    if policy.shape == (states, actions) and jnp.issubdtype(policy.dtype, jnp.floating):
        return policy
    raise ValueError(
        f"a policy for these levels is an array of integers [{states}], the actions, or an array "
        f"of floats [{states}, {actions}], their probabilities, not one of {policy.dtype} and "
        f"shape {list(policy.shape)}"
    )
