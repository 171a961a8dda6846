"""The search for a level: candidates are drawn until one meets all conditions."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from babyrobot_levels.generation.candidates import Candidate, Maker
from babyrobot_levels.language.ranges import bounds, shown
from babyrobot_levels.language.suite import SuiteFields
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.errors import BabyRobotError

MOST_TRIES, MOST_CELLS = 10_000, 10_000_000
"""Limits of the search for one level: candidates, and cells of all candidates together."""

FEWEST_TRIES = 100
MOST_SOLVED = 1_000
"""The largest number of candidates that are solved."""

TOLERANCE = 1e-9
"""By how much a probability that is 1 may differ from it."""

_SOLVED = ("difficulty", "success")
"""The conditions for which a level has to be solved."""

_CONDITIONS = ("path_length", "dead_ends", "detour", "difficulty")


class UnsatisfiableError(BabyRobotError):
    """No level was found that meets all conditions.

    Attributes:
        condition: the field of the suite that was not met.
        asked: what it asks for, such as `90..99`.
        reason: how close the candidates came.
        needs: by what factor width and height would have to grow for the condition to be met,
            None where another size does not help.
    """

    __module__ = "babyrobot_levels"

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
    """A condition of a suite, and how the candidates met it."""

    name: str
    asked: str
    least: float
    most: float | None
    asked_of: int = 0
    met: int = 0
    below: Any = None
    """The largest value that was too small."""
    above: Any = None
    """The smallest value that was too large."""

    def accepts(self, value: Any) -> bool:
        """Return whether a value meets the condition; remember the nearest one that does not."""
        self.asked_of += 1
        if value is None or math.isnan(value):
            return False
        if value < self.least:
            self.below = value if self.below is None else max(self.below, value)
            return False
        if self.most is not None and value > self.most:
            self.above = value if self.above is None else min(self.above, value)
            return False
        self.met += 1
        return True

    def nearest(self, count: int) -> str:
        """Return how close a number of candidates came, none of which met the condition."""
        candidates = f"{count:,} candidates"
        if self.below is None and self.above is None:
            return f"none of {candidates} has one"
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
    tries: int = 0
    playable: int = 0
    in_split: int = 0
    crowded: int = 0
    roomy: int = 0
    again: int = 0
    solved: int = 0
    conditions: dict[str, Condition] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in _CONDITIONS:
            asked = getattr(self.suite, name)
            least, most = (0, None) if asked is None else bounds(asked)
            if name == "path_length" and self.suite.max_steps is not None:
                most = min(most or self.suite.max_steps, self.suite.max_steps)
            if asked is not None or most is not None:
                words = f"..{most}" if asked is None else shown(asked)
                self.conditions[name] = Condition(name, words, least, most)
        self.conditions["success"] = Condition("success", "1", 1 - TOLERANCE, None)

    def accepts(self, candidate: Candidate) -> bool:
        """Return whether a candidate meets all conditions."""
        self.tries += 1
        least, most = self.layouts
        if not least <= candidate.layout < most:
            return False
        self.in_split += 1
        if not candidate.is_playable:
            return False
        self.playable += 1
        # Both are evaluated, so that each is counted for itself.
        quick = [
            self.conditions[name].accepts(getattr(candidate, name))
            for name in ("path_length", "dead_ends")
            if name in self.conditions
        ]
        if not all(quick):
            return False
        if not candidate.has_room:
            self.crowded += 1
            return False
        self.roomy += 1
        detour = self.conditions.get("detour")
        if detour is not None and not detour.accepts(candidate.detour):
            return False
        longest = self.suite.max_steps
        if longest is not None and candidate.path_length + candidate.detour > longest:
            return False
        hard = self.conditions.get("difficulty")
        is_plain = candidate.is_surely_won
        self.solved += hard is not None or not is_plain
        if not is_plain and not self.conditions["success"].accepts(candidate.success):
            return False
        return hard is None or hard.accepts(candidate.difficulty)

    @property
    def is_enough(self) -> bool:
        """Whether the limit of solved candidates is reached."""
        return self.solved >= MOST_SOLVED

    def error(self) -> UnsatisfiableError:
        """Return the error that no candidate met all conditions."""
        asked_for = [each for each in self.conditions.values() if each.asked_of]
        rarest = min(asked_for, key=lambda each: each.met, default=None)
        if rarest is not None and not rarest.met:
            tries = rarest.asked_of if rarest.name in _SOLVED else self.tries
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
        if self.crowded and not self.roomy:
            reason = (
                f"in none of {self.tries:,} candidates was there room for all keys, doors, coins "
                f"and guards{', and a way against the wind' * bool(bounds(self.suite.wind)[1])}"
            )
            return UnsatisfiableError(self._placed(), "", reason, 1.5)
        if rarest is None or not self.playable:
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
        if missed.name in _SOLVED or missed.above is not None or not missed.below:
            return None
        # Lengths and counts grow with the area, and the longest path is a rare one.
        return 1.15 * math.sqrt(missed.least / missed.below)


def find_level(
    maker: Maker,
    number: int,
    *,
    first: int = 0,
    is_new: Callable[[Level], bool] | None = None,
) -> Found:
    """Return the first candidate for a level that meets all conditions.

    Args:
        maker: draws the candidates.
        number: the level's number.
        first: the first attempt.
        is_new: returns whether a level that meets all conditions is no duplicate.

    Raises:
        UnsatisfiableError: no candidate meets them, within the limits of the search.
    """
    layouts = maker.layouts(number)
    tally = Tally(maker.suite, layouts, maker.split(number))
    for attempt in range(first, first + most_tries(maker.suite, layouts)):
        candidate = maker.draw(number, attempt)
        if tally.accepts(candidate):
            if is_new is None or is_new(candidate.level):
                return Found(number, attempt, candidate.level)
            tally.again += 1
        if tally.is_enough:
            break
    raise tally.error()


def most_tries(suite: SuiteFields, layouts: tuple[float, float] = (0.0, 1.0)) -> int:
    """Return the limit of candidates: higher for a small split, lower for large levels."""
    width, height = suite.largest
    tries = min(MOST_TRIES, max(FEWEST_TRIES, MOST_CELLS // (width * height)))
    return int(tries / max(layouts[1] - layouts[0], 1e-3))


def _text(value: float) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
