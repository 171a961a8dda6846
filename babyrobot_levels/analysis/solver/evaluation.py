"""What a given policy is worth, exactly."""

from __future__ import annotations

from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.errors import TooLongError
from babyrobot_levels.analysis.solver.graphs import attractor
from babyrobot_levels.analysis.solver.linear import expected_sums
from babyrobot_levels.analysis.solver.loops import long_run
from babyrobot_levels.analysis.solver.model import Flags, Floats, Model, build_model
from babyrobot_levels.analysis.solver.policies import Policy, read_policy
from babyrobot_levels.analysis.solver.results import Evaluation, check_actions, check_discount
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.tables import Mdp


def evaluate(
    level: Any, policy: Policy, discount: float | None = None, actions: str = "all"
) -> Evaluation:
    """Return what a policy is worth in a level, exactly.

    Without a discount the return is the total reward. It is inf from where the robot may come,
    with any probability, into a loop that pays for ever; else -inf from where it may come into
    one that costs for ever. A loop without end in which all rewards are 0 adds nothing.

    Args:
        level: a name, a path, a mapping or a `Level`.
        policy: `"random"` (evenly all actions that are possible where the robot stands),
            `"uniform"` (evenly all actions, also those that a wall refuses), an array of actions
            `[height, width]`, an array of probabilities `[height, width, actions]` or
            `[states, actions]`, a function `(x, y) -> action`, or a `Solution`. What it says of
            blocked cells, and of those where the episode is over, does not matter.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"all"`, or `"moves"` without stay.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has a value that it cannot have.
        NoTotalError: there is no discount, and rewards cancel out in a loop without end.
        TooLongError: there is no discount, and on average it takes more than 10^10 steps to end.
    """
    level = load(level)
    discount = check_discount(discount, level.discount)
    model, mdp = model_of(level, check_actions(actions)), level.compile()
    weights = read_policy(policy, mdp, actions)[model.states]
    chain = model.mixed(weights)
    values = chain_values(chain, discount, mdp.width)
    ahead = action_values(model, values, discount)
    cells, rows = on_the_grid(level, model, values, ahead)
    steps, success = episode(chain, mdp)
    return Evaluation(
        values=cells,
        action_values=rows,
        expected_return=at_start(values, model, mdp),
        expected_steps=steps,
        exit_probability=success,
        discount=discount,
        actions=actions,
    )


def model_of(level: Level, first_action: int) -> Model:
    """Return the model of a level."""
    exits = np.array([y * level.size[0] + x for x, y in level.exits], np.intp)
    return build_model(level.compile(), exits, first_action)


def chain_values(chain: Model, discount: float, width: int) -> Floats:
    """Return the values of a chain's states, `[n]`.

    Raises:
        NoTotalError: there is no discount, and rewards cancel out in a loop without end.
    """
    if discount < 1:
        return expected_sums(chain, chain.reward[:, 0], discount)
    sign, closed = long_run(chain, width)
    values = np.zeros(chain.size)
    values[~closed] = expected_sums(chain.restrict(~closed), chain.reward[~closed, 0], 1.0)
    for extreme in (-1, 1):
        values[_may_reach(chain, np.append(sign == extreme, False))] = extreme * np.inf
    return values


def action_values(model: Model, values: Floats, discount: float) -> Floats:
    """Return what actions are worth, `[n, actions]`, if states have values that may be infinite."""
    ahead = model.action_values(np.where(np.isinf(values), 0.0, values), discount)
    for extreme in (-np.inf, np.inf):
        ahead[model.leads_to(np.append(values == extreme, False))] = extreme
    return ahead


def episode(chain: Model, mdp: Mdp) -> tuple[float, float]:
    """Return how long a chain's episodes are expected to be, and how likely they reach an exit.

    Where that is too long for floating point, it is inf, and how likely is not known: nan.
    """
    ends = _may_reach(chain, chain.end)
    steps, success = np.zeros(chain.size), np.zeros(chain.size)
    columns = np.stack([np.ones(chain.size), chain.success[:, 0]], axis=1)[ends]
    try:
        steps[ends], success[ends] = expected_sums(chain.restrict(ends), columns, 1.0).T
    except TooLongError:
        return float("inf"), float("nan")
    steps[_may_reach(chain, np.append(~ends, False))] = np.inf
    return at_start(steps, chain, mdp), min(1.0, at_start(success, chain, mdp))


def _may_reach(chain: Model, goals: Flags) -> Flags:
    """Return from which states a chain may come to one of the goals (`[n + 1]`), `[n]`."""
    return attractor(chain, goals, chain.allowed)[0]


def at_start(values: Floats, model: Model, mdp: Mdp) -> float:
    """Return what is expected at the starts; inf wins over -inf."""
    chances = mdp.start[model.states]
    expected = values[chances > 0]
    if np.isposinf(expected).any():
        return float("inf")
    return float(chances[chances > 0] @ expected)


def on_the_grid(level: Level, model: Model, values: Floats, ahead: Floats) -> tuple[Floats, Floats]:
    """Return values and action values as arrays over the level's cells."""
    mdp = level.compile()
    shape = (mdp.height, mdp.width)
    blocked = level.grid().blocked.ravel()
    cells = np.where(blocked, np.nan, 0.0)
    rows = np.repeat(cells[:, None], ahead.shape[1], axis=1)
    cells[model.states], rows[model.states] = values, ahead
    return cells.reshape(shape), rows.reshape(*shape, -1)
