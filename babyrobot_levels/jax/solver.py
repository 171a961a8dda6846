"""Solving levels in JAX: the optimum and the worth of policies, for all levels in one call.

The states of all levels are swept together: the values with k + 1 steps left follow from those with
k, so that time limits are exact. Without one, the optimum is swept until nothing changes any more,
and policies are evaluated by solving linear systems: they may take millions of steps to end.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial, reduce
from typing import Any

import jax
import jax.numpy as jnp
from jax import Array, lax
from jax.tree_util import register_dataclass

from babyrobot_levels.analysis.solver.results import check_discount, check_within
from babyrobot_levels.jax import linear
from babyrobot_levels.jax.params import EXIT, TERMINAL, UNLIMITED, EnvParams

MAX_SWEEPS = 10_000
"""Without a time limit, what has not converged after so many sweeps is nan."""


_ROUNDING = 1e-2
"""By so much, sums of probabilities may be off: of half precision, too."""


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
        success: `[levels]`: the probability of reaching an exit.
    """

    values: Array
    returns: Array
    success: Array

    @property
    def learnability(self) -> Array:
        """`success * (1 - success)`, `[levels]`: what `learnability` estimates from episodes."""
        return self.success * (1 - self.success)


def optimum(
    params: EnvParams, *, discount: float | None = None, within: int | str | None = None
) -> Optimum:
    """Return the optimum of all levels.

    It is that of `babyrobot_levels.solve`, to rounding. Actions that the mask refuses can be taken,
    too; mostly, they leave the robot where it is. Without a limit, values that are infinite, or
    that have not converged after 10,000 sweeps, are nan; these sweeps go over all levels.

    Args:
        params: the levels.
        discount: above 0 and at most 1; by default, that of each level.
        within: the number of steps after which episodes are truncated, or `"max_steps"` for each
            level's own limit, by sweeps until they converge where it has none; None for no limit.

    Raises:
        ValueError: an argument has another value.
    """
    found: Optimum = _optimum(params, _factors(params, discount), _limits(params, within))
    return found


def evaluate(
    params: EnvParams,
    policy: Any,
    *,
    discount: float | None = None,
    within: int | str | None = None,
) -> Worth:
    """Return what a policy is worth in all levels.

    It is what `babyrobot_levels.evaluate` returns, to rounding. In float32 and without a limit or a
    discount, rounding grows with the length of episodes: to 3e-4 of the values where they take
    thousands of steps. Values are inf or -inf where rewards or costs may go on for ever; nan where
    both may, and in levels whose system does not converge.

    Args:
        params: the levels.
        policy: the action of each state, int `[states]`, or the probabilities of all actions,
            float `[states, actions]`, whose rounding is scaled away; if all are 0, all actions are
            equally likely. Where the episode is over, it does not matter. In compiled code, only
            its shape and type are checked.
        discount: above 0 and at most 1; by default, that of each level.
        within: as in `optimum`.

    Raises:
        ValueError: an argument has another shape or value.
    """
    given = _checked(params, policy), _factors(params, discount), _limits(params, within)
    values, returns = _evaluate(params, *given)
    return Worth(values, returns, _success(params, *given))


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
    given = _checked(params, policy), _factors(params, discount), _limits(params, within)
    _, returns = _evaluate(params, *given)
    if best is None:
        best = optimum(params, discount=discount, within=within).returns
    return best - returns


def positive_advantage(
    params: EnvParams,
    policy: Any,
    *,
    discount: float | None = None,
    within: int | str | None = None,
) -> Array:
    """Return the mean of the advantages of a policy's steps, those below 0 counted as 0.

    The advantage Q(s, a) - V(s) is that of the policy itself, and exact, as in the
    `positive_advantage` of `babyrobot_levels.score`. The expected sum over an episode is divided
    by the expected number of steps: it is what `positive_value_loss` estimates.

    Args:
        params: the levels.
        policy: as in `evaluate`.
        discount: above 0 and at most 1; by default, that of each level.
        within: as in `optimum`.

    Returns:
        Float `[levels]`; nan where values or episodes are infinite.

    Raises:
        ValueError: an argument has another shape or value.
    """
    given = _checked(params, policy), _factors(params, discount), _limits(params, within)
    return _positive_advantage(params, *given)


def random_policy(params: EnvParams) -> Array:
    """Return the policy that takes all actions equally often that the mask allows.

    Where it allows none, these are all actions. It is the policy `"random"` of
    `babyrobot_levels.evaluate`.

    Args:
        params: the levels.

    Returns:
        The probabilities, float `[states, actions]`.
    """
    allowed = params.allowed.astype(params.reward.dtype)
    allowed = jnp.where(allowed.any(axis=1, keepdims=True), allowed, 1)
    return allowed / allowed.sum(axis=1, keepdims=True)


# -- the model -------------------------------------------------------------------------------


@register_dataclass
@dataclass(frozen=True)
class _Model:
    """Levels as expectations: what a choice gives at once, and what it has ahead.

    There are as many choices as actions; under a policy of one action for each state, one.

    Attributes:
        reward: `[choices, states]`: the expected reward.
        success: `[choices, states]`: the probability that the episode ends at an exit at once.
        target: int32 `[choices, states]`: the state that a choice leads to; `states` for the end,
            and from `states + 1` on for stochastic rows.
        weight: `[outcomes, stochastic rows]`: the probabilities of a row.
        outcome: int32 `[outcomes, stochastic rows]`: the state that an outcome leads to, or
            `states`.
        level: int32 `[states]`: the level of each state.
    """

    reward: Array
    success: Array
    target: Array
    weight: Array
    outcome: Array
    level: Array

    def ahead(self, values: Array, end: float = 0.0) -> list[Array]:
        """Return the expected value after each choice, `[states]`, from values of states.

        Args:
            values: `[states]`.
            end: the value of the end.
        """
        known = jnp.append(values, end)
        if self.weight.size:
            chances = zip(self.weight, self.outcome, strict=True)
            drawn = sum(weight * _at(known, to) for weight, to in chances)
            known = jnp.concatenate([known, drawn])
        return [_at(known, self.target[choice]) for choice in range(self.target.shape[0])]

    def largest_reward(self, params: EnvParams) -> Array:
        """Return the largest reward or cost of each state's level, `[states]`."""
        largest = jnp.abs(self.reward).max(axis=0)
        return jax.ops.segment_max(largest, self.level, params.num_levels)[self.level]

    def under(self, actions: Array) -> _Model:
        """Return the model in which these actions, `[states]`, are the only choice."""
        chosen = jnp.clip(actions, 0, self.target.shape[0] - 1)[None]
        return replace(
            self,
            reward=jnp.take_along_axis(self.reward, chosen, axis=0),
            success=jnp.take_along_axis(self.success, chosen, axis=0),
            target=jnp.take_along_axis(self.target, chosen, axis=0),
        )


def _mean(weights: Array, values: Sequence[Array]) -> Array:
    """Return the mean of some arrays, whose weights add up to 1: the first has what others leave.

    So rounded weights do not make values grow from step to step. Compilers make far faster code of
    a few such operations than of one along a short axis.
    """
    first = values[0]
    return sum(
        (weights[number] * (values[number] - first) for number in range(1, len(values))), first
    )


def _at(array: Array, index: Array) -> Array:
    return array.at[index].get(mode="promise_in_bounds")


def _model_of(params: EnvParams) -> _Model:
    states, actions, rows = params.num_states, params.num_actions, params.num_rows
    following = jnp.where((params.outcome & TERMINAL) > 0, states, params.next_state)
    row_next = params.next_state[:rows]
    is_drawn = row_next < 0
    target = jnp.where(is_drawn, states - row_next, following[:rows])
    shape = (params.probability.shape[0], params.most_outcomes)

    def expected(of_outcome: Array) -> Array:
        found = of_outcome[:rows]
        if params.draws_outcomes:
            drawn = (params.probability * of_outcome[rows:].reshape(shape)).sum(axis=1)
            found = jnp.where(is_drawn, drawn[jnp.maximum(-1 - row_next, 0)], found)
        return found.reshape(states, actions).T

    return _Model(
        reward=expected(params.reward),
        success=expected(((params.outcome & EXIT) > 0).astype(params.reward.dtype)),
        target=target.reshape(states, actions).T,
        weight=params.probability.T,
        # Outcomes that do not exist may lead anywhere.
        outcome=jnp.clip(following[rows:].reshape(shape).T, 0, states),
        level=_group(params.offset, states),
    )


def _group(first: Array, count: int) -> Array:
    """Return to which level each of some things belongs, int32 `[count]`.

    Args:
        first: `[levels + 1]`: where those of each level begin.
        count: how many there are.
    """
    number = jnp.arange(count)
    return jnp.searchsorted(first[1:-1], number, side="right").astype(jnp.int32)


def _at_starts(params: EnvParams, values: Array) -> Array:
    """Return the expectation of values over each level's starts, `[levels]`."""
    first, count = params.first_start, params.starts.shape[0]
    of_starts = jnp.where(jnp.arange(count) < first[-1], values[params.starts], 0)
    sums = jax.ops.segment_sum(of_starts, _group(first, count), params.num_levels)
    return sums / jnp.diff(first)


# -- sweeps ----------------------------------------------------------------------------------


@jax.jit
def _optimum(params: EnvParams, discount: Array, limit: Array | None) -> Optimum:
    model = _model_of(params)
    factor = discount[model.level]
    # Among actions whose values differ by rounding, the one stays that led to the value first: in
    # a loop without rewards, another one may go round for ever.
    tie = 8 * jnp.finfo(factor.dtype).eps

    def sweep(values: Array, actions: Array) -> tuple[Array, Array]:
        found = [
            reward + factor * ahead
            for reward, ahead in zip(model.reward, model.ahead(values), strict=True)
        ]
        kept = sum(jnp.where(actions == number, each, 0) for number, each in enumerate(found))
        kept += tie * jnp.abs(kept)
        for number, each in enumerate(found):
            actions = jnp.where(each > kept, number, actions)
            kept = jnp.maximum(each, kept)
        return reduce(jnp.maximum, found), actions

    nothing = jnp.zeros(params.num_states, factor.dtype)
    if limit is None:
        limit = jnp.full_like(params.limit, UNLIMITED)
    start = nothing, nothing.astype(jnp.int32)
    values, actions = _swept(sweep, start, limit[model.level], model.largest_reward(params))
    return Optimum(values, _at_starts(params, values), actions)


def _mixed(params: EnvParams, policy: Array, discount: Array) -> tuple[_Model, Array, Array]:
    """Return a model, the probability of each choice, `[choices, states]`, and the discount."""
    model = _model_of(params)
    if policy.ndim == 1:
        model = model.under(policy)
        return model, jnp.ones_like(model.reward), discount[model.level]
    weights = policy.astype(discount.dtype).T
    total = weights.sum(axis=0)
    weights = jnp.where(total > 0, weights / total, 1 / params.num_actions)
    return model, weights, discount[model.level]


@jax.jit
def _evaluate(
    params: EnvParams, policy: Array, discount: Array, limit: Array | None
) -> tuple[Array, Array]:
    model, weights, factor = _mixed(params, policy, discount)
    reward = (weights * model.reward).sum(axis=0)
    largest = model.largest_reward(params)
    values = _sums(params, model, weights, reward, factor, limit, largest)
    return values, _at_starts(params, values)


@jax.jit
def _success(params: EnvParams, policy: Array, discount: Array, limit: Array | None) -> Array:
    model, weights, _ = _mixed(params, policy, discount)
    gained, one = (weights * model.success).sum(axis=0), jnp.ones_like(model.success[0])
    reached = _sums(params, model, weights, gained, one, limit, one)
    return jnp.clip(_at_starts(params, reached), 0, 1)


@jax.jit
def _positive_advantage(
    params: EnvParams, policy: Array, discount: Array, limit: Array | None
) -> Array:
    model, weights, factor = _mixed(params, policy, discount)
    one, largest = jnp.ones_like(factor), model.largest_reward(params)

    def gained(values: Array) -> tuple[Array, Array]:
        ahead = zip(model.reward, model.ahead(values), strict=True)
        found = [reward + factor * each for reward, each in ahead]
        mean = _mean(weights, found)
        above = zip(weights, found, strict=True)
        return mean, sum(weight * jnp.maximum(each - mean, 0) for weight, each in above)

    if limit is None:
        reward = (weights * model.reward).sum(axis=0)
        values = _sums(params, model, weights, reward, factor, None, largest)
        gains = jnp.where(jnp.isfinite(values), gained(values)[1], 0)
        total = _sums(params, model, weights, gains, one, None, largest)
        steps = _sums(params, model, weights, one, one, None, one)
    else:

        def sweep(sums: Array, _: None) -> tuple[Array, None]:
            values, gains = gained(sums[0])
            total, steps = (_mean(weights, model.ahead(each)) for each in sums[1:])
            return jnp.stack([values, total + gains, steps + 1]), None

        sizes = jnp.stack([largest, largest, one])
        start = jnp.zeros_like(sizes), None
        (values, total, steps), _ = _swept(sweep, start, limit[model.level], sizes)
    returns, total, steps = (_at_starts(params, each) for each in (values, total, steps))
    return jnp.where(jnp.isfinite(returns) & jnp.isfinite(steps), total / steps, jnp.nan)


def _sums(
    params: EnvParams,
    model: _Model,
    weights: Array,
    gained: Array,
    factor: Array,
    limit: Array | None,
    largest: Array,
) -> Array:
    """Return the expected sums of what a policy gains in each step, `[states]`.

    Args:
        params: the levels.
        model: the same levels.
        weights: `[choices, states]`: the probability of each choice.
        gained: `[states]`: the expected gain of a step.
        factor: `[states]`: the discount.
        limit: int32 `[levels]`: the number of steps; None for no limit.
        largest: `[states]`: the largest gain of a step in the state's level.
    """
    if limit is None:
        return _in_the_long_run(model, weights, gained, factor, params.num_levels)

    def sweep(values: Array, _: None) -> tuple[Array, None]:
        return gained + factor * _mean(weights, model.ahead(values)), None

    return _swept(sweep, (jnp.zeros_like(gained), None), limit[model.level], largest)[0]


def _swept(sweep: Any, start: tuple[Array, Any], limit: Array, largest: Array) -> tuple[Array, Any]:
    """Sweep until each state's limit, or until nothing changes; return values and more.

    Args:
        sweep: from values, `[…, states]`, and more of each state to the next ones.
        start: what they are with no steps left.
        limit: int32 `[states]`: the number of sweeps.
        largest: `[…, states]`: the largest reward of the state's level.
    """
    is_limited = limit < UNLIMITED
    last = jnp.where(is_limited, limit, MAX_SWEEPS)
    rounding = jnp.finfo(largest.dtype).eps
    slack = jnp.where(is_limited, 0, rounding * largest)

    def is_rounding(values: Array, past: Array) -> Array:
        most = 64 * rounding * (largest + jnp.abs(values))
        return ~is_limited & (jnp.abs(values - past) <= most)

    def going(carry: Any) -> Any:
        count, _, _, changed = carry
        return (changed & (count < last)).any()

    def step(carry: Any) -> Any:
        count, before, past, _ = carry
        found = jax.tree.map(partial(jnp.where, count < last), sweep(*past), past)
        # Without a limit, rounding may change last digits back and forth for ever.
        swings = (found[0] == before) & is_rounding(found[0], past[0])
        changed = (jnp.abs(found[0] - past[0]) > slack) & ~swings
        return count + 1, past[0], found, changed

    begin = jnp.int32(0), start[0], start, jnp.ones(largest.shape, bool)
    _, before, (values, more), _ = lax.while_loop(going, step, begin)
    return jnp.where(is_limited | is_rounding(values, before), values, jnp.nan), more


# -- without a limit -------------------------------------------------------------------------


def _in_the_long_run(
    model: _Model, weights: Array, reward: Array, factor: Array, num_levels: int
) -> Array:
    """Return the values of a policy, `[states]`, in episodes without a limit.

    Args:
        model: the levels.
        weights: `[choices, states]`: the probability of each choice.
        reward: `[states]`: the expected reward of a step.
        factor: `[states]`: the discount.
        num_levels: how many levels there are.
    """

    def may_reach(goals: Array, end: float) -> Array:
        def step(carry: Any) -> Any:
            reached, _ = carry
            ahead = model.ahead(reached.astype(factor.dtype), end)
            more = reached | (sum(map(jnp.multiply, weights, ahead)) > 0)
            return more, (more & ~reached).any()

        reached: Array = lax.while_loop(lambda carry: carry[1], step, (goals, True))[0]
        return reached

    # Without a discount, what goes on for ever adds up to nothing or to infinity.
    is_idle = ~may_reach((factor < 1) | (reward != 0), 1.0)
    for_ever = ~may_reach((factor < 1) | is_idle, 1.0)
    gains = may_reach(for_ever & (reward > 0), 0.0)
    loses = may_reach(for_ever & (reward < 0), 0.0)
    is_finite = ~(is_idle | gains | loses)

    def apply(values: Array) -> Array:
        # Differences first: what is almost equal cancels out without rounding.
        ahead = model.ahead(values)
        falls = sum(w * (values - factor * each) for w, each in zip(weights, ahead, strict=True))
        return jnp.where(is_finite, falls, values)

    values, converged = linear.solve(
        apply, jnp.where(is_finite, reward, 0), model.level, num_levels
    )
    values = jnp.where(converged[model.level], values, jnp.nan)
    values = jnp.where(gains, jnp.inf, jnp.where(loses, -jnp.inf, values))
    return jnp.where(gains & loses, jnp.nan, values)


# -- arguments -------------------------------------------------------------------------------


def _factors(params: EnvParams, discount: float | None) -> Array:
    """Return the discount of each level, `[levels]`.

    Raises:
        ValueError: it is not above 0 and at most 1.
    """
    if discount is None:
        return params.discount
    return jnp.full(params.num_levels, check_discount(discount, 1), params.reward.dtype)


def _limits(params: EnvParams, within: int | str | None) -> Array | None:
    """Return after how many steps episodes of each level are truncated, int32 `[levels]`.

    Raises:
        ValueError: it is no such number.
    """
    if within == "max_steps":
        return params.limit
    steps = check_within(within, None)
    return None if steps is None else jnp.full(params.num_levels, min(steps, UNLIMITED), jnp.int32)


def _checked(params: EnvParams, policy: Any) -> Array:
    """Return a policy as an array.

    Raises:
        ValueError: it does not fit the levels.
    """
    policy = jnp.asarray(policy)
    states, actions = params.num_states, params.num_actions
    if policy.shape == (states,) and jnp.issubdtype(policy.dtype, jnp.integer):
        is_right = (policy >= 0) & (policy < actions)
        rule = f"an action is from 0 to {actions - 1}"
    elif policy.shape == (states, actions) and jnp.issubdtype(policy.dtype, jnp.floating):
        total = policy.sum(axis=1)
        is_right = (policy >= 0).all(axis=1) & ((jnp.abs(total - 1) <= _ROUNDING) | (total == 0))
        rule = "probabilities are not below 0, and add up to 1"
    else:
        raise ValueError(
            f"a policy for these levels is an array of integers [{states}], the actions, or an "
            f"array of floats [{states}, {actions}], their probabilities, not one of "
            f"{policy.dtype} and shape {list(policy.shape)}"
        )
    ends = (params.outcome[: params.num_rows] & TERMINAL) > 0
    is_wrong = ~is_right & ~ends.reshape(states, actions).all(axis=1)
    if not isinstance(is_wrong, jax.core.Tracer) and is_wrong.any():
        state = int(is_wrong.argmax())
        raise ValueError(f"{rule}, and in state {state:,} the policy has {policy[state].tolist()}")
    return policy
