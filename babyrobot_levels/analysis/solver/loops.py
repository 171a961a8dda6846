"""Loops that make undiscounted totals special: those that pay for ever, or cost nothing.

Where the robot can go on for ever with a positive average reward, its total is infinite; where it
can go on for ever for nothing, going on is as good as stopping.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from babyrobot_levels.analysis.solver.errors import no_total
from babyrobot_levels.analysis.solver.graphs import attractor, closed_classes, end_components
from babyrobot_levels.analysis.solver.iteration import in_good_time
from babyrobot_levels.analysis.solver.linear import class_averages, cycles
from babyrobot_levels.analysis.solver.model import Flags, Floats, Ints, Model

ZERO = 1e-12
"""Averages of this share of the largest reward are rounding: they count as zero."""

MAX_ROUNDS = 1000
"""A bound that rounding cannot push: a policy that is no better comes back after a few rounds."""


@dataclass(frozen=True, eq=False)
class Loops:
    """The states, `[n]` each, in which the robot can go on for ever at no loss.

    Attributes:
        pays: where it can do so with a positive average reward.
        idle: where it can do so with rewards of 0 only.
        action: how: in each of these states, an action that keeps to the loop; -1 elsewhere.
        ceiling: where rewards and costs can cancel out for ever, float64: a bound that no sum
            of them ever exceeds. -inf elsewhere.
    """

    pays: Flags
    idle: Flags
    action: Ints
    ceiling: Floats


def find_loops(model: Model) -> Loops:
    """Find the loops of a model."""
    pays, action = np.zeros(model.size, bool), np.full(model.size, -1)
    ceiling = np.full(model.size, -np.inf)
    inner = model.allowed & ~model.leads_to(model.end)
    if not (inner & (model.reward >= 0)).any():
        return Loops(pays, pays, action, ceiling)
    label, inside = end_components(model, model.allowed)
    gains = (inside & (model.reward > 0)).any(axis=1)
    rising = np.unique(label[gains])
    idle_rows = inside & (model.reward == 0) & ~np.isin(label, rising)[:, None]
    by_label = np.argsort(label, kind="stable")
    bounds = np.searchsorted(label[by_label], np.stack([rising, rising + 1]))
    for begin, end in bounds.T:
        members = np.sort(by_label[begin:end])
        average = best_average(_part(model, members, inside))
        if average.gain > 0:
            pays[members], action[members] = True, average.policy
        elif average.gain == 0:
            idle_rows[members] = average.tight & (model.reward[members] == 0)
            ceiling[members] = _ceiling(_part(model, members, inside), average)
    idle_label, idle_inside = end_components(model, idle_rows)
    idle = idle_label >= 0
    action[idle] = idle_inside[idle].argmax(axis=1)
    return Loops(pays, idle, action, ceiling)


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
    """The best average reward of a component, or a positive one.

    Attributes:
        gain: the average reward per step; exactly 0 where it differs from 0 by rounding only.
        policy: an action for each state, `[n]`, that earns it.
        bias: how much more than the average a state gets before the robot is home, `[n]`.
        tight: the actions that lose nothing, `[n, actions]`.
    """

    gain: float
    policy: Ints
    bias: Floats
    tight: Flags


def best_average(model: Model) -> Average:
    """Return the best average reward of a component whose states can all get to each other.

    Howard's policy iteration: each round has a policy with a single closed class, in which
    either the average is higher than before, or it is the same and the ways to it are better. It
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
    """Return the policy, led from everywhere to its best closed class, and a state of that."""
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


def long_run(chain: Model, width: int) -> tuple[Floats, Flags]:
    """Return what going on for ever comes to, for each state of a chain.

    Returns:
        The sign of the average reward of a state's closed class, `[n]`, nan outside of them; and
        which states these are, `[n]`.

    Raises:
        NoTotalError: there is a class in which rewards cancel out.
    """
    average = class_averages(chain)
    closed = ~np.isnan(average)
    if not closed.any():
        return average, closed
    scale = float(np.abs(chain.reward[closed]).max())
    sign = np.where(np.abs(average) <= ZERO * scale, 0.0, np.sign(average))
    unclear = (sign == 0) & (chain.reward[:, 0] != 0)
    if unclear.any():
        raise no_total(chain, unclear, width)
    return sign, closed
