"""Whether the optimal policy reaches an exit, and how its episodes end instead."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from babyrobot_levels.analysis.solver.linear import expected_sums
from babyrobot_levels.analysis.solver.model import attractor, surely_ending
from babyrobot_levels.analysis.solver.occupancy import visits_of
from babyrobot_levels.analysis.solver.optimum import most_expected
from babyrobot_levels.analysis.solver.policies import StateSpace, space_of
from babyrobot_levels.analysis.solver.results import EpisodeTooLongError, Solution
from babyrobot_levels.language.geometry import show_cell
from babyrobot_levels.mdp.tables import Floats, Ints, hits_by_mover
from babyrobot_levels.render.words.phrases import counted, percent, reaching, with_limit

SURE = 1e-9
"""What differs from a sure event by no more is sure."""

MAX_FOLLOWED = 30_000_000
"""States times steps: within a limit, more are not followed."""

_STEP = 1_000
"""As how many states a step counts, however few there are."""


@dataclass(frozen=True, slots=True)
class Ending:
    """How episodes of an optimal policy end that do not end at an exit, most of all.

    Attributes:
        success: the probability that an exit is reached, below 1.
        share: the probability of the likeliest other ending.
        cell: the cell `(x, y)` in which episodes end so; None if they end by a hit, or go on.
        mover: the number of the mover whose hit ends them so; None if none does.
        reward: the expected reward of the step that ends them so; 0 if they go on.
        told: all of this in words: `reaches an exit in 82 % of the episodes; 18 % end at [3, 1]`.
        text: the same as a sentence that begins with the policy and the limit, if there is one.
    """

    success: float
    share: float
    cell: tuple[int, int] | None
    mover: int | None
    reward: float
    told: str
    text: str

    @property
    def goes_on(self) -> bool:
        """Whether such episodes go on for ever, or until the limit."""
        return self.cell is None and self.mover is None


def ending_of(solution: Solution, start: int | None = None) -> Ending | None:
    """Return how episodes of an optimal policy end instead of reaching an exit.

    Args:
        solution: the solution, for any actions, with or without a limit of steps.
        start: the state in which episodes begin; by default the level's starts.

    Returns:
        None if an exit is surely reached, if there is none, or if it takes too long to compute.
    """
    level = solution.level
    if level is None or not level.has_goal:
        return None
    if start is None and not solution.exit_probability < 1 - SURE:
        return None
    space = space_of(level, solution.actions)
    mdp, count = space.mdp, space.mdp.cells + len(level.movers) + 1
    table = _ways_to_end(space)
    shares, earned = np.zeros(count), np.zeros(count)
    try:
        for policy, visits in _followed(solution, space, start):
            states = np.flatnonzero((visits > 0) & np.isfinite(visits) & (policy >= 0))
            at = states, policy[states] + space.first_action
            weights, ways = visits[states, None] * mdp.probability[at], table[at]
            ends = ways >= 0
            shares += np.bincount(ways[ends], weights[ends], count)
            earned += np.bincount(ways[ends], (weights * mdp.reward[at])[ends], count)
    except EpisodeTooLongError:
        return None
    # The last number is that of the exits; what goes on takes its place.
    success = float(shares[-1])
    shares[-1], earned[-1] = 1 - shares.sum(), 0.0
    if success >= 1 - SURE:
        return None
    way = int(shares.argmax())
    share, other = float(shares[way]), way - mdp.cells
    cell = mdp.cell(way) if other < 0 else None
    mover = other if 0 <= other < len(level.movers) else None
    if cell is not None:
        how = f"end at {show_cell(cell)}"
    elif mover is not None:
        how = f"end by a hit of `{level.things().names[mover - len(level.movers)]}`"
    elif solution.within is None:
        how = "never end"
    else:
        how = f"are cut off after {counted(solution.within, 'step')}"
    rest = 1 - success - share
    told = (
        f"{reaching(level)} in {percent(success)} of the episodes; {percent(share)} {how}"
        f"{f', {percent(rest)} otherwise' if rest > SURE else ''}"
    )
    text = f"{with_limit('the optimal policy', solution.within, level.max_steps)} {told}"
    return Ending(success, share, cell, mover, float(earned[way]) / share, told, text)


def _ways_to_end(space: StateSpace) -> Ints:
    """Return by which way each outcome ends an episode, `[states, actions, outcomes]`.

    -1 if it does not; the number of a cell; then come hits, by the numbers of movers; then exits.
    """
    mdp, level = space.mdp, space.level
    how = np.where(mdp.terminal, mdp.next_state % mdp.cells, -1)
    if level.hit.ends:
        for number, hits in enumerate(hits_by_mover(level, mdp)):
            how[mdp.terminal & hits & (how < mdp.cells)] = mdp.cells + number
    how[mdp.terminal & space.exits[mdp.next_state]] = mdp.cells + len(level.movers)
    return how


def _followed(
    solution: Solution, space: StateSpace, start: int | None
) -> Iterator[tuple[Ints, Floats]]:
    """Yield the policy, and how often it visits each state, `[states]` each; by step in a limit.

    Raises:
        EpisodeTooLongError: episodes, or the limit, are too long.
    """
    mdp = space.mdp
    begin = mdp.start if start is None else np.eye(1, mdp.num_states, start)[0]
    if solution.policies is None:
        policy, model, visits = solution.policy.ravel(), space.model(), np.zeros(mdp.num_states)
        chain = model.under(policy[model.states])
        visits[model.states] = visits_of(chain, begin[model.states], 1.0)
        yield policy, visits
        return
    if len(solution.policies) * (mdp.num_states + _STEP) > MAX_FOLLOWED:
        raise EpisodeTooLongError
    for policy in solution.policies.reshape(len(solution.policies), -1):
        yield policy, begin
        states = np.flatnonzero((begin > 0) & (policy >= 0))
        at = states, policy[states] + space.first_action
        going = np.where(mdp.terminal[at], 0.0, begin[states, None] * mdp.probability[at])
        begin = np.bincount(mdp.next_state[at].ravel(), going.ravel(), mdp.num_states)


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
    starts = space.mdp.start[model.states] > 0
    best = surely_ending(model, model.allowed & (model.success == model.ending))[0].astype(
        np.float64
    )
    if not best[starts].all():
        best = most_expected(model, model.success, space)
    return model.states[starts], own[starts], best[starts]
