"""What makes a level hard: what exits need, what mistakes cost, and where something is decided."""

import math
from collections.abc import Collection, Mapping

import numpy as np

from babyrobot_levels.analysis.solver.evaluation import action_values, chain_values
from babyrobot_levels.analysis.solver.linear import MAX_SWEEPS
from babyrobot_levels.analysis.solver.optimum import MAX_ROUNDS, TOLERANCE, most_expected, solve
from babyrobot_levels.analysis.solver.policies import read_policy, space_of
from babyrobot_levels.analysis.solver.results import Solution
from babyrobot_levels.mdp.compiler.things import compile_things
from babyrobot_levels.mdp.graph import Graph
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.mdp.states import Reach, ends_by_hit, reach_of, transitions
from babyrobot_levels.mdp.tables import Flags, Floats, Mdp, leads_to
from babyrobot_levels.text.errors import LevelError

MISTAKES = 0.1
"""How often the player of `fragility` takes any action."""

ROUNDING = 1e-12
"""What differs by no more than this share of the largest value is the same for `fragility`."""

Needs = Mapping[str, frozenset[str]]
"""By the names of things that are needed: those of them that are needed to have it."""


def without_effect(level: GridWorld, names: Collection[str]) -> GridWorld:
    """Return a level in which some items cannot be taken, and some switches do not flip.

    Raises:
        LevelError: its tables would be too large.
    """
    other = level.model_copy()
    for name in ("_numbering", "_digest"):
        vars(other).pop(name, None)
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


def optimal_ends(solution: Solution) -> Flags:
    """Return what episodes of optimal policies come to, ties included, `[2, states]`.

    Number 0 are the states, and number 1 those at which a hit ends the episode.
    """
    assert solution.level is not None
    mdp = solution.level.compile()
    best = solution.greedy.reshape(mdp.num_states, -1) & ~mdp.is_terminal[:, None]
    states, actions, outcomes = ((mdp.probability > 0) & best[..., None]).nonzero()
    target = mdp.next_state[states, actions, outcomes]
    target += mdp.num_states * ends_by_hit(mdp)[states, actions, outcomes].astype(target.dtype)
    found = Graph(2 * mdp.num_states, states, target).distances(mdp.start.nonzero()[0]) >= 0
    optimal: Flags = found.reshape(2, -1)
    return optimal


def intended_states(solution: Solution) -> Flags:
    """Return which states optimal policies come to where the robot moves as intended, `[states]`.

    They are all of those that end soonest, and movers do whatever they can. Where none surely ends,
    they are all optimal policies.
    """
    assert solution.level is not None
    mdp = solution.level.compile()
    best = solution.fastest if math.isfinite(solution.expected_steps) else solution.greedy
    states, actions = best.reshape(mdp.num_states, -1).nonzero()
    actions += solution.first_action
    target, intended = mdp.next_state[states, actions], mdp.intended_next_state[states, actions]
    sent = intended >= mdp.num_states
    happens = leads_to(mdp, intended[:, None], target)
    happens &= mdp.probability[states, actions] > 0
    # By chance alone the robot may never get there.
    never = ~happens.any(axis=1) & ~sent
    source = np.concatenate([states[happens.nonzero()[0]], states[never]])
    ways = Graph(mdp.num_states, source, np.concatenate([target[happens], intended[never]]))
    found: Flags = ways.distances(mdp.start.nonzero()[0]) >= 0
    return found


def fewest_pushes(solution: Solution) -> float:
    """Return the fewest pushes of boxes that can be expected of those that end soonest.

    Args:
        solution: the solution of a level with boxes, for all actions; it surely ends.
    """
    assert solution.level is not None
    space = space_of(solution.level, "all")
    model = space.model()
    fastest = solution.fastest.reshape(space.mdp.num_states, -1)[model.states]
    costs = np.where(fastest, -_expected_pushes(solution.level)[model.states], -np.inf)
    return -space.at_start(model, most_expected(model, costs, space)) + 0.0


def _expected_pushes(level: GridWorld) -> Floats:
    """Return how likely each action pushes a box, `[states, actions]`."""
    mdp = level.compile()
    boxes = mdp.configurations[:, level.things().of_kind("box")]
    layout = np.unique(boxes, axis=0, return_inverse=True)[1].ravel()
    before = layout[np.arange(mdp.num_states) // mdp.cells]
    pushed = layout[mdp.next_state // mdp.cells] != before[:, None, None]
    return np.asarray((mdp.probability * pushed).sum(axis=2))


def _as_optimal(mdp: Mdp, optimal: Flags) -> tuple[Flags, Flags]:
    """Return which outcomes lead to what is optimal, and which elsewhere; see `optimal_ends`."""
    happens = (mdp.probability > 0) & ~mdp.is_terminal[:, None, None]
    leads = optimal[ends_by_hit(mdp).astype(int), mdp.next_state]
    return happens & leads, happens & ~leads


def lost_share(mdp: Mdp, optimal: Flags) -> float:
    """Return the share, of the states that occur, from which nothing optimal can be reached.

    Args:
        mdp: the tables of a level.
        optimal: what is optimal there, as `optimal_ends` has it.
    """
    paths = transitions(mdp)
    occurs = paths.distances(np.flatnonzero(mdp.start)) >= 0
    goals = optimal[0] | _as_optimal(mdp, optimal)[0].any(axis=(1, 2))
    lost = paths.reversed().distances(np.flatnonzero(goals)) < 0
    return int((occurs & lost).sum()) / int(occurs.sum())


def decisions_of(mdp: Mdp, optimal: Flags) -> int:
    """Return in how many optimal states a valid action may lead to what is not.

    Args:
        mdp: the tables of a level.
        optimal: what is optimal there, as `optimal_ends` has it.
    """
    leaves = _as_optimal(mdp, optimal)[1].any(axis=2) & (mdp.action_mask > 0)
    return int((leaves.any(axis=1) & optimal[0]).sum())


def loss_by_mistakes(solution: Solution) -> float:
    """Return how much less is expected of a player who errs than of the optimal policy.

    With probability `MISTAKES` the player takes any of the valid actions, each equally probable,
    and else an optimal one: of all optimal policies, it is the one that loses least. Policy
    iteration finds it, with sweeps of value iteration in between.

    Args:
        solution: the solution of a level, for all actions, with a finite return.

    Raises:
        UndefinedReturnError: rewards cancel out for ever after a mistake.
        EpisodeTooLongError: on average, the player takes more than 10^10 steps.
    """
    assert solution.level is not None
    space, discount = space_of(solution.level, "all"), solution.discount
    model = space.model()
    rows, values = np.arange(model.size), np.zeros(model.size)
    best = solution.greedy.reshape(space.mdp.num_states, -1)[model.states]
    at_random = MISTAKES * read_policy("random", space)[model.states]
    policy = solution.policy.ravel()[model.states]
    for _ in range(MAX_ROUNDS):
        weights = at_random.copy()
        weights[rows, policy] += 1 - MISTAKES
        values = risen = chain_values(model.mixed(weights), discount, space)
        finite, improved = np.isfinite(values), policy
        slack = ROUNDING * np.abs(values[finite]).max(initial=0.0)
        for _ in range(MAX_SWEEPS):
            ahead = action_values(model, risen, discount)
            optimal = np.where(best, ahead, -np.inf)
            better = optimal.max(axis=1) > optimal[rows, improved] + slack
            if not better.any():
                break
            improved = np.where(better, optimal.argmax(axis=1), improved)
            mistaken = (at_random * np.where(at_random > 0, ahead, 0.0)).sum(axis=1)
            risen = np.where(finite, (1 - MISTAKES) * optimal[rows, improved] + mistaken, values)
        if (improved == policy).all():
            break
        policy = improved
    return max(0.0, solution.expected_return - space.at_start(model, values))
