"""The search for a level: tries, one after the other, until one meets all conditions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from babyrobot_levels.generate.candidates import Candidate, Maker
from babyrobot_levels.language.ranges import bounds, shown
from babyrobot_levels.language.suite import SuiteFields
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.errors import BabyRobotError

MOST_TRIES, MOST_CELLS = 10_000, 10_000_000
"""The search for one level ends after so many tries, or when so many cells were drawn."""

FEWEST_TRIES = 100
MOST_SOLVED = 1_000
"""How hard a level is takes long to tell: of so many levels at most."""

_EXTREMES = {
    "path_length": ("shortest", "longest"),
    "dead_ends": ("fewest", "most"),
    "difficulty": ("easiest", "hardest"),
}


class StarvedError(BabyRobotError):
    """No level was found that meets all conditions.

    Attributes:
        condition: the field of the suite that starves.
        asked: what it asks for, such as `90..99`.
        reason: how near the tries came.
    """

    def __init__(self, condition: str, asked: str, reason: str):
        self.condition, self.asked, self.reason = condition, asked, reason
        super().__init__(condition, asked, reason)

    def __str__(self) -> str:
        return f"{self.condition} {self.asked}: {self.reason}"


@dataclass(frozen=True, slots=True)
class Found:
    """A level that meets all conditions, and which try it was."""

    number: int
    attempt: int
    level: Level


@dataclass(slots=True)
class Condition:
    """What one field of a suite asks of levels, and what came of it."""

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
        """Tell whether a value is as asked for, and remember how near it is if not."""
        self.asked_of += 1
        if value is None:
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
        """Return how near so many tries came, none of which met the condition."""
        low, high = _EXTREMES[self.name]
        tries = f"{count:,} tries"
        if self.below is None and self.above is None:
            return f"none of {tries} has one"
        if self.above is None:
            return f"the {high} of {tries} had {_told(self.below)}"
        if self.below is None:
            return f"the {low} of {tries} had {_told(self.above)}"
        return f"the nearest of {tries} had {_told(self.below)} and {_told(self.above)}"


@dataclass(slots=True)
class Tally:
    """The conditions of a suite, and how often each was met."""

    suite: SuiteFields
    layouts: tuple[float, float]
    split: str | None
    tries: int = 0
    playable: int = 0
    in_split: int = 0
    again: int = 0
    conditions: dict[str, Condition] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in _EXTREMES:
            asked = getattr(self.suite, name)
            least, most = (0, None) if asked is None else bounds(asked)
            if name == "path_length" and self.suite.max_steps is not None:
                most = min(most or self.suite.max_steps, self.suite.max_steps)
            if asked is not None or most is not None:
                words = f"..{most}" if asked is None else shown(asked)
                self.conditions[name] = Condition(name, words, least, most)

    def accepts(self, candidate: Candidate) -> bool:
        """Tell whether a try meets all conditions."""
        self.tries += 1
        least, most = self.layouts
        if not least <= candidate.layout < most:
            return False
        self.in_split += 1
        if not candidate.is_playable:
            return False
        self.playable += 1
        # Both are looked at, so that each says for itself how often it is met.
        quick = [
            self.conditions[name].accepts(getattr(candidate, name))
            for name in ("path_length", "dead_ends")
            if name in self.conditions
        ]
        if not all(quick):
            return False
        hard = self.conditions.get("difficulty")
        return hard is None or hard.accepts(candidate.difficulty)

    @property
    def is_enough(self) -> bool:
        """Whether so many levels were solved that no more are."""
        hard = self.conditions.get("difficulty")
        return hard is not None and hard.asked_of >= MOST_SOLVED

    def error(self) -> StarvedError:
        """Return what is to be said if none was found."""
        asked_for = [each for each in self.conditions.values() if each.asked_of]
        rarest = min(asked_for, key=lambda each: each.met, default=None)
        if rarest is not None and not rarest.met:
            tries = rarest.asked_of if rarest.name == "difficulty" else self.tries
            return StarvedError(rarest.name, rarest.asked, rarest.nearest(tries))
        if self.again:
            reason = (
                f"{self.again:,} of {self.tries:,} tries met all conditions, and each of them was "
                "a game that is there already"
            )
            return StarvedError("count", str(self.suite.count), reason)
        if not self.in_split:
            reason = f"none of {self.tries:,} tries had a maze of this split"
            return StarvedError("splits", str(self.split), reason)
        if rarest is None or not self.playable:
            reason = f"in each of {self.tries:,} tries it is beside the start, or cuts off cells"
            return StarvedError("exit", self.suite.exit, reason)
        others = [each for each in asked_for if each is not rarest]
        met = [f"{rarest.met:,} of {self.tries:,} tries met it"]
        met += [f"{each.met:,} met {each.name} {each.asked}" for each in others]
        return StarvedError(rarest.name, rarest.asked, ", ".join([*met, "none met all"]))


def find_level(
    maker: Maker,
    number: int,
    *,
    first: int = 0,
    is_new: Callable[[Level], bool] | None = None,
) -> Found:
    """Return the first try at a level that meets all conditions.

    Args:
        maker: draws the tries.
        number: the level's number.
        first: the try to begin with.
        is_new: whether a level is wanted that meets all conditions.

    Raises:
        StarvedError: there is none among the tries that are made at most.
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
    """Return how many tries there are at most: more for a small split, fewer for large levels."""
    width, height = suite.largest
    tries = min(MOST_TRIES, max(FEWEST_TRIES, MOST_CELLS // (width * height)))
    return int(tries / max(layouts[1] - layouts[0], 1e-3))


def _told(value: float) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
