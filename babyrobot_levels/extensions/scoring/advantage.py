"""The expected positive advantage of a policy: how much better some of its actions are than it."""

from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.evaluation import action_values, chain_values
from babyrobot_levels.analysis.solver.horizon import after
from babyrobot_levels.analysis.solver.occupancy import visits_of
from babyrobot_levels.analysis.solver.policies import StateSpace, read_policy
from babyrobot_levels.analysis.solver.within import weights_by_step
from babyrobot_levels.mdp.tables import Floats


def mean_positive_advantage(
    space: StateSpace, policy: Any, discount: float, limit: int | None
) -> float:
    """Return the mean of the advantages of a policy's steps, those below 0 counted as 0.

    The advantage Q(s, a) - V(s) is that of the policy itself, and steps are those of its episodes:
    the sum over an episode is expected, and so is the number of steps, by which it is divided. It
    is 0 where all actions that the policy takes are equally good, and for any other policy above 0,
    as the mean of all advantages is 0.

    Args:
        space: the states of the level.
        policy: as `evaluate` takes it; it may depend on the step within a limit.
        discount: the factor by which each further reward counts less.
        limit: the number of steps after which episodes are truncated; None for no limit.

    Returns:
        The mean; nan without a limit if values or episodes are infinite.

    Raises:
        UndefinedReturnError: there is no discount and no limit, and rewards cancel out in a loop
            without end.
        EpisodeTooLongError: there are so many steps that this takes too long.
    """
    model = space.model()
    if limit is None:
        own = read_policy(policy, space)[model.states]
        chain = model.mixed(own)
        values = chain_values(chain, discount, space)
        visits = visits_of(chain, space.mdp.start[model.states], 1.0)
        with np.errstate(invalid="ignore"):
            gained = _gained(own, action_values(model, values, discount), values)
            return float(visits[visits > 0] @ gained[visits > 0] / visits.sum())
    weights = weights_by_step(policy, space, limit)
    sums = np.zeros((model.size, 3))  # values, positive advantages and steps from here on
    for same in reversed(weights.runs):
        own = weights(same.start)[model.states]
        chain = model.mixed(own)

        def step(ahead: Floats, own: Floats = own, chain: Any = chain) -> Floats:
            following = np.append(ahead[:, 1:], np.zeros((1, 2)), axis=0)[chain.next_state[:, 0]]
            more = np.einsum("so,sok->sk", chain.probability[:, 0], following)
            after_action = model.action_values(ahead[:, 0], discount)
            values = (own * after_action).sum(axis=1)
            return np.column_stack(
                [values, more[:, 0] + _gained(own, after_action, values), more[:, 1] + 1.0]
            )

        sums = after(step, sums, len(same), 3 * model.probability.size)
    _, total, steps = (space.at_start(model, column) for column in sums.T)
    return total / steps


def _gained(own: Floats, action_values: Floats, values: Floats) -> Floats:
    """Return the expected positive advantage of a step from each state, `[n]`."""
    advantages = np.maximum(action_values - values[:, None], 0.0)
    gained: Floats = np.where(own > 0, own * advantages, 0.0).sum(axis=1)
    return gained
