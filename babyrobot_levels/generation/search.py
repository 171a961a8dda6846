"""The search for a level: candidates are drawn until one meets all conditions."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from babyrobot_levels.analysis.expectations import is_met, shown
from babyrobot_levels.generation.candidates import Candidate, Maker
from babyrobot_levels.language import ranges
from babyrobot_levels.language.expectations import decimals_in
from babyrobot_levels.language.metric_names import NEEDS, PUSHES, SEEN, SOLVED
from babyrobot_levels.language.ranges import CountRange, NumberRange, bounds
from babyrobot_levels.language.suite import SuiteFields
from babyrobot_levels.library.level import Level
from babyrobot_levels.text import budget
from babyrobot_levels.text.errors import BabyRobotError

MOST_TRIES, MOST_CELLS = 10_000, 10_000_000
"""Limits of the search for one level: candidates, and cells of all candidates together."""

FEWEST_TRIES = 100
MOST_SOLVED, MOST_STATES = 1_000, 4_000_000
"""Limits of candidates that are solved, and of the states of all of at least `FEWEST_TRIES`."""

_QUICK = ("path_length", "dead_ends")
_FIELDS = (*_QUICK, "detour", "difficulty")
"""The fields of a suite that are conditions; the quick ones are known before things are placed."""

_COUNTED = ("items", "doors", "switches", "movers")
"""The metrics that the fields of a level tell without its tables."""

_HARD = {*PUSHES, *SOLVED, *NEEDS, *SEEN}
"""The metrics for which a level has to be solved, or compiled several times."""


class UnsatisfiableError(BabyRobotError, public=True):
    """No level was found that meets all conditions.

    Attributes:
        condition: the field of the suite that was not met, or the metric: `expect success`.
        asked: what it asks for, such as `90..99`.
        reason: how close the candidates came.
        needs: by what factor width and height would have to grow for the condition to be met,
            None where another size does not help.
    """

    def __init__(self, condition: str, asked: str, reason: str, needs: float | None = None):
        self.condition, self.asked, self.reason, self.needs = condition, asked, reason, needs
        super().__init__(condition, asked, reason, needs)

    def __str__(self) -> str:
        return f"{self.condition} {self.asked}".rstrip() + f": {self.reason}"


@dataclass(frozen=True, slots=True)
class Found:
    """A level that meets all conditions, and the attempt that it was."""

    number: int
    attempt: int
    level: Level


@dataclass(slots=True)
class Condition:
    """A condition of a suite, and how the candidates met it.

    Attributes:
        metric: what is compared.
        stated: what it must be, as in `expect`.
        name: the field; with `expect` before it where it stands there.
    """

    metric: str
    stated: Any
    name: str
    asked_of: int = 0
    met: int = 0
    below: Any = None
    """The largest value that was too small."""
    above: Any = None
    """The smallest value that was too large."""

    @property
    def asked(self) -> str:
        """What it must be, in words."""
        if isinstance(self.stated, int | CountRange | NumberRange):
            return ranges.shown(self.stated)
        return shown(self.stated, self._decimals)

    @property
    def _decimals(self) -> int:
        is_figure = isinstance(self.stated, float)
        return decimals_in(None, self.metric, self.stated) if is_figure else 0

    def accepts(self, value: Any) -> bool:
        """Return whether a value meets the condition; remember the nearest one that does not."""
        self.asked_of += 1
        if is_met(self.metric, self.stated, value, self._decimals):
            self.met += 1
            return True
        if isinstance(value, int | float):
            least, most = bounds(self.stated)
            if least is not None and value < least:
                self.below = value if self.below is None else max(self.below, value)
            elif most is not None and value > most:
                self.above = value if self.above is None else min(self.above, value)
        return False

    def nearest(self, count: int) -> str:
        """Return how close a number of candidates came, none of which met the condition."""
        candidates = f"{count:,} candidates"
        if self.below is None and self.above is None:
            return f"none of {candidates} has {'these' if self.metric == 'needs' else 'one'}"
        if self.above is None:
            return f"the largest of {candidates} was {_text(self.below)}"
        if self.below is None:
            return f"the smallest of {candidates} was {_text(self.above)}"
        return f"the nearest of {candidates} were {_text(self.below)} and {_text(self.above)}"


@dataclass(slots=True)
class Tally:
    """The conditions of a suite, with counts of how often each was met."""

    suite: SuiteFields
    layouts: tuple[float, float]
    split: str | None
    promised: Mapping[str, Any]
    is_made_of_others: bool = False
    tries: int = 0
    playable: int = 0
    in_split: int = 0
    crowded: int = 0
    roomy: int = 0
    again: int = 0
    solved: int = 0
    states: int = 0
    conditions: dict[str, Condition] = field(default_factory=dict)
    """By their names."""
    counted: list[Condition] = field(default_factory=list)
    """Those on metrics for which no level is compiled."""
    easy: list[Condition] = field(default_factory=list)
    """Those on metrics for which no level is solved."""
    hard: list[Condition] = field(default_factory=list)

    def __post_init__(self) -> None:
        for name in _FIELDS:
            asked = getattr(self.suite, name)
            if name == "path_length" and self.suite.max_steps is not None:
                least, most = (0, None) if asked is None else bounds(asked)
                most = min(most or self.suite.max_steps, self.suite.max_steps)
                asked = CountRange(min=least, max=most)
            if asked is not None:
                self.conditions[name] = Condition(name, asked, name)
        stated = {} if self.suite.expect is None else self.suite.expect.stated
        for metric, value in {**self.promised, **stated}.items():
            name = f"expect {metric}"
            self.conditions[name] = Condition(metric, value, name)
        for name, condition in self.conditions.items():
            if name not in _FIELDS or name == "difficulty":
                metric = condition.metric
                part = self.hard if metric in _HARD else self.easy
                (self.counted if metric in _COUNTED else part).append(condition)

    def accepts(self, candidate: Candidate) -> bool:
        """Return whether a candidate meets all conditions."""
        self.tries += 1
        is_accepted = self._meets_all(candidate)
        self.states += candidate.states
        return is_accepted

    def _meets_all(self, candidate: Candidate) -> bool:
        least, most = self.layouts
        if not least <= candidate.layout < most:
            return False
        self.in_split += 1
        if not candidate.is_playable:
            return False
        self.playable += 1
        counted = [] if candidate.is_placed else self.counted
        if candidate.is_placed and not _meets(candidate, self.counted):
            return False
        # Both are evaluated, so that each is counted for itself.
        quick = [
            self.conditions[name].accepts(getattr(candidate, name))
            for name in _QUICK
            if name in self.conditions
        ]
        if not all(quick):
            return False
        if not candidate.has_room:
            self.crowded += 1
            return False
        detour = self.conditions.get("detour")
        if detour is not None and not detour.accepts(candidate.detour):
            return False
        longest = self.suite.max_steps
        if longest is not None and candidate.path_length + candidate.detour > longest:
            return False
        if not _meets(candidate, [*counted, *self.easy]):
            return False
        self.solved += len(self.hard) > 1 or not candidate.is_surely_won
        if not _meets(candidate, self.hard):
            return False
        if not candidate.needs_its_doors:
            self.crowded += 1
            return False
        self.roomy += 1
        return True

    @property
    def is_enough(self) -> bool:
        """Whether a limit of solved candidates, or of states, is reached."""
        is_large = self.states >= MOST_STATES and self.tries >= FEWEST_TRIES
        return is_large or self.solved >= MOST_SOLVED

    def error(self) -> UnsatisfiableError:
        """Return the error that no candidate met all conditions."""
        asked_for = [each for each in self.conditions.values() if each.asked_of]
        rarest = min(asked_for, key=lambda each: each.met, default=None)
        if rarest is not None and not rarest.met:
            is_early = rarest.name in _FIELDS and rarest.metric not in _HARD
            tries = self.tries if is_early else rarest.asked_of
            return UnsatisfiableError(
                rarest.name, rarest.asked, rarest.nearest(tries), self._growth(rarest)
            )
        if self.again:
            reason = (
                f"{self.again:,} of {self.tries:,} candidates met all conditions, but all of them "
                "are duplicates of earlier levels"
            )
            return UnsatisfiableError("count", str(self.suite.count), reason, 1.5)
        if not self.in_split:
            reason = f"none of {self.tries:,} candidates has a maze of this split"
            return UnsatisfiableError("splits", str(self.split), reason)
        if self.crowded and not self.roomy and self.is_made_of_others:
            reason = f"the tables of {self.crowded:,} of {self.tries:,} candidates are too large"
            return UnsatisfiableError("edits", "", reason)
        if self.crowded and not self.roomy:
            reason = (
                f"in none of {self.tries:,} candidates was there room for all keys, doors, coins "
                f"and guards{', and a way against the wind' * bool(bounds(self.suite.wind)[1])}"
            )
            return UnsatisfiableError(self._placed(), "", reason, 1.5)
        if rarest is None or not self.playable:
            if bounds(self.suite.boxes)[1]:
                reason = f"in none of {self.tries:,} candidates was there room to push all of them"
                return UnsatisfiableError("boxes", "", reason, 1.5)
            reason = (
                f"in all of {self.tries:,} candidates it is next to the start or cuts off cells"
            )
            return UnsatisfiableError("exit", self.suite.exit, reason)
        others = [each for each in asked_for if each is not rarest]
        met = [f"{rarest.met:,} of {self.tries:,} candidates met it"]
        met += [f"{each.met:,} met {each.name} {each.asked}" for each in others]
        return UnsatisfiableError(rarest.name, rarest.asked, ", ".join([*met, "none met all"]))

    def _placed(self) -> str:
        """Return the kind of thing of which most are asked for."""
        return max(
            ("keys", "coins", "guards", "wind"),
            key=lambda name: bounds(getattr(self.suite, name))[1],
        )

    def _growth(self, missed: Condition) -> float | None:
        """Return the factor by which levels would have to grow to meet a missed condition."""
        is_count = missed.metric not in (*_HARD, "reachable")
        if not is_count or missed.above is not None or not missed.below:
            return None
        # Lengths and counts grow with the area, and the longest path is a rare one.
        return 1.15 * math.sqrt(bounds(missed.stated)[0] / missed.below)


def find_level(
    maker: Maker, number: int, *, first: int = 0, is_new: Callable[[Level], bool] | None = None
) -> Found:
    """Return the first candidate for a level that meets all conditions.

    Args:
        maker: draws the candidates.
        number: the level's number.
        first: the first attempt.
        is_new: returns whether a level that meets all conditions is no duplicate.

    Raises:
        UnsatisfiableError: no candidate meets them, within the limits of the search.
        OverBudgetError: all candidates together take more work than may be done for one level.
    """
    layouts = maker.layouts(number)
    tally = Tally(
        maker.suite, layouts, maker.split(number), maker.promised, maker.is_made_of_others
    )
    budget.begin()
    for attempt in range(first, first + most_tries(maker.suite, layouts)):
        try:
            candidate = maker.draw(number, attempt)
            if tally.accepts(candidate):
                if is_new is None or is_new(candidate.level):
                    return Found(number, attempt, candidate.level)
                tally.again += 1
        except budget.OverBudgetError as error:
            if attempt == first:
                raise
            raise budget.OverBudgetError(f"{tally.error()}; {error}", error.help) from None
        if tally.is_enough:
            break
    raise tally.error()


def most_tries(suite: SuiteFields, layouts: tuple[float, float] = (0.0, 1.0)) -> int:
    """Return the limit of candidates: higher for a small split, lower for large levels."""
    width, height = suite.largest
    tries = min(MOST_TRIES, max(FEWEST_TRIES, MOST_CELLS // (width * height)))
    return int(tries / max(layouts[1] - layouts[0], 1e-3))


def _meets(candidate: Candidate, conditions: list[Condition]) -> bool:
    return all(each.accepts(candidate.value(each.metric)) for each in conditions)


def _text(value: float) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
