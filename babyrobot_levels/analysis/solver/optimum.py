"""The best that can be done in a level, exactly.

With a discount: policy iteration. Without one, the structure of the level is looked at first: a
loop that pays makes values infinite, a loop that costs nothing is as good as stopping, and where
the end cannot be reached with probability one, costs have no end. Policy iteration does the rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.errors import no_total
from babyrobot_levels.analysis.solver.evaluation import (
    action_values,
    at_start,
    episode,
    model_of,
    on_the_grid,
)
from babyrobot_levels.analysis.solver.graphs import attractor, surely_ending
from babyrobot_levels.analysis.solver.iteration import in_good_time, iterate_policies, prefer_ending
from babyrobot_levels.analysis.solver.loops import find_loops
from babyrobot_levels.analysis.solver.model import Flags, Floats, Ints, Model
from babyrobot_levels.analysis.solver.results import Solution, check_actions, check_discount
from babyrobot_levels.library.catalogue import load

TOLERANCE = 1e-9
"""Actions whose values differ by no more than this share of the best one are all greedy."""


def solve(level: Any, discount: float | None = None, *, actions: str = "all") -> Solution:
    """Return the highest expected returns of a level and a policy that earns them, exactly.

    Without a discount the return is the total reward. It is inf from where the robot can come,
    with any probability, to a loop that pays for ever; else -inf from where, whatever it does, it
    may have to go on at a cost for ever. Going on for ever with rewards of 0 adds nothing.

    Args:
        level: a name, a path, a mapping or a `Level`.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"all"`, or `"moves"` without stay. Actions that a wall refuses can be taken too.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has a value that it cannot have.
        NoTotalError: there is no discount, and it may be best to stay in a loop without end in
            which rewards cancel out: +1, -1, +1, …, which has no total. Where ending is at least
            as good as whatever such a loop comes to, that is no matter.
        TooLongError: there is no discount, and on average it takes more than 10^10 steps to end.
    """
    level = load(level)
    discount = check_discount(discount, level.discount)
    model, mdp = model_of(level, check_actions(actions)), level.compile()
    found = _discounted(model, discount) if discount < 1 else _total(model, mdp.width)
    ahead = action_values(model, found.values, discount)
    best = ahead.max(axis=1, initial=-np.inf)
    greedy = np.zeros((mdp.num_states, ahead.shape[1]), bool)
    greedy[model.states] = _greedy(model, ahead, best)
    policy = np.full(mdp.num_states, -1)
    policy[model.states] = found.policy
    finite = np.isfinite(found.values)
    cells, rows = on_the_grid(level, model, found.values, ahead)
    steps, success = episode(model.under(found.policy), mdp)
    return Solution(
        values=cells,
        action_values=rows,
        expected_return=at_start(found.values, model, mdp),
        expected_steps=steps,
        exit_probability=success,
        discount=discount,
        actions=actions,
        greedy=greedy.reshape(mdp.height, mdp.width, -1),
        policy=policy.reshape(mdp.height, mdp.width),
        method="policy iteration",
        iterations=found.rounds,
        residual=float(np.abs(found.values[finite] - best[finite]).max(initial=0.0)),
    )


@dataclass(frozen=True, eq=False)
class _Optimum:
    values: Floats
    policy: Ints
    rounds: int


def _discounted(model: Model, discount: float) -> _Optimum:
    _, towards_end = attractor(model, model.end, model.allowed)
    policy = np.where(towards_end >= 0, towards_end, model.reward.argmax(axis=1))
    values, policy, rounds = iterate_policies(model, policy, discount)
    return _Optimum(values, prefer_ending(model, values, policy, discount), rounds)


def _total(model: Model, width: int) -> _Optimum:
    """Return the optimum without a discount."""
    loops = find_loops(model)
    unbounded, towards = attractor(model, np.append(loops.pays, False), model.allowed)
    policy = np.where(loops.pays, loops.action, towards)
    # No action of the others leads there: it would make them unbounded too.
    others = np.flatnonzero(~unbounded)
    rest = model.restrict(~unbounded).with_stops(loops.idle[others])
    sure, action, rows = surely_ending(rest, rest.allowed)
    core = rest.restrict(sure, rows)
    inside = others[sure]
    best_values, best, rounds = iterate_policies(core, in_good_time(core, action[sure]), 1.0)
    stop = model.reward.shape[1]
    # Where stopping is best, it means to stay in the loop; but who can end as well, should.
    is_stop = np.arange(core.reward.shape[1]) == stop
    going_on = core.with_rewards(np.where(is_stop, -np.inf, core.reward))
    best = prefer_ending(going_on, best_values, best, 1.0)
    policy[inside] = np.where(best == stop, loops.action[inside], best)
    # Elsewhere nothing helps. Perhaps it ends nevertheless.
    _, perhaps = attractor(rest, np.append(sure, True), rest.allowed)
    perhaps = np.where(perhaps >= 0, perhaps, rest.reward.argmax(axis=1))
    policy[others[~sure]] = perhaps[~sure]
    values = np.where(unbounded, np.inf, -np.inf)
    values[inside] = best_values
    unclear = values < loops.ceiling - TOLERANCE * np.maximum(1.0, np.abs(loops.ceiling))
    if unclear.any():
        raise no_total(model, unclear, width)
    return _Optimum(values, policy, rounds)


def _greedy(model: Model, ahead: Floats, best: Floats) -> Flags:
    """Return the actions that are as good as the best one, `[n, actions]`."""
    rewards = np.abs(model.reward).max(initial=0.0)
    size = np.where(np.isfinite(best), np.abs(best), 0.0)
    margin = TOLERANCE * np.maximum(size, min(1.0, rewards))
    return ahead >= (best - margin)[:, None]
