"""The optimum of the level that is edited: what it is, and what the last change made of it.

A level is solved as it changes if that is quick. Else the editor asks for it when nothing else is
to be done.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from functools import cached_property
from math import lcm, prod
from threading import Lock
from typing import TYPE_CHECKING, Any

from babyrobot_levels.analysis.guides import random_return, solution_guide
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import NUM_ACTIONS
from babyrobot_levels.mdp.numeric import NEEDS_NUMPY, is_numeric
from babyrobot_levels.render.page import MAX_STATES, Guide, page_data, without_panels
from babyrobot_levels.render.page_format import TooLargeError, rounded
from babyrobot_levels.render.words.phrases import with_limit
from babyrobot_levels.text.budget import OverBudgetError

if TYPE_CHECKING:
    from babyrobot_levels.analysis.solver.results import Evaluation, Solution
    from babyrobot_levels.mdp.states import Reach


BEST_AVERAGE = "Best average"

work_time = getattr(time, "thread_time", time.perf_counter)
"""The seconds that this thread has worked; in a browser, there is but one."""

BUDGET = 0.1
"""How long a gesture may wait for the optimum, in seconds."""

_USUAL_TIME = 5e-5
"""How long a state takes to be solved and shown, in seconds, before that was measured."""

_TIME_OF_STEP, _TIME_OF_STATE_AND_STEP = 1e-5, 3e-8
"""How long a step of the time limit takes, and what each state adds to that, in seconds."""

_LEAST_MEASURED = 200
"""The least number of states of a level whose time is measured."""

_SEEN, _SEEN_SHARE = 0.005, 0.01
"""A value is another one if it differs by this much, or by this share of the largest one."""

_MOST_NAMED = 3
"""How many cells a reason names."""


@dataclass(frozen=True, eq=False)
class Optimum:
    """A level with its solution.

    Attributes:
        level: the level.
        guide: its solution; None if it has none.
        reason: why it has none, or why its return is infinite; empty for neither.
        solution: the solution of which `guide` is a part; None if it has none.
        is_too_large: whether it is too large for a page, for that reason.
    """

    level: Level
    guide: Guide | None
    reason: str
    solution: Solution | None = None
    is_too_large: bool = False

    @cached_property
    def page(self) -> dict[str, Any]:
        """What a page knows about the level, with its values and optimal actions.

        Raises:
            TooLargeError: the level is too large for a page.
        """
        if self.is_too_large:
            raise TooLargeError(self.reason)
        return page_data(self.level, guide=self.guide)

    @cached_property
    def values(self) -> dict[Cell, float]:
        """The values of the cells, where episodes begin."""
        if self.guide is None:
            return {}
        from babyrobot_levels.mdp.states import initial_configuration

        level = self.level
        overlay = self.guide.overlay.at(initial_configuration(level) if level.has_things else None)
        return {
            (x, y): value
            for y, row in enumerate(overlay.values or ())
            for x, value in enumerate(row)
            if value is not None
        }

    @cached_property
    def random_return(self) -> float | None:
        """The expected return of random actions; None where there is none."""
        return random_return(self.level)


class Answers:
    """Solves one level after the other, as they are edited.

    Attributes:
        level: the level at hand; None before the first one. Its maze has a seed.
        optimum: its solution; None while it is not known.
        before: the solution that was known last of the levels before; None for none.
        reach: which of its states an episode can be in; None where that is not computed.
        unreachable: its cells `[x, y]` in which no episode can ever be.
        waits: whether it may have so many states that it is not even compiled yet.
    """

    def __init__(self) -> None:
        self.level: Level | None = None
        self.optimum: Optimum | None = None
        self.before: Optimum | None = None
        self.reach: Reach | None = None
        self.unreachable: list[list[int]] = []
        self.waits = False
        self._page: dict[str, Any] | None = None
        self._time_of_state = _USUAL_TIME
        self._is_first = True
        self._solving = Lock()

    def follow(self, level: Level) -> None:
        """Go on to another level, and solve it if that is quick."""
        self.before = self.optimum or self.before
        self.optimum = self._page = None
        self.level = level.with_maze_seed(0) if level.has_random_maze else level
        self.reach, self.unreachable = None, []
        self.waits = False
        if level.has_random_maze:
            reason = "each episode has another maze, so there is no single optimal policy"
            self.optimum = Optimum(self.level, None, reason)
            return
        if not is_numeric():
            self.optimum = Optimum(self.level, None, NEEDS_NUMPY)
            return
        self.waits = level.has_things and _states_about(level) > MAX_STATES
        if self.waits:
            return
        self._look(level)
        if self.optimum is not None:
            return
        seconds = level.compile().num_states * self._time_of_state + _time_within_limit(level)
        if seconds <= BUDGET:
            self.optimum = self._solved(level)

    def _look(self, level: Level) -> None:
        """Find where episodes of a level can be, unless another one takes its place."""
        from babyrobot_levels.mdp.states import reach_of

        reach, too_large = None, None
        try:
            without_panels(level)
            reach = reach_of(level, level.compile())
        except TooLargeError as error:
            too_large = Optimum(level, None, str(error), is_too_large=True)
        missed = [] if reach is None else unreachable(level, reach)
        if level is self.level:
            self.reach, self.unreachable, self.optimum = reach, missed, too_large
            self.waits = False

    def catch_up(self) -> None:
        """Solve the level at hand, however long that takes, unless another one takes its place."""
        with self._solving:
            level = self.level
            if level is not None and self.waits:
                self._look(level)
            if level is None or level is not self.level or self.optimum is not None:
                return
            optimum = self._solved(level)
            if level is self.level:
                self.optimum = optimum

    def _solved(self, level: Level) -> Optimum:
        began = work_time()
        optimum = solved(level)
        _ = optimum.page
        states = level.compile().num_states
        # Small levels tell nothing of larger ones, nor does what the first one loads.
        is_usual = states >= _LEAST_MEASURED and _time_within_limit(level) <= BUDGET
        if is_usual and not self._is_first:
            self._time_of_state = (self._time_of_state + (work_time() - began) / states) / 2
        self._is_first = False
        return optimum

    def page(self) -> dict[str, Any] | None:
        """Return what a page knows about the level at hand; None before the first one.

        Raises:
            TooLargeError: the level is too large for a page, or may be.
        """
        if self.waits:
            raise TooLargeError("this level may have very many states, and is drawn when you pause")
        if self.optimum is not None:
            return self.optimum.page
        if self._page is None and self.level is not None:
            self._page = page_data(self.level)
        return self._page

    def to_dict(self, *, is_valid: bool = True) -> dict[str, Any]:
        """Return what the editor tells of the optimum: nothing, unless the text is valid.

        The keys: `status` (`"done"`; `"pending"` while it is not known; `"none"` where there is
        none); `best`, the optimal expected return from the starts within `max_steps`, and
        `before`, that of the last level before that was solved (None where unknown or infinite);
        `best_text`, and `best_name`, what it is called; `changed`, the cells `[x, y]` whose value
        is another one than there; `reason`, why there is no return, or why it is infinite.
        """
        optimum = self.optimum
        if not is_valid or optimum is None or optimum.guide is None:
            is_pending = is_valid and optimum is None and self.level is not None
            status = "pending" if is_pending else "none"
            return {
                "status": status,
                "best": None,
                "best_text": "",
                "best_name": BEST_AVERAGE,
                "before": None,
                "changed": [],
                "reason": optimum.reason if is_valid and optimum is not None else "",
            }
        guide, before = optimum.guide, self.before.guide if self.before is not None else None
        best, limit = guide.expected_return, optimum.level.max_steps
        return {
            "status": "done",
            "best": finite(best),
            "best_text": "" if math.isnan(best) else rounded(best),
            "best_name": with_limit(BEST_AVERAGE, limit, limit),
            "before": finite(before.expected_return) if before is not None else None,
            "changed": [[*cell] for cell in self._changed()],
            "reason": optimum.reason,
        }

    def _changed(self) -> list[Cell]:
        """Return the cells whose value is another one than before."""
        if self.optimum is None or self.before is None:
            return []
        now, before = self.optimum.values, self.before.values
        if self.optimum.level.size != self.before.level.size:
            return []
        largest = max((abs(value) for value in now.values() if math.isfinite(value)), default=0.0)
        least = min(_SEEN, _SEEN_SHARE * largest)
        return [
            cell
            for cell, value in now.items()
            if value != before.get(cell, value) and not abs(value - before[cell]) < least
        ]


def _states_about(level: Level) -> int:
    """Return how many states a level has at most, if movers on paths go round together.

    With each robot but the first, a state has so many times the actions, and counts as many times.
    """
    things = level.things()
    rounds = [each.values for each in things if each.moves and each.entry.within is None]
    others = prod(things.radices) // prod(rounds)
    more: int = NUM_ACTIONS ** max(0, len(level.robots) - 1)
    return prod(level.size) * lcm(*rounds) * others * more


def _time_within_limit(level: Level) -> float:
    """Return about how long it takes to follow a policy up to the time limit, in seconds."""
    states = level.compile().num_states
    return (level.max_steps or 0) * (_TIME_OF_STEP + states * _TIME_OF_STATE_AND_STEP)


def solved(level: Level) -> Optimum:
    """Solve a level."""
    from babyrobot_levels.analysis.solver.optimum import solve

    try:
        solution = solve(level)
    except (ArithmeticError, OverBudgetError) as error:
        return Optimum(level, None, str(error))
    guide, reason = solution_guide(level, solution), endless(solution)
    if reason and level.max_steps is not None:
        reason = f"without the limit of steps, {reason}"
    if math.isnan(guide.expected_return):
        reason = f"what is earned within {level.max_steps:,} steps takes too long to compute"
    return Optimum(level, guide, reason, solution)


def unreachable(level: Level, reach: Reach) -> list[list[int]]:
    """Return the cells `[x, y]` in which no episode can ever be, but for blocked ones."""
    import numpy as np

    width, height = level.size
    steps = np.array(reach.steps).reshape(-1, height, width)
    missed = (steps < 0).all(axis=0) & ~level.grid().blocked
    cells: list[list[int]] = np.argwhere(missed)[:, ::-1].tolist()
    return cells


def endless(found: Evaluation) -> str:
    """Return why an expected return is infinite, as a sentence; empty if it is finite."""
    if math.isfinite(found.expected_return):
        return ""
    cells = found.diverging_cells
    named = ", ".join(f"[{x}, {y}]" for x, y in cells[:_MOST_NAMED])
    more = ", …" if len(cells) > _MOST_NAMED else ""
    sums = "rewards" if found.expected_return > 0 else "costs"
    return f"an episode may go on for ever around {named}{more}, where {sums} add up without bound"


def finite(number: float) -> float | None:
    """Return a number; None if it is infinite or undefined, which JSON has no word for."""
    return number if math.isfinite(number) else None
