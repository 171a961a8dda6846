"""How often a policy visits each state, exactly: until the end, or with a discount."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.linear import expected_visits
from babyrobot_levels.analysis.solver.model import Model, closed_classes
from babyrobot_levels.analysis.solver.policies import Policy, StateSpace, read_policy, space_of
from babyrobot_levels.analysis.solver.results import Result, check_discount
from babyrobot_levels.mdp.graph import Graph
from babyrobot_levels.mdp.gridworld import GridWorld, world_of
from babyrobot_levels.mdp.tables import Flags, Floats
from babyrobot_levels.registry.later import Shown, later

MAX_STATES = 4_000
"""The most states of a successor representation: 128 MB."""


@dataclass(frozen=True, eq=False)
class Occupancy(Shown, Result, public=True):
    """How often a policy visits cells and states. All arrays are read-only.

    Attributes:
        visits: the expected number of visits of each cell, float64 `[height, width]`, whatever is
            held there and wherever the robot looks. Pictures show it as `visits`.
        states: the same for each state, shaped as the `values` of an `Evaluation`. A visit is a
            step that begins there; one of a terminal state is the end of an episode there.
        steps: the expected number of steps: the sum over the states that are not terminal. inf
            without a discount, if an episode may go on for ever.
        discount: the factor by which the visit after each further step counts less.
        level: the level.
    """

    visits: Floats
    states: Floats
    steps: float
    discount: float
    level: GridWorld

    _html = later("babyrobot_levels.analysis.notebooks:occupancy_html")

    def __repr__(self) -> str:
        return f"<Occupancy steps={self.steps:.6g} discount={self.discount:g}>"


def occupancy(
    level: Any, policy: Policy, discount: float | None = None, actions: str = "all"
) -> Occupancy:
    """Return how often a policy visits each cell and state, on average over episodes.

    Episodes begin at the level's starts, and go on until the end: `max_steps` is ignored. Without
    a discount, states that may be visited again for ever have inf.

    Args:
        level: a name, a path, a mapping or a `Level`.
        policy: as `evaluate` takes it.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"all"`, `"moves"` without stay, or `"turns"`: turn left, turn right, forward.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has an invalid value.
        EpisodeTooLongError: there is no discount, and on average it takes more than 10^10 steps to
            end.
    """
    level = world_of(level)
    discount = check_discount(discount, level.discount)
    space = space_of(level, actions, discount)
    model, mdp = space.model(), space.mdp
    weights = read_policy(policy, space)
    chain = model.mixed(weights[model.states])
    begin, table = mdp.start[model.states], np.zeros(mdp.num_states)
    table[model.states] = visits_of(chain, begin, discount)
    _add_ends(table, space, weights, discount)
    table[space.without_value] = np.nan
    states = table.reshape(mdp.shape)
    cells = np.nansum(states.reshape(-1, *mdp.shape[-2:]), axis=0)
    steps = float(table[model.states].sum())
    return Occupancy(cells, states, steps, discount, level)


def visits_of(chain: Model, begin: Floats, discount: float) -> Floats:
    """Return the expected visits of each state of a chain, `[n]`."""
    reached = _reached(chain, begin)
    endless = reached & (closed_classes(chain) >= 0) & (discount == 1)
    visits, passing = np.where(endless, np.inf, 0.0), reached & ~endless
    visits[passing] = expected_visits(chain.restrict(passing), begin[passing], discount)
    return visits


def _reached(chain: Model, begin: Floats) -> Flags:
    """Return which states a chain may reach, `[n]`."""
    edges = np.flatnonzero(chain.probability > 0)
    source, target = edges // chain.probability.shape[2], chain.next_state.ravel()[edges]
    graph = Graph(chain.size + 1, source, target)
    return graph.distances(np.flatnonzero(begin).tolist())[:-1] >= 0


def _add_ends(table: Floats, space: StateSpace, weights: Floats, discount: float) -> None:
    """Add the ends of episodes to the visits of states."""
    mdp, first = space.mdp, space.first_action
    states = np.flatnonzero((table > 0) & np.isfinite(table) & ~mdp.is_terminal)
    chances = weights[states][:, :, None] * mdp.probability[states, first:]
    ends = chances * mdp.terminal[states, first:] * table[states, None, None] * discount
    where = mdp.next_state[states, first:]
    table += np.where(
        mdp.is_terminal, np.bincount(where.ravel(), ends.ravel(), mdp.num_states), 0.0
    )


def successor_representation(
    level: Any, policy: Policy, discount: float | None = None, actions: str = "all"
) -> Floats:
    """Return how often each state is visited from each state, float64 `[states, states]`.

    Row i has the discounted visits of an episode that goes on from state i, which itself counts as
    one; rows and columns are numbered as in the tables. Times the expected rewards of states, it
    gives the values of the policy.

    Args:
        level: a name, a path, a mapping or a `Level`, with at most 4,000 states.
        policy: as `evaluate` takes it.
        discount: above 0 and below 1; by default, the level's.
        actions: as for `occupancy`.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has an invalid value, or there are too many states.
    """
    level = world_of(level)
    discount = check_discount(discount, level.discount)
    space = space_of(level, actions, discount)
    mdp, model = space.mdp, space.model()
    if mdp.num_states > MAX_STATES:
        raise ValueError(f"a successor representation has at most {MAX_STATES:,} states")
    if discount == 1:
        raise ValueError("a successor representation needs a discount below 1, such as 0.99")
    chain = model.mixed(read_policy(policy, space)[model.states])
    size = model.size
    steps = np.zeros((size, size + 1))
    np.add.at(steps, (np.arange(size)[:, None], chain.next_state[:, 0]), chain.probability[:, 0])
    found = np.eye(mdp.num_states)
    found[np.ix_(model.states, model.states)] = np.linalg.inv(
        np.eye(size) - discount * steps[:, :size]
    )
    return found
