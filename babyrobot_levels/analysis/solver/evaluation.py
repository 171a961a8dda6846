"""The values of a given policy: exactly, from simulated episodes, and within a number of steps."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, overload

import numpy as np

from babyrobot_levels.analysis.solver.average import AverageEvaluation, evaluate_average, is_average
from babyrobot_levels.analysis.solver.horizon import worth_within
from babyrobot_levels.analysis.solver.linear import diverging_class, expected_sums, long_run
from babyrobot_levels.analysis.solver.model import Model, attractor
from babyrobot_levels.analysis.solver.policies import (
    Policy,
    StateSpace,
    looks_like_moves,
    read_policy,
    space_of,
)
from babyrobot_levels.analysis.solver.results import (
    EpisodeTooLongError,
    Evaluation,
    Simulation,
    check_count,
    check_discount,
    check_seed,
    check_within,
    probability,
)
from babyrobot_levels.analysis.solver.within import evaluate_within, weights_by_step
from babyrobot_levels.mdp.gridworld import GridWorld, world_of
from babyrobot_levels.mdp.tables import Flags, Floats, Ints
from babyrobot_levels.text.errors import warn
from babyrobot_levels.text.words import RANDOM

MAX_STEPS = 10_000
"""The limit of steps of simulated episodes in levels without a limit of their own."""


@overload
def evaluate(
    level: Any,
    policy: Policy,
    discount: float | None = ...,
    actions: str = ...,
    *,
    within: int | str | None = ...,
    criterion: Literal["return"] = ...,
) -> Evaluation: ...


@overload
def evaluate(
    level: Any, policy: Policy, *, actions: str = ..., criterion: Literal["average"]
) -> AverageEvaluation: ...


def evaluate(
    level: Any,
    policy: Policy,
    discount: float | None = None,
    actions: str = "all",
    *,
    within: int | str | None = None,
    criterion: str = "return",
) -> Evaluation | AverageEvaluation:
    """Return the values of a policy in a level, exactly.

    Without a discount the return is the total reward. It is inf from where the robot may reach,
    with any probability, a loop of positive reward; else -inf from where it may go on for ever at
    a cost. A loop without end in which all rewards are 0 adds nothing. If the expected return from
    the starts is infinite, a `RuntimeWarning` names the cells of such a loop.

    Args:
        level: a name, a path, a mapping or a `Level`.
        policy: `"random"` (evenly all actions that are possible where the robot stands),
            `"uniform"` (evenly all actions, also those that a wall refuses), an array of actions
            `[height, width]`, an array of probabilities `[height, width, actions]` or
            `[states, actions]`, a function `(x, y) -> action`, a `Solution` or a `Sweep`. Its
            entries for blocked and terminal cells are ignored. In a level with things, arrays are
            `[configurations, height, width]` and so on, and a function is called with the
            `Configuration` as well; with `actions="turns"`, arrays have an axis of the 4 headings
            (N, E, S, W) before height, and a function is called with the heading at last.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"all"`, `"moves"` without stay, or `"turns"` (left, right, forward): the actions
            of `"random"` and `"uniform"`, and how a policy's actions are numbered. Results of this
            package and the `policy` of one carry their own numbering.
        within: the number of steps after which episodes are truncated, or `"max_steps"` for the
            level's own limit; by default that of the policy, if it is a `Solution` within one,
            else none. Within a limit, a policy may also be an array with an axis of that many
            steps before all others.
        criterion: `"return"`; or `"average"`, the average reward of a step in the long run, as
            `solve` takes it: an `AverageEvaluation`.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has an invalid value.
        UndefinedReturnError: there is no discount, and rewards cancel out in a loop without end.
        EpisodeTooLongError: there is no discount, and on average it takes more than 10^10 steps to
            end; or the limit is so large that this takes too long.
    """
    if is_average(criterion, discount=discount, within=within):
        return evaluate_average(space_of(world_of(level), actions), policy)
    found = evaluation_of(level, policy, discount, actions, within)
    if found.explanation:
        message = f"with this policy, {found.explanation}"
        if actions == "all" and looks_like_moves(policy, found.values.ndim):
            message += "; if its action 0 is north, give actions='moves'"
        warn(message, RuntimeWarning)
    return found


def evaluation_of(
    level: Any,
    policy: Policy,
    discount: float | None = None,
    actions: str = "all",
    within: int | str | None = None,
) -> Evaluation:
    """Do what `evaluate` does, without a warning where the expected return is infinite."""
    level = world_of(level)
    discount = check_discount(discount, level.discount)
    space, limit = space_of(level, actions, discount), limit_of(within, policy, level)
    if limit is not None:
        return evaluate_within(space, policy, discount, limit)
    model = space.model()
    chain = model.mixed(read_policy(policy, space)[model.states])
    values = chain_values(chain, discount, space)
    expected = space.at_start(model, values)
    steps, success = episode(chain)
    diverging = diverging_states(chain, expected, space)
    return Evaluation(
        values=space.spread(model, values),
        action_values=space.spread(model, action_values(model, values, discount)),
        expected_return=expected,
        expected_steps=space.at_start(model, steps),
        exit_probability=probability(space.at_start(model, success)),
        discount=discount,
        actions=actions,
        diverging_cells=space.cells(diverging),
        diverging_condition=space.condition(diverging),
        level=level,
    )


def random_return(
    space: StateSpace,
    limit: int | None,
    discount: float,
    *,
    model: Model | None = None,
    quick: bool = False,
) -> float:
    """Return the expected return of the random policy, and find nothing else.

    Args:
        space: the level's states.
        limit: after how many steps episodes are truncated; None for never.
        discount: above 0 and at most 1.
        model: that of the space, if it is at hand.
        quick: with a limit, whether this may take a second at most; see `induction`.

    Raises:
        UndefinedReturnError, EpisodeTooLongError: as of `evaluate`.
    """
    weights = read_policy(RANDOM, space)
    if limit is not None:
        return float(worth_within([space], [limit], [discount], [weights], quick).returns[0])
    model = space.model() if model is None else model
    values = chain_values(model.mixed(weights[model.states]), discount, space)
    return space.at_start(model, values)


def limit_of(within: int | str | None, policy: Any, level: GridWorld) -> int | None:
    """Return the limit of steps that is asked for, or that of the policy; None for none."""
    return check_within(
        getattr(policy, "within", None) if within is None else within, level.max_steps
    )


def chain_values(chain: Model, discount: float, space: StateSpace) -> Floats:
    """Return the values of a chain's states, `[n]`.

    Raises:
        UndefinedReturnError: there is no discount, and rewards cancel out in a loop without end.
    """
    if discount < 1:
        return expected_sums(chain, chain.reward[:, 0], discount)
    sign, closed = long_run(chain, space)
    values = np.zeros(chain.size)
    values[~closed] = expected_sums(chain.restrict(~closed), chain.reward[~closed, 0], 1.0)
    for extreme in (-1, 1):
        values[_may_reach(chain, np.append(sign == extreme, False))] = extreme * np.inf
    return values


def diverging_states(chain: Model, expected_return: float, space: StateSpace) -> Ints:
    """Return the states of a loop that makes a chain's return infinite; none if it is finite."""
    if math.isfinite(expected_return):
        return chain.states[:0]
    starts = np.flatnonzero(space.mdp.start[chain.states] > 0)
    return chain.states[diverging_class(chain, starts, np.sign(expected_return))]


def action_values(model: Model, values: Floats, discount: float) -> Floats:
    """Return the action values, `[n, actions]`, for state values that may be infinite."""
    if np.isfinite(values).all():
        return model.action_values(values, discount)
    ahead = model.action_values(np.where(np.isinf(values), 0.0, values), discount)
    for extreme in (-np.inf, np.inf):
        ahead[model.leads_to(np.append(values == extreme, False))] = extreme
    return ahead


def episode(chain: Model, known: Floats | None = None) -> tuple[Floats, Floats]:
    """Return a chain's expected steps to the end, and its chances to reach an exit, `[n]` each.

    Where episodes are too long for floating point, steps are inf and chances nan.

    Args:
        chain: a model with one action.
        known: the steps, where they are known already: each state surely ends.
    """
    if known is not None:
        ending = np.where(chain.next_state == chain.size, chain.probability, 0.0).sum(axis=(1, 2))
        if np.array_equal(chain.success[:, 0], ending):
            return known, np.ones(chain.size)
        return known, expected_sums(chain, chain.success[:, 0], 1.0, known)
    ends = _may_reach(chain, chain.end)
    steps, success = np.zeros(chain.size), np.zeros(chain.size)
    columns = np.stack([np.ones(chain.size), chain.success[:, 0]], axis=1)[ends]
    try:
        steps[ends], success[ends] = expected_sums(chain.restrict(ends), columns, 1.0).T
    except EpisodeTooLongError:
        return np.full(chain.size, np.inf), np.full(chain.size, np.nan)
    steps[_may_reach(chain, np.append(~ends, False))] = np.inf
    return steps, success


def _may_reach(chain: Model, goals: Flags) -> Flags:
    """Return from which states a chain may come to one of the goals (`[n + 1]`), `[n]`."""
    return attractor(chain, goals, chain.allowed)[0]


# -- simulated episodes, and limits of steps -------------------------------------------------


def simulate(
    level: Any,
    policy: Policy,
    episodes: int = 1000,
    seed: int = 0,
    *,
    discount: float | None = None,
    within: int | str | None = None,
    actions: str = "all",
) -> Simulation:
    """Simulate episodes of a policy.

    The same arguments give the same episodes. They are not those of the environments, which draw
    from generators of their own.

    Args:
        level: a name, a path, a mapping or a `Level`.
        policy: as `evaluate` takes it.
        episodes: how many, at least 1.
        seed: what all chance is drawn from.
        discount: above 0 and at most 1; by default, the level's.
        within: the number of steps after which episodes are truncated, or `"max_steps"`. By
            default that of the policy, if it is a `Solution` within one, else the level's
            `max_steps`, or 10,000 where it has none.
        actions: `"all"`, `"moves"` without stay, or `"turns"`: turn left, turn right, forward.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has an invalid value.
    """
    level = world_of(level)
    discount = check_discount(discount, level.discount)
    limit = limit_of(within, policy, level) or level.max_steps or MAX_STEPS
    episodes = check_count("episodes", episodes)
    return simulated_episodes(
        space_of(level, actions, discount), policy, episodes, seed, discount=discount, limit=limit
    )


def simulated_episodes(
    space: StateSpace,
    policy: Policy,
    episodes: int,
    seed: int,
    *,
    discount: float,
    limit: int,
    most: float = math.inf,
) -> Simulation:
    """Simulate episodes of a policy, as `simulate` does.

    Raises:
        EpisodeTooLongError: they take more than so many steps together.
    """
    mdp, chain_at = space.mdp, chains(space, weights_by_step(policy, space, limit))
    rng = np.random.default_rng(check_seed(seed))
    state = rng.choice(mdp.num_states, size=episodes, p=mdp.start)
    returns, steps = np.zeros(episodes), np.zeros(episodes, np.int64)
    ended = np.zeros(episodes, bool)
    going = np.arange(episodes)
    factor, taken = 1.0, 0
    for step in range(limit):
        # A step of few episodes takes as long as one of some thousand.
        taken += max(going.size, 5000)
        if taken > most:
            raise EpisodeTooLongError("episodes take too many steps to be simulated")
        here, chain = state[going], chain_at(step)
        which = (rng.random(going.size)[:, None] >= chain.cumulated[here]).sum(axis=1)
        returns[going] += factor * chain.reward[here, which]
        steps[going] += 1
        state[going] = chain.next_state[here, which]
        ended[going] = chain.terminal[here, which]
        factor *= discount
        going = going[~ended[going]]
        if not going.size:
            break
    return Simulation(
        returns=returns,
        steps=steps,
        at_exit=space.exits[state] & ended,
        cut=~ended,
        max_steps=limit,
        discount=discount,
    )


def success_within(
    level: Any, policy: Policy, steps: int | None = None, *, actions: str = "all"
) -> float:
    """Return the exact probability of reaching an exit within a number of steps.

    Args:
        level: a name, a path, a mapping or a `Level`.
        policy: as `evaluate` takes it.
        steps: how many steps there are; by default those of the policy, if it is a `Solution`
            within a limit, else the level's `max_steps`.
        actions: `"all"`, `"moves"` without stay, or `"turns"`: turn left, turn right, forward.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has an invalid value, or neither `steps` nor `max_steps` of
            the level is given.
        EpisodeTooLongError: there are so many steps that this takes too long.
    """
    level = world_of(level)
    if steps is None:
        steps = getattr(policy, "within", None) or level.max_steps
    if steps is None:
        raise ValueError("give the number of steps; the level has no max_steps of its own")
    steps = check_count("steps", steps, 0)
    space = space_of(level, actions)
    weights = weights_by_step(policy, space, steps, "steps")
    return evaluate_within(space, weights, 1.0, steps).exit_probability if steps else 0.0


@dataclass(frozen=True, eq=False)
class Chain:
    """The outcomes of a policy's step from each state, `[states, outcomes]` each."""

    cumulated: Floats
    next_state: Ints
    reward: Floats
    terminal: Flags

    @cached_property
    def probability(self) -> Floats:
        """The probability of each outcome, `[states, outcomes]`."""
        return np.diff(self.cumulated, axis=1, prepend=0.0)


def chains(space: StateSpace, weights: Callable[[int], Floats]) -> Callable[[int], Chain]:
    """Return a function from a step to the chain of a policy that may depend on it."""
    last: tuple[Floats, Chain] | None = None

    def at(step: int) -> Chain:
        nonlocal last
        here = weights(step)
        if last is None or last[0] is not here:
            last = here, chain_of(space, here)
        return last[1]

    return at


def chain_of(space: StateSpace, weights: Floats) -> Chain:
    """Return the outcomes of steps with these probabilities of actions, the possible ones first."""
    first, mdp = space.first_action, space.mdp
    count = mdp.num_states
    probability = (weights[:, :, None] * mdp.probability[:, first:]).reshape(count, -1)
    order = np.argsort(probability == 0, axis=1, kind="stable")
    order = order[:, : int((probability > 0).sum(axis=1).max())]
    probability = np.take_along_axis(probability, order, axis=1)
    next_state = mdp.next_state[:, first:].reshape(count, -1)
    reward = mdp.reward[:, first:].reshape(count, -1)
    terminal = mdp.terminal[:, first:].reshape(count, -1)
    cumulated = np.cumsum(probability, axis=1)
    # Rounding must not leave a gap at the top: the last possible outcome takes what is left.
    last = np.maximum((probability > 0).sum(axis=1) - 1, 0)
    cumulated[np.arange(probability.shape[1]) >= last[:, None]] = 1.0
    return Chain(
        cumulated,
        np.take_along_axis(next_state, order, axis=1).astype(np.intp),
        np.take_along_axis(reward, order, axis=1),
        np.take_along_axis(terminal, order, axis=1),
    )
