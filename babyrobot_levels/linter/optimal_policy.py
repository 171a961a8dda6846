"""The optimal policy of a level: whether it terminates, and whether it does so in time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.results import EpisodeTooLongError, UndefinedReturnError
from babyrobot_levels.mdp.graph import Graph
from babyrobot_levels.mdp.states import ends_by_hit, exit_states

if TYPE_CHECKING:
    from babyrobot_levels.analysis.solver.results import Solution
    from babyrobot_levels.library.level import Level
    from babyrobot_levels.mdp.states import Reach
    from babyrobot_levels.mdp.tables import Mdp

MAX_SOLVED = 5_000
"""Larger levels (in states) are not solved, because that could take seconds."""

MAX_WORK = 200_000_000
"""States times steps: the limit up to which the exit probability is computed step by step."""

_STEP = 2_000
"""As how many states a step counts, however few there are."""


def solution_of(level: Level) -> Solution | None:
    """Solve a level; return None if it has no optimal value or takes too long to solve."""
    if level.compile().num_states > MAX_SOLVED:
        return None
    try:
        return solve(level)
    except (UndefinedReturnError, EpisodeTooLongError):
        return None


def surely_terminates(mdp: Mdp, discount: float) -> bool:
    """Return whether rewards alone show that never terminating is never better than terminating.

    This holds if every step costs something and there is no discount, or if all steps cost the
    same and the last step costs no more than the others. False means unknown.
    """
    happens = (mdp.probability > 0) & ~mdp.is_terminal[:, None, None]
    ends = mdp.terminal & happens
    going_on, ending = mdp.reward[happens & ~ends], mdp.reward[ends]
    if not going_on.size:
        return True
    lowest, highest = going_on.min(), going_on.max()
    if highest < 0 and discount == 1:
        return True
    return bool(lowest == highest <= 0 and ending.min(initial=0.0) >= highest)


def endless_loop(mdp: Mdp, reach: Reach, solution: Solution) -> list[int]:
    """Return states in which the optimal policy loops forever although the episode could end.

    If there are several such loops, only one of them is returned.
    """
    policy = solution.policy.ravel()
    states = np.flatnonzero(policy >= 0)
    happens = mdp.probability[states, policy[states]] > 0
    hits = ends_by_hit(mdp)[states, policy[states]]
    goes_on = happens & ~hits
    origins = np.repeat(states, goes_on.sum(axis=1))
    targets = mdp.next_state[states, policy[states]][goes_on]
    ways = Graph(mdp.num_states, origins, targets)
    back = ways.reversed()
    visited = ways.distances(mdp.start.nonzero()[0].tolist()).tolist()
    is_last = mdp.is_terminal.copy()
    is_last[states[hits.any(axis=1)]] = True
    ending = back.distances(is_last.nonzero()[0].tolist()).tolist()
    stuck = [
        state
        for state in range(mdp.num_states)
        if visited[state] >= 0 > ending[state] and reach.to_end[state] >= 0
    ]
    # If the policy can leave a loop for another one, continue there.
    while stuck:
        loop = [s for s, steps in enumerate(ways.distances(stuck[:1]).tolist()) if steps >= 0]
        returns = back.distances(stuck[:1]).tolist()
        stuck = [state for state in loop if returns[state] < 0]
        if not stuck:
            return loop
    return []


def surely_within_limit(level: Level, to_exit: list[int]) -> bool:
    """Return whether costs alone show that the optimal policy succeeds in half of the episodes.

    If every step has a cost, the optimal policy takes no more steps than a deterministic path
    costs, divided by the lowest cost of a step. By Markov's inequality, at most half of the
    episodes take twice the expected number of steps. False means unknown.

    Args:
        level: the level, which has `max_steps`.
        to_exit: the minimum number of steps from each state to an exit.
    """
    mdp, limit = level.compile(), level.max_steps or 0
    happens = (mdp.probability > 0) & ~mdp.is_terminal[:, None, None]
    ends = mdp.terminal & happens
    lowest_cost = -mdp.reward[happens & ~ends].max(initial=-np.inf)
    if level.has_things:
        return False
    if level.discount < 1 or lowest_cost <= 0 or mdp.is_terminal.sum() > len(level.exits):
        return False
    highest = float(mdp.reward[ends].max(initial=-np.inf))
    sure = happens.sum(axis=2) == 1
    # Cells that some action leaves deterministically, and terminal cells.
    firm = (sure[:, 1:].any(axis=1) | mdp.is_terminal).tolist()
    is_sure = sure.tolist()
    following, rewards = mdp.next_state[:, :, 0].tolist(), mdp.reward[:, :, 0].tolist()
    for state in mdp.start.nonzero()[0].tolist():
        value = 0.0
        while to_exit[state] > 0:
            nearer = (
                action
                for action, other in enumerate(following[state])
                if is_sure[state][action] and firm[other] and 0 <= to_exit[other] < to_exit[state]
            )
            action = next(nearer, None)
            if action is None:
                return False
            value += rewards[state][action]
            state = following[state][action]
        if 2 * (1 + (highest - value) / lowest_cost) > limit + 1:
            return False
    return True


def is_within_limit(level: Level, solution: Solution, share: float) -> bool | None:
    """Return whether the optimal policy reaches an exit in `max_steps` with a probability.

    Args:
        level: the level, which has `max_steps`.
        solution: its solution.
        share: the probability.

    Returns:
        None if there are too many steps to compute.
    """
    mdp, limit = level.compile(), level.max_steps or 0
    probability = solution.exit_probability
    # Markov's inequality bounds the share of episodes that take longer than the limit.
    if probability - solution.expected_steps / (limit + 1) >= share:
        return True
    policy = solution.policy.ravel()
    states = np.flatnonzero(policy >= 0)
    chances = mdp.probability[states, policy[states]]
    targets = mdp.next_state[states, policy[states]]
    chances = np.where(ends_by_hit(mdp)[states, policy[states]], 0.0, chances)
    arrived = exit_states(level, mdp).astype(np.float64)
    most = MAX_WORK // (chances.size + _STEP)
    for _ in range(min(limit, most)):
        ahead = (chances * arrived[targets]).sum(axis=1)
        if (ahead == arrived[states]).all():
            return False
        arrived[states] = ahead
        if mdp.start @ arrived >= share:
            return True
    return None if limit > most else False
