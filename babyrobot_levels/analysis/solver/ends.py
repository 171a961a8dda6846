"""How episodes of an optimal policy end: at an exit, and how often at best, or elsewhere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from babyrobot_levels.analysis.solver.linear import expected_sums
from babyrobot_levels.analysis.solver.model import Floats, Ints, attractor
from babyrobot_levels.analysis.solver.optimum import most_expected
from babyrobot_levels.analysis.solver.results import Solution
from babyrobot_levels.analysis.solver.space import space_of
from babyrobot_levels.mdp.graph import Graph
from babyrobot_levels.mdp.reachability import exit_states


@dataclass(frozen=True, eq=False)
class OtherEnds:
    """Outcomes by which an optimal policy may end an episode elsewhere than at an exit.

    Attributes:
        at: their states, actions and outcomes, the indices of the tables, `[n]` each.
        targets: the states to which they lead, `[n]`.
    """

    at: tuple[Ints, Ints, Ints]
    targets: Ints

    def __bool__(self) -> bool:
        return self.targets.size > 0


def other_ends(solution: Solution, start: int | None = None) -> OtherEnds:
    """Return by which outcomes the policy may end an episode elsewhere than at an exit.

    Args:
        solution: a solution for `actions="all"`, without a limit of steps.
        start: the state in which episodes begin; by default all starts.
    """
    assert solution.level is not None
    mdp, policy = solution.level.compile(), solution.policy.ravel()
    states = np.flatnonzero(policy >= 0)
    actions = policy[states]
    happens, targets = mdp.probability[states, actions] > 0, mdp.next_state[states, actions]
    ends = happens & mdp.terminal[states, actions]
    row, outcome = (happens & ~ends).nonzero()
    graph = Graph(mdp.num_states, states[row], targets[row, outcome])
    starts = np.flatnonzero(mdp.start) if start is None else [start]
    met = graph.distances(starts) >= 0
    elsewhere = ends & ~exit_states(solution.level, mdp)[targets] & met[states][:, None]
    row, outcome = elsewhere.nonzero()
    return OtherEnds((states[row], actions[row], outcome), targets[row, outcome])


def exit_chances(solution: Solution) -> tuple[Ints, Floats, Floats]:
    """Return how likely an exit is reached from each start: by the policy, and by the best one.

    Args:
        solution: a solution for `actions="all"`, without a limit of steps.

    Returns:
        The start states, and the probabilities, `[starts]` each.

    Raises:
        EpisodeTooLongError: on average it takes more than 10^10 steps to end.
    """
    assert solution.level is not None
    space = space_of(solution.level, "all")
    model = space.model()
    chain = model.under(solution.policy.ravel()[model.states])
    ends = attractor(chain, chain.end, chain.allowed)[0]
    own = np.zeros(model.size)
    own[ends] = expected_sums(chain.restrict(ends), chain.success[ends, 0], 1.0)
    best = most_expected(model, model.success, space)
    starts = space.mdp.start[model.states] > 0
    return model.states[starts], own[starts], best[starts]
