"""What the best policy of a level comes to, followed through the tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from babyrobot_levels.analysis.solver.errors import NoTotalError, TooLongError
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.mdp.graph import Graph

if TYPE_CHECKING:
    from babyrobot_levels.analysis.solver.results import Solution
    from babyrobot_levels.library.level import Level
    from babyrobot_levels.mdp.reachability import Reach
    from babyrobot_levels.mdp.tables import Mdp

MAX_SOLVED = 5_000
"""Levels of more cells are not solved: that could take seconds."""

MAX_WORK = 200_000_000
"""Cells times steps: so far the chance of arriving in time is followed."""


def best_of(level: Level) -> Solution | None:
    """Return the best that can be done, None where that has no value or takes too long to find."""
    if level.size[0] * level.size[1] > MAX_SOLVED:
        return None
    try:
        return solve(level)
    except (NoTotalError, TooLongError):
        return None


def surely_leaves(mdp: Mdp, discount: float) -> bool:
    """Tell whether rewards alone show that going on for ever is never better than to end.

    That is so if it costs without bound; or if each step costs the same, and the last one no more.
    """
    happens = (mdp.probability > 0) & ~mdp.over[:, None, None]
    ends = mdp.terminal & happens
    going_on, ending = mdp.reward[happens & ~ends], mdp.reward[ends]
    if not going_on.size:
        return True
    dearest, cheapest = going_on.min(), going_on.max()
    if cheapest < 0 and discount == 1:
        return True
    return bool(dearest == cheapest <= 0 and ending.min(initial=0.0) >= cheapest)


def lingering(mdp: Mdp, reach: Reach, solution: Solution) -> list[int]:
    """Return the states between which the best policy goes on for ever, though it could end.

    Where there are several such loops, they are those of one of them.
    """
    policy = solution.policy.ravel()
    states = np.flatnonzero(policy >= 0)
    happens = mdp.probability[states, policy[states]] > 0
    origins = np.repeat(states, happens.sum(axis=1))
    targets = mdp.next_state[states, policy[states]][happens]
    ways = Graph(mdp.num_states, origins, targets)
    back = ways.reversed()
    visited = ways.distances(mdp.start.nonzero()[0].tolist()).tolist()
    ending = back.distances(mdp.over.nonzero()[0].tolist()).tolist()
    stuck = [
        state
        for state in range(mdp.num_states)
        if visited[state] >= 0 > ending[state] and reach.to_end[state] >= 0
    ]
    # From a loop that the robot may leave for another one, on to that one.
    while stuck:
        loop = [s for s, steps in enumerate(ways.distances(stuck[:1]).tolist()) if steps >= 0]
        returns = back.distances(stuck[:1]).tolist()
        stuck = [state for state in loop if returns[state] < 0]
        if not stuck:
            return loop
    return []


def surely_in_time(level: Level, to_exit: list[int]) -> bool:
    """Tell whether costs alone show that the best policy fails in at most half of its episodes.

    Where each step costs something, the best policy takes no longer than it has cost to spend,
    which is what a way without chance costs. And no more than half of the episodes take twice the
    average (Markov's inequality).

    Args:
        level: the level; it has a limit of steps.
        to_exit: the fewest steps from each state to an exit.
    """
    mdp, limit = level.compile(), level.max_steps or 0
    happens = (mdp.probability > 0) & ~mdp.over[:, None, None]
    ends = mdp.terminal & happens
    cheapest = -mdp.reward[happens & ~ends].max(initial=-np.inf)
    if level.discount < 1 or cheapest <= 0 or mdp.over.sum() > len(level.exits):
        return False
    highest = float(mdp.reward[ends].max(initial=-np.inf))
    sure = happens.sum(axis=2) == 1
    # Cells out of which moves are sure, and those at which all is over.
    firm = (sure[:, 1:].any(axis=1) | mdp.over).tolist()
    is_sure = sure.tolist()
    following, rewards = mdp.next_state[:, :, 0].tolist(), mdp.reward[:, :, 0].tolist()
    for state in mdp.start.nonzero()[0].tolist():
        worth = 0.0
        while to_exit[state] > 0:
            nearer = (
                action
                for action, other in enumerate(following[state])
                if is_sure[state][action] and firm[other] and 0 <= to_exit[other] < to_exit[state]
            )
            action = next(nearer, None)
            if action is None:
                return False
            worth += rewards[state][action]
            state = following[state][action]
        if 2 * (1 + (highest - worth) / cheapest) > limit + 1:
            return False
    return True


def is_in_time(level: Level, solution: Solution, share: float) -> bool | None:
    """Tell whether the best policy reaches an exit within `max_steps`, as likely as `share`.

    Returns:
        None where there are too many steps to follow.
    """
    mdp, limit = level.compile(), level.max_steps or 0
    probability = solution.exit_probability
    # Of a time that is so long on average, no more than this share takes longer than the limit.
    if probability - solution.expected_steps / (limit + 1) >= share:
        return True
    policy = solution.policy.ravel()
    states = np.flatnonzero(policy >= 0)
    chances = mdp.probability[states, policy[states]]
    targets = mdp.next_state[states, policy[states]]
    exits = [y * mdp.width + x for x, y in level.exits]
    arrived = np.zeros(mdp.num_states)
    arrived[exits] = 1.0
    most = MAX_WORK // chances.size
    for _ in range(min(limit, most)):
        ahead = (chances * arrived[targets]).sum(axis=1)
        if (ahead == arrived[states]).all():
            return False
        arrived[states] = ahead
        if mdp.start @ arrived >= share:
            return True
    return None if limit > most else False
