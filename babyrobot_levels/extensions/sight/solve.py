"""The optimum of one who does not see everything, in a level, or in one of several."""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.horizon import best_return_within
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.policies import StateSpace, space_of
from babyrobot_levels.analysis.solver.results import check_discount, check_within
from babyrobot_levels.envs.observations.base import Extent
from babyrobot_levels.envs.suite import extent_of
from babyrobot_levels.extensions.sight.model import PartialModel, build_model
from babyrobot_levels.extensions.sight.policy import SightPolicy
from babyrobot_levels.extensions.sight.search import FIRST_ROUND, Search
from babyrobot_levels.extensions.sight.sights import Sensor, sight_of
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.gridworld import check_one_robot
from babyrobot_levels.suites.suite import Suite, named_levels
from babyrobot_levels.text import budget

MOST_BELIEFS = 100_000
"""So many beliefs are explored unless another number is asked for."""

EXACT = 1e-9
"""Bounds that differ by no more than this share of the optimum, or of 1, are one value."""

Progress = Callable[[int, float, float], None]
"""Called with the number of beliefs and both bounds after each round."""


@dataclass(frozen=True, eq=False)
class SightSolution:
    """The optimum of an agent that has a sight and its memory, and knows the rules of the levels.

    Attributes:
        lower: what `policy` earns, and the optimum at least; -inf where none is known that ends.
        upper: the optimum at most.
        full: the optimum of one who sees everything, and knows in which level it is.
        sight: the sight.
        within: the number of steps after which an episode is truncated; None for no limit.
        beliefs: how many beliefs were explored.
        is_closed: whether these are all that can be reached.
    """

    __module__ = "babyrobot_levels.extensions.sight"

    lower: float
    upper: float
    full: float
    sight: str
    within: int | None
    beliefs: int
    is_closed: bool
    _search: Search = field(repr=False)

    @property
    def is_exact(self) -> bool:
        """Whether both bounds are the optimum, but for a part in 10^9."""
        return _gap(self.lower, self.upper) + self._rounding <= EXACT

    @property
    def gap(self) -> float:
        """The difference of the bounds, as a share of the upper one, or of 1."""
        return _gap(self.lower, self.upper)

    @property
    def cost(self) -> tuple[float, float]:
        """What sight is missed for: the optimum of full sight less this one, at least and most."""
        return _less(self.full, self.upper), _less(self.full, self.lower)

    @property
    def model(self) -> PartialModel:
        """The POMDP that was solved."""
        return self._search.model

    @property
    def _rounding(self) -> float:
        """By which share of the optimum, or of 1, the merging of beliefs changes it at most."""
        graph, found = self._search.graph, self._search.found
        if not graph.rounding:
            return 0.0
        values = self._search.bounds.upper
        spread = float(np.ptp(np.append(values[np.isfinite(values)], 0.0)))
        share = graph.rounding * float(found.visits.sum()) * spread
        return share / max(1.0, abs(self.upper))

    def policy(self, seed: int = 0) -> SightPolicy:
        """Return an agent that earns `lower`, as `brl.score` takes it.

        Args:
            seed: where it comes to a belief that was not explored, it may draw its actions.
        """
        search = self._search
        return SightPolicy(search.graph, search.bounds, search.found.actions, self.within, seed)

    def __repr__(self) -> str:
        value = f"{self.lower:.6g}" if self.is_exact else f"[{self.lower:.6g}, {self.upper:.6g}]"
        limit = "" if self.within is None else f" within={self.within}"
        return (
            f"<SightSolution expected_return={value} full={self.full:.6g} sight={self.sight!r}"
            f"{limit} beliefs={self.beliefs:,}>"
        )


def _gap(lower: float, upper: float) -> float:
    """Return the difference of bounds as a share of the upper one, or of 1."""
    if lower == upper:
        return 0.0
    difference = upper - lower
    return difference / max(1.0, abs(upper)) if math.isfinite(difference) else math.inf


def _less(more: float, less: float) -> float:
    """Return a difference that cannot be negative but by rounding; 0 for two infinities."""
    return 0.0 if more == less else max(0.0, more - less)


def solve_sight(
    levels: Any,
    sight: str | Sequence[str] | Sensor = "view",
    *,
    weights: Sequence[float] | None = None,
    discount: float | None = None,
    actions: str = "all",
    within: int | str | None = None,
    mask: bool = True,
    reward: bool = False,
    gap: float = 0.0,
    beliefs: int = MOST_BELIEFS,
    seconds: float | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> SightSolution:
    """Return the best expected return of any agent that has only some observations, and its memory.

    The agent knows the rules of the level, and where everything is but what chance decides. In one
    of several levels, it does not know in which it is, but how likely each is. What it is shown
    are the observation at reset and after each step, and the action mask, as agents with memory get
    them in `brl.score`; of the info, nothing else. An agent that takes rewards into account may
    know more: `reward` tells them. Worlds of text tell the rules, what is seen, what happened, and
    the reward.

    The result has two bounds. They are equal where all beliefs that the agent can come to are
    explored, or enough of them. Else they are closer the more beliefs are explored. Nothing depends
    on time but where `seconds` is given. Within a budget of work, as commands have it, the search
    ends with what is left of it.

    Args:
        levels: a level, several, a folder, a pack or a suite: names, paths, mappings, `Level`s.
        sight: an observation of environments, or a tuple of several; `"text-map"`, `"text-view"`
            or `"text-words"`, the sights of worlds of text; or a function that returns what is
            shown in a state of a level, `(level, state) -> value`, where equal values look the
            same.
        weights: how likely each level is; by default all are equally likely, or as their suite
            says.
        discount: above 0 and at most 1; by default, that of each level.
        actions: `"all"`, `"moves"` without stay, or `"turns"`: turn left, turn right, forward.
        within: the number of steps after which episodes are truncated, or `"max_steps"` for the
            limit that the levels share; None for no limit.
        mask: whether the agent gets the action mask with an observation of environments.
        reward: whether it is told the reward of each step.
        gap: the search stops when the bounds differ by no more than this share of the optimum,
            or of 1, such as 0.05.
        beliefs: how many beliefs are explored at most; fewer where memory does not suffice.
        seconds: after so many seconds the search stops; what it finds then depends on the machine.
        progress: called after each round with the number of beliefs and both bounds.
        options: those of the observation: `view_radius`, `see_through`, …

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid, or its maze has no seed yet.
        ValueError: another argument has a value that it cannot have.
        TooLargeError: the levels have too many states.
        UndefinedReturnError: there is no discount, and rewards cancel out in a loop without end.
        EpisodeTooLongError: there is no discount, and it takes too long to end; or there are too
            many states and steps.
    """
    begin = time.monotonic()
    if gap < 0 or beliefs < 0:
        raise ValueError(f"gap and beliefs must be at least 0, not {gap:g} and {beliefs}")
    members, shares, extent = _members(levels, weights, turns=actions == "turns")
    limit = _limit(members, within)
    chosen = sight_of(sight, extent, mask=mask, reward=reward, within=limit, **options)
    discounts = [check_discount(discount, level.discount) for level in members]
    for level in members:
        check_one_robot(level, "optima of a sight")
    spaces = [space_of(level, actions) for level in members]
    model = build_model(spaces, chosen, shares, discounts)
    full = _full(spaces, shares, discounts, limit)
    search = Search(model, limit)
    deadline = None if seconds is None else begin + seconds
    _run(search, gap, beliefs, deadline, progress)
    upper = min(search.found.upper, full)
    return SightSolution(
        lower=min(search.found.lower, upper),
        upper=upper,
        full=full,
        sight=chosen.name,
        within=limit,
        beliefs=search.graph.explored,
        is_closed=search.is_closed,
        _search=search,
    )


def _run(
    search: Search, gap: float, beliefs: int, deadline: float | None, progress: Progress | None
) -> None:
    while True:
        found, explored = search.found, search.graph.explored
        if progress is not None:
            progress(explored, found.lower, found.upper)
        late = deadline is not None and time.monotonic() >= deadline
        closed = search.is_closed or _gap(found.lower, found.upper) <= max(gap, EXACT / 10)
        work = _work(search)
        room = min(beliefs, budget.left() / work - explored) - explored
        if late or closed or room < 1 or search.is_full:
            return
        more = int(min(max(FIRST_ROUND, explored), room))
        budget.spend(work * (explored + more))
        # What is spent already is for all of the round, which is not left halfway.
        with budget.within(budget.UNLIMITED):
            search.advance(more, deadline)


def _work(search: Search) -> float:
    """Return about how many steps of work a round takes for each belief that is then explored."""
    graph = search.graph
    states = graph.numbers / len(graph)
    return 50_000 + 2_000 * states + 100 * search.model.num_actions * (search.within or 0)


def _members(
    levels: Any, weights: Sequence[float] | None, *, turns: bool
) -> tuple[list[Level], list[float], Extent]:
    """Return levels, how likely each is, and the extent of their observations.

    Raises:
        ValueError: there are none, or their weights are none.
    """
    named = named_levels(levels)
    if isinstance(named, Suite):
        members, extent = list(named), extent_of(named.bounds, turns=turns)
        likely = [weight for count, weight in named.groups for _ in range(count)]
    else:
        members = [load(level) for level in named]
        if not members:
            raise ValueError("there are no levels to solve")
        extent, likely = Extent.of(members, turns=turns), [1.0] * len(members)
    given = np.array(likely if weights is None else list(weights), float)
    if given.shape != (len(members),) or not (np.isfinite(given) & (given >= 0)).all():
        raise ValueError(f"weights must be {len(members)} numbers, none of them below 0")
    if not given.sum():
        raise ValueError("weights must not all be 0")
    return members, (given / given.sum()).tolist(), extent


def _limit(levels: Sequence[Level], within: int | str | None) -> int | None:
    """Return the limit of steps that levels share.

    Raises:
        ValueError: they have several.
    """
    limits = {check_within(within, level.max_steps) for level in levels}
    if len(limits) > 1:
        raise ValueError("the levels have several max_steps; give a number of steps")
    return limits.pop()


def _full(
    spaces: Sequence[StateSpace],
    shares: Sequence[float],
    discounts: Sequence[float],
    within: int | None,
) -> float:
    """Return the optimum of one who sees everything."""
    values = [
        share * _optimum(space, rate, within)
        for space, share, rate in zip(spaces, shares, discounts, strict=True)
        if share
    ]
    return math.inf if math.inf in values else math.fsum(values)


def _optimum(space: StateSpace, discount: float, within: int | None) -> float:
    level, actions = space.level, space.actions
    if within is None:
        return solve(level, discount, actions=actions).expected_return
    return best_return_within(level, within, actions=actions, discount=discount)


def sight_cost(
    level: Any, sight: str | Sequence[str] | Sensor = "view", **options: Any
) -> tuple[float, float]:
    """Return what full sight is worth: its optimum less that of a sight, at least and at most.

    Both are equal where `solve_sight` is exact. What one more cell of view is worth is the
    difference of the costs with `view_radius` and one more.

    Args:
        level: as `solve_sight` takes it.
        sight: the sight.
        options: the other arguments of `solve_sight`.
    """
    return solve_sight(level, sight, **options).cost
