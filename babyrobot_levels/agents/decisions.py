"""Decisions of plays: what they cost against the best ones, and what chance added, exactly."""

import math
from functools import lru_cache
from typing import NamedTuple

from babyrobot_levels.agents.plays import Play
from babyrobot_levels.analysis.solver.by_step import ValuesByStep
from babyrobot_levels.analysis.solver.policies import space_of
from babyrobot_levels.analysis.solver.results import EpisodeTooLongError, UndefinedReturnError
from babyrobot_levels.library.level import Level


class Decisions(NamedTuple):
    """An episode's return less the optimum, in two parts: `luck - regret`.

    Both are discounted sums over its steps. They are nan where the level has no optimum, or it
    takes too long to be found. Of an unfinished episode, `luck` includes what is still expected.

    Attributes:
        regret: what the actions lose against the best ones, by expected returns: 0 or more.
        luck: what chance added, by the start that it drew and by all outcomes.
    """

    regret: float
    luck: float


def decisions_of(play: Play) -> Decisions:
    """Return what the decisions of a valid play cost, by values within its time limit."""
    values = optimal_values(play.level, play.digest, play.action_set, play.max_steps, play.discount)
    if values is None:
        return Decisions(math.nan, math.nan)
    limit, factor, regret = play.max_steps or 0, 1.0, 0.0
    # Who chooses a start is compared with the optimum from there.
    luck = 0.0 if play.start == "chosen" else values.value(play.states[0], limit) - values.optimum
    for step, (action, reward) in enumerate(zip(play.actions, play.rewards, strict=True)):
        is_end = play.end == "terminated" and step == play.steps - 1
        after = None if is_end else play.states[step + 1]
        lost, added = values.graded(play.states[step], action, reward, after, limit - step)
        regret, luck, factor = regret + factor * lost, luck + factor * added, factor * play.discount
    return Decisions(regret, luck)


@lru_cache(maxsize=64)
def optimal_values(
    level: Level, digest: str, actions: str, limit: int | None, discount: float
) -> ValuesByStep | None:
    """Return what the decisions in a level are graded by; None where it has none, or too many."""
    try:
        return ValuesByStep(space_of(level, actions), limit, discount)
    except (EpisodeTooLongError, UndefinedReturnError):
        return None
