"""What makes a level hard: what exits need, what mistakes cost, and where something is decided."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from babyrobot_levels.analysis.solver.evaluation import chain_values
from babyrobot_levels.analysis.solver.optimum import TOLERANCE, solve
from babyrobot_levels.analysis.solver.policies import read_policy, space_of
from babyrobot_levels.analysis.solver.results import Solution
from babyrobot_levels.mdp.compiler.things import compile_things
from babyrobot_levels.mdp.graph import Graph
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.mdp.states import Reach, ends_by_hit, reach_of, transitions
from babyrobot_levels.mdp.tables import Flags, Mdp
from babyrobot_levels.text.errors import LevelError

MISTAKES = 0.1
"""How often the player of `fragility` takes any action."""

Needs = Mapping[str, frozenset[str]]
"""By the names of things that are needed: those of them that are needed to have it."""


def without_effect(level: GridWorld, names: Collection[str]) -> GridWorld:
    """Return a level in which some items cannot be taken, and some switches do not flip.

    Raises:
        LevelError: its tables would be too large.
    """
    other = level.model_copy()
    vars(other).pop("_digest", None)
    vars(other)["_mdp"] = compile_things(level, level.grid(), inert=names)
    return other


def needs_of(level: GridWorld) -> Needs:
    """Return the items and switches without whose effect some start has no path to an exit.

    From each start there is a path with them. Of these things, one is needed to have another, to
    hold or to flip it, if without its effect the other can be had from no start.

    Raises:
        LevelError: without the effect of one, the tables are too large.
    """
    doors = (name for door in level.doors for name in (*door.keys, *door.locks))
    had: dict[str, set[str]] = {}
    for name in sorted({*level.exit_keys, *doors}):
        mdp = without_effect(level, {name}).compile()
        reach = reach_of(level, mdp)
        if any(reach.to_exit[start] < 0 for start in np.flatnonzero(mdp.start).tolist()):
            had[name] = _had(level, mdp, reach)
    return {
        name: frozenset(other for other in had if other != name and name not in had[other])
        for name in had
    }


def _had(level: GridWorld, mdp: Mdp, reach: Reach) -> set[str]:
    """Return the names of the items and switches that can be held or flipped."""
    things, occurs = level.things(), np.array(reach.steps).reshape(-1, mdp.cells) >= 0
    values = mdp.configurations[occurs.any(axis=1)]
    return {
        name
        for name, (column, _) in things.needed.items()
        if not np.isin(values[:, column], things[column].begins).all()
    }


def longest_chain(needs: Needs) -> int:
    """Return how many things at most must be had one after the other.

    Whoever has a thing has had before what is needed for it: needs never go round in a circle.
    """
    length: dict[str, int] = {}
    # What needs more comes later: whatever a thing needs is needed by what needs the thing.
    for name in sorted(needs, key=lambda name: len(needs[name])):
        length[name] = 1 + max((length[other] for other in needs[name]), default=0)
    return max(length.values(), default=0)


def idle_things(solution: Solution) -> list[str]:
    """Return the items and switches that can be had, and without which the optimum is no lower.

    They are tried from last to first, and those without which it is no lower stay without effect:
    it is no lower without all of them.

    Args:
        solution: the solution of a level, with a finite return.
    """
    level, best = solution.level, solution.expected_return
    assert level is not None
    if not level.has_things:
        return []
    least = best - TOLERANCE * max(1.0, abs(best))
    mdp, idle = level.compile(), list[str]()
    had = _had(level, mdp, reach_of(level, mdp))
    for name in reversed(level.things().needed):
        if name in had:
            try:
                without = solve(without_effect(level, {*idle, name}), solution.discount)
            except (ArithmeticError, LevelError):
                continue
            if without.expected_return >= least:
                idle.append(name)
    return idle


# -- optimal policies, and mistakes ----------------------------------------------------------


def optimal_states(solution: Solution) -> Flags:
    """Return which states episodes of optimal policies come to, ties included, `[states]`."""
    assert solution.level is not None
    mdp = solution.level.compile()
    best = solution.greedy.reshape(mdp.num_states, -1) & ~mdp.is_terminal[:, None]
    happens = (mdp.probability > 0) & best[..., None] & ~ends_by_hit(mdp)
    states, actions, outcomes = happens.nonzero()
    ways = Graph(mdp.num_states, states, mdp.next_state[states, actions, outcomes])
    found: Flags = ways.distances(mdp.start.nonzero()[0]) >= 0
    return found


def lost_share(mdp: Mdp, optimal: Flags) -> float:
    """Return the share, of the states that occur, from which no path leads to an optimal one.

    Args:
        mdp: the tables of a level.
        optimal: its optimal states, `[states]`.
    """
    paths = transitions(mdp)
    occurs = paths.distances(np.flatnonzero(mdp.start)) >= 0
    lost = paths.reversed().distances(np.flatnonzero(optimal)) < 0
    return int((occurs & lost).sum()) / int(occurs.sum())


def decisions_of(mdp: Mdp, optimal: Flags) -> int:
    """Return in how many optimal states a valid action may lead elsewhere, or to a hit that ends.

    Args:
        mdp: the tables of a level.
        optimal: its optimal states, `[states]`.
    """
    leaves = (mdp.probability > 0) & (~optimal[mdp.next_state] | ends_by_hit(mdp))
    decides = ((mdp.action_mask > 0) & leaves.any(axis=2)).any(axis=1)
    return int((decides & optimal & ~mdp.is_terminal).sum())


def loss_by_mistakes(solution: Solution) -> float:
    """Return how much less is expected of a player who errs than of the optimal policy.

    With probability `MISTAKES` the player takes any of the valid actions, each equally probable.

    Args:
        solution: the solution of a level, for all actions, with a finite return.

    Raises:
        UndefinedReturnError: rewards cancel out for ever after a mistake.
        EpisodeTooLongError: on average, the player takes more than 10^10 steps.
    """
    assert solution.level is not None
    space = space_of(solution.level, "all")
    best, random = (read_policy(each, space) for each in (solution, "random"))
    weights = (1 - MISTAKES) * best + MISTAKES * random
    model = space.model()
    erring = chain_values(model.mixed(weights[model.states]), solution.discount, space)
    return solution.expected_return - space.at_start(model, erring)
