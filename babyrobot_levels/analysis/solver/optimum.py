"""The optimal values of a level and an optimal policy, exactly.

With a discount: policy iteration. Without one, the loops of the level are found first: a loop of
positive reward makes values infinite, a loop without rewards is as good as stopping, and where the
end cannot be reached with probability one, costs are infinite. Policy iteration does the rest.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any, Literal, overload

import numpy as np

from babyrobot_levels.analysis.solver.average import AverageSolution, is_average, solve_average
from babyrobot_levels.analysis.solver.bounds import margins
from babyrobot_levels.analysis.solver.evaluation import action_values, diverging_states, episode
from babyrobot_levels.analysis.solver.linear import (
    SLACK,
    ZERO,
    Iterated,
    class_averages,
    cycles,
    in_good_time,
    iterate_policies,
    prefer_ending,
)
from babyrobot_levels.analysis.solver.model import (
    Core,
    Model,
    attractor,
    closed_classes,
    end_components,
    surely_ending,
)
from babyrobot_levels.analysis.solver.policies import StateSpace, space_of
from babyrobot_levels.analysis.solver.results import (
    EpisodeTooLongError,
    ExactSolution,
    Solution,
    check_discount,
    check_within,
    probability,
)
from babyrobot_levels.analysis.solver.within import solve_within
from babyrobot_levels.mdp.gridworld import world_of
from babyrobot_levels.mdp.tables import Flags, Floats, Ints
from babyrobot_levels.registry.own import own
from babyrobot_levels.text.words import unexpected

TOLERANCE = 1e-9
"""Actions whose values differ by no more than this share of the optimal one are all greedy."""

NEARLY = 1e-10
"""Chances to reach an exit that differ by no more are the same, to what is made of them."""

MAX_ROUNDS = 1000
"""A bound that rounding cannot exceed: a policy that is no better repeats after a few rounds."""


@overload
def solve(
    level: Any,
    discount: float | None = ...,
    *,
    actions: str = ...,
    within: int | str | None = ...,
    exact: Literal[False] = ...,
) -> Solution: ...


@overload
def solve(level: Any, *, criterion: Literal["average"], actions: str = ...) -> AverageSolution: ...


@overload
def solve(
    level: Any, discount: float | None = ..., *, actions: str = ..., exact: Literal[True]
) -> ExactSolution: ...


@overload
def solve(
    level: Any,
    discount: float | None = ...,
    *,
    actions: str = ...,
    within: int | str | None = ...,
    sight: str | Sequence[str] | Callable[..., Any],
    **options: Any,
) -> Any: ...


def solve(
    level: Any,
    discount: float | None = None,
    *,
    actions: str = "all",
    within: int | str | None = None,
    exact: bool = False,
    sight: str | Sequence[str] | Callable[..., Any] | None = None,
    criterion: str = "return",
    **options: Any,
) -> Solution | ExactSolution | AverageSolution | Any:
    """Return the optimal values of a level and an optimal policy, exactly.

    Without a discount the return is the total reward. It is inf from where the robot can reach,
    with any probability, a loop of positive reward; else -inf from where every policy risks going
    on at a cost for ever: `explanation` of the result says so. Going on for ever with rewards of 0
    adds nothing.

    A time limit counts only where `within` asks for it: the state does not contain the time.
    Within a limit, values are finite, and the optimal policy depends on the step: `policies` of
    the result has one for each step.

    Args:
        level: a name, a path, a mapping or a `Level`.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"all"`, `"moves"` without stay, or `"turns"`: turn left, turn right, forward.
            Actions that a wall refuses can be taken too.
        within: the number of steps after which episodes are truncated, or `"max_steps"` for the
            level's own limit; None for no limit.
        exact: whether to compute over the rationals, with the extra `exact`: an `ExactSolution`,
            whose values are fractions. For levels of up to 3,000 states, without a limit of steps.
        sight: what the agent observes, such as `"view"`, if it does not see everything: returns a
            `SightSolution`, the best that any agent with this sight and its memory can expect. The
            level may then be several, or a suite: the agent does not know in which it is.
        criterion: `"return"`; or `"average"`, the average reward of a step in the long run, for
            levels that go on for ever: an `AverageSolution`, with the gain and the bias of each
            cell. A discount, limits of steps, fractions and sights are for returns.
        options: with a sight, the other arguments of
            `babyrobot_levels.extensions.sight.solve_sight`: `view_radius`, `gap`, `beliefs`, …

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has a value that it cannot have.
        UndefinedReturnError: there is no discount, and it may be optimal to stay in a loop without
            end in which rewards cancel out: +1, -1, +1, … Where ending is at least as good as any
            partial sum of such a loop, this does not matter.
        EpisodeTooLongError: there is no discount, and on average it takes more than 10^10 steps to
            end; or the limit is so large that this takes too long, or the policy is too large.
        NotExactError: there are too many states or digits for exact values, or no python-flint.
    """
    if is_average(criterion, discount=discount, within=within, sight=sight, exact=exact or None):
        return solve_average(space_of(world_of(level), actions))
    if sight is not None:
        if exact:
            raise ValueError("exact values are those of full sight; leave `sight` or `exact` out")
        how = {"discount": discount, "actions": actions, "within": within}
        return own("solve_sight")(level, sight, **how, **options)
    for name in options:
        known = "discount", "actions", "within", "exact", "sight", "criterion"
        raise TypeError(unexpected("solve", name, known))
    level = world_of(level)
    discount = check_discount(discount, level.discount)
    space, limit = space_of(level, actions), check_within(within, level.max_steps)
    if limit is not None:
        if exact:
            raise ValueError("exact values are those without a limit of steps; leave `within` out")
        return solve_within(space, discount, limit)
    model = space.model()
    optimum = optimum_of(model, space, discount)
    solution = solution_of(model, space, optimum, discount)
    if not exact:
        return solution
    # Fractions are asked for seldom.
    from babyrobot_levels.analysis.solver.exact import solve_exactly

    return solve_exactly(space, solution, optimum.ending.core)


def solution_of(model: Model, space: StateSpace, optimum: Optimum, discount: float) -> Solution:
    """Return the solution of a level, whose model and its optimum are at hand."""
    found, expected = optimum.found, space.at_start(model, optimum.found.values)
    ahead = action_values(model, found.values, discount)
    greedy, best = _greedy(model, ahead)
    finite = np.isfinite(found.values)
    return Solution.with_episodes(
        partial(_episodes, model, space, optimum, greedy, discount),
        values=space.spread(model, found.values),
        action_values=space.spread(model, ahead),
        expected_return=expected,
        discount=discount,
        actions=space.actions,
        greedy=space.of_states(model, greedy, False),
        method=found.method,
        iterations=found.rounds,
        residual=float(np.abs(found.values[finite] - best[finite]).max(initial=0.0)),
        margin=space.spread(model, margins(model, found.values, discount, space.largest_reward)),
        level=space.level,
    )


def _episodes(
    model: Model, space: StateSpace, optimum: Optimum, greedy: Flags, discount: float
) -> dict[str, Any]:
    """Return what a solution tells of the episodes of an optimal policy, by the names of fields."""
    values, ending = optimum.found.values, optimum.ending
    steps, success = episode(model.under(ending.policy), ending.steps)
    fastest = _fastest(model, greedy, ending.policy, steps)
    # Where no optimal policy surely ends, each of them is as good as the others.
    endless = np.isinf(steps) & (values < np.inf)
    rows = np.where(endless[:, None], greedy, fastest)
    chosen, success = _to_exits(model, rows, ending.policy, steps, success, space)
    diverging = diverging_states(model.under(chosen), space.at_start(model, values), space)
    return {
        "expected_steps": space.at_start(model, steps),
        "exit_probability": probability(space.at_start(model, success)),
        "fastest": space.of_states(model, rows if discount < 1 else fastest, False),
        "policy": space.of_states(model, chosen, -1),
        "diverging_cells": space.cells(diverging),
        "diverging_condition": space.condition(diverging),
    }


@dataclass(frozen=True, eq=False)
class Ending:
    """An optimal policy that ends as soon as can be expected, where it can surely end.

    Attributes:
        policy: the policy, `[n]`.
        core: the states with finite values.
        steps: those to the end, `[n]`; None where they are not known.
    """

    policy: Ints
    core: Core
    steps: Floats | None


@dataclass(frozen=True, eq=False)
class Optimum:
    """What is found of a model: optimal values, and a policy, which is found when asked for."""

    found: Iterated
    find_ending: Callable[[], Ending]

    @cached_property
    def ending(self) -> Ending:
        """The optimal policy that ends soonest."""
        return self.find_ending()


def optimum_of(model: Model, space: StateSpace, discount: float) -> Optimum:
    """Return the optimum of a model; errors are those of `undiscounted`."""
    return _discounted(model, discount) if discount < 1 else undiscounted(model, space)


def _discounted(model: Model, discount: float) -> Optimum:
    found = iterate_policies(model, discount)

    def ending() -> Ending:
        policy, steps = prefer_ending(model, found.values, found.policy, discount)
        return Ending(policy, Core(model, np.arange(model.size), policy), steps)

    return Optimum(found, ending)


def undiscounted(model: Model, space: StateSpace, slack: float = SLACK) -> Optimum:
    """Return the optimum of a model without a discount.

    Args:
        model: the model, whose `states` are states of the level.
        space: the states of the level, which errors name.
        slack: improvements by no more than this share of the largest value do not count.

    Raises:
        UndefinedReturnError: it may be optimal to stay in a loop in which rewards cancel out.
        EpisodeTooLongError: it takes too long to end.
    """
    loops = find_loops(model)
    unbounded, policy = loops.positive, loops.action.copy()
    if unbounded.any():
        unbounded, towards = attractor(model, np.append(loops.positive, False), model.allowed)
        policy = np.where(loops.positive, loops.action, towards)
    # No action of the others leads there: it would make them unbounded too.
    others = np.flatnonzero(~unbounded)
    rest = model.restrict(~unbounded).with_stops(loops.idle[others])
    sure, rows = surely_ending(rest, rest.allowed)
    core = rest.restrict(sure, rows)
    inside = others[sure]
    found = iterate_policies(core, 1.0, slack)
    values = np.where(unbounded, np.inf, -np.inf)
    values[inside] = found.values
    unclear = values < loops.ceiling - TOLERANCE * np.maximum(1.0, np.abs(loops.ceiling))
    if unclear.any():
        raise space.undefined_return(model, unclear)

    def ending() -> Ending:
        stop = model.reward.shape[1]
        # Where stopping is optimal, it means to stay in the loop, unless ending is just as good.
        is_stop = np.arange(core.reward.shape[1]) == stop
        going_on = core.with_rewards(np.where(is_stop, -np.inf, core.reward))
        core_policy, steps = prefer_ending(going_on, found.values, found.policy, 1.0)
        policy[inside] = np.where(core_policy == stop, loops.action[inside], core_policy)
        if not sure.all():
            # From the other states no policy surely ends, but it may still end by chance.
            _, perhaps = attractor(rest, np.append(sure, True), rest.allowed)
            perhaps = np.where(perhaps >= 0, perhaps, rest.reward.argmax(axis=1))
            policy[others[~sure]] = perhaps[~sure]
        ends = steps if core.size == model.size else None
        return Ending(policy, Core(core, inside, core_policy), ends)

    return Optimum(replace(found, values=values), ending)


def most_expected(model: Model, rewards: Floats, space: StateSpace) -> Floats:
    """Return the most that can be expected of other rewards, `[n, actions]`, from each state."""
    other = model.with_rewards(np.where(model.allowed, rewards, -np.inf))
    return undiscounted(other, space).found.values


def _greedy(model: Model, ahead: Floats) -> tuple[Flags, Floats]:
    """Return the actions with the value of the optimal one, `[n, actions]`, and this, `[n]`."""
    rewards = np.abs(model.reward).max(initial=0.0)
    columns = np.ascontiguousarray(ahead.T)  # Short rows take longer.
    best = columns.max(axis=0, initial=-np.inf)
    size = np.where(np.isfinite(best), np.abs(best), 0.0)
    margin = TOLERANCE * np.maximum(size, min(1.0, rewards))
    return np.ascontiguousarray((columns >= best - margin).T), best


def _fastest(model: Model, greedy: Flags, policy: Ints, steps: Floats) -> Flags:
    """Return the greedy actions that end an episode as soon as a policy does, `[n, actions]`.

    Where the policy may never end, its own action is the only one.

    Args:
        model: the states and actions.
        greedy: the greedy actions, `[n, actions]`.
        policy: an optimal policy, which ends as soon as can be expected.
        steps: its expected steps to the end from each state, `[n]`.
    """
    counting = model.with_rewards(np.where(model.allowed, -1.0, -np.inf))
    left = -action_values(counting, -steps, 1.0)
    ends = np.isfinite(steps)[:, None]
    fastest: Flags = greedy & ends & (left <= (1 + TOLERANCE) * steps[:, None])
    fastest[np.arange(model.size), policy] = True
    return fastest


def _to_exits(
    model: Model, rows: Flags, policy: Ints, steps: Floats, success: Floats, space: StateSpace
) -> tuple[Ints, Floats]:
    """Return a policy that reaches an exit as likely as any that takes some of the actions.

    Args:
        model: the states and actions.
        rows: the actions that may be taken, `[n, actions]`.
        policy: a policy of such actions; it is kept where none is likelier to reach an exit.
        steps: its expected steps to the end, `[n]`.
        success: its chances to reach an exit, `[n]`.
        space: the states.

    Returns:
        The policy, and its chances to reach an exit, `[n]`.
    """
    if (success == 1).all():
        return policy, success
    chances = model.with_rewards(np.where(rows, model.success, -np.inf))
    if (chances.action_values(success, 1.0).max(axis=1) > success + TOLERANCE).any():
        with suppress(EpisodeTooLongError):
            if np.isfinite(steps).all():
                found = iterate_policies(chances, 1.0, NEARLY, policy)
                likely, likeliest = found.values, found.policy
            else:
                optimum = undiscounted(chances, space, NEARLY)
                likely, likeliest = optimum.found.values, optimum.ending.policy
            better = likely > success + TOLERANCE
            return np.where(better, likeliest, policy), np.where(better, likely, success)
    return policy, success


# -- loops without a discount --------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Loops:
    """The states, `[n]` each, in which an episode can go on for ever at no loss.

    Attributes:
        positive: where it can do so with a positive average reward.
        idle: where it can do so with rewards of 0 only.
        action: how: in each of these states, an action that keeps to the loop; -1 elsewhere.
        ceiling: where rewards and costs can cancel out for ever, float64: a bound that no sum
            of them ever exceeds. -inf elsewhere.
    """

    positive: Flags
    idle: Flags
    action: Ints
    ceiling: Floats


def find_loops(model: Model) -> Loops:
    """Find the loops of a model."""
    positive, action = np.zeros(model.size, bool), np.full(model.size, -1)
    ceiling = np.full(model.size, -np.inf)
    if not (model.inner & (model.reward >= 0)).any():
        return Loops(positive, positive, action, ceiling)
    label, inside = end_components(model, model.allowed)
    gains = (inside & (model.reward > 0)).any(axis=1)
    rising = np.unique(label[gains])
    idle_rows = inside & (model.reward == 0) & ~np.isin(label, rising)[:, None]
    by_label = np.argsort(label, kind="stable")
    bounds = np.searchsorted(label[by_label], np.stack([rising, rising + 1]))
    for begin, end in bounds.T:
        members = np.sort(by_label[begin:end])
        average = optimal_average(_part(model, members, inside))
        if average.gain > 0:
            positive[members], action[members] = True, average.policy
        elif average.gain == 0:
            idle_rows[members] = average.tight & (model.reward[members] == 0)
            ceiling[members] = _ceiling(_part(model, members, inside), average)
    idle_label, idle_inside = end_components(model, idle_rows)
    idle = idle_label >= 0
    action[idle] = idle_inside[idle].argmax(axis=1)
    return Loops(positive, idle, action, ceiling)


def _ceiling(model: Model, average: Average) -> Floats:
    """Return what no sum of rewards that cancel out exceeds, `[n]`; -inf where none do.

    Along actions that lose nothing, a step gives on average the fall of the bias. So a sum is at
    most the bias where it begins minus the least bias that the loop has.
    """
    label, inside = end_components(model, average.tight)
    ceiling = np.full(model.size, -np.inf)
    for one in np.unique(label[(inside & (model.reward != 0)).any(axis=1)]):
        members = label == one
        ceiling[members] = average.bias[members] - average.bias[members].min()
    return ceiling


def _part(model: Model, members: Ints, inside: Flags) -> Model:
    keep = np.zeros(model.size, bool)
    keep[members] = True
    return model.restrict(keep, inside)


@dataclass(frozen=True, eq=False)
class Average:
    """The optimal average reward of a component, or a positive one.

    Attributes:
        gain: the average reward per step; exactly 0 where it differs from 0 by rounding only.
        policy: an action for each state, `[n]`, that earns it.
        bias: how much more than the average a state earns before a home state, `[n]`.
        tight: the actions that lose nothing, `[n, actions]`.
    """

    gain: float
    policy: Ints
    bias: Floats
    tight: Flags


def optimal_average(model: Model) -> Average:
    """Return the optimal average reward of a strongly connected component.

    Howard's policy iteration: each round has a policy with a single closed class, in which
    either the average is higher than before, or it is the same and the bias is higher. It
    stops as soon as the average is positive, which is all that matters then.
    """
    scale = float(np.abs(model.reward[model.allowed]).max())
    rows = np.arange(model.size)
    policy = model.reward.argmax(axis=1)
    for rounds_left in reversed(range(MAX_ROUNDS)):
        policy, home = _with_one_class(model, policy)
        total, steps = cycles(model.under(policy), home).T
        gain = float((total[home] / steps[home])[0])
        bias = np.where(home, 0.0, total - gain * steps)
        ahead = model.action_values(bias, 1.0) - gain
        slack = 10 * ZERO * max(scale, float(np.abs(bias).max()))
        best = ahead.argmax(axis=1)
        better = ahead[rows, best] > bias + slack
        if gain > ZERO * scale or not better.any() or not rounds_left:
            gain = gain if abs(gain) > ZERO * scale else 0.0
            return Average(gain, policy, bias, ahead >= bias[:, None] - 10 * slack)
        policy = np.where(better, best, policy)
    raise AssertionError("the last round returns")


def _with_one_class(model: Model, policy: Ints) -> tuple[Ints, Flags]:
    """Return the policy, led from everywhere to its optimal closed class, and a state of it."""
    chain = model.under(policy)
    label = closed_classes(chain)
    home = np.zeros(model.size, bool)
    if np.unique(label[label >= 0]).size == 1:
        home[label.argmax()] = True
        return policy, home
    home[np.nanargmax(class_averages(chain))] = True
    goals = np.append(label == label[home], False)
    _, action = attractor(model, goals, model.allowed)
    others = ~goals[:-1]
    policy = policy.copy()
    policy[others] = in_good_time(model.restrict(others), action[others])
    return policy, home
