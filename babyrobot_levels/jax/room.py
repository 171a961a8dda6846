"""How much room levels take in tables, and whether others fit into it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import NamedTuple, Self


class Counts(NamedTuple):
    """How much a level has, or several together.

    Attributes:
        states: how many states.
        branches: how many stochastic rows: pairs of state and action with several outcomes.
        starts: how many states in which episodes start.
        configurations: how many configurations, if the observation has something for each.
    """

    states: int
    branches: int
    starts: int
    configurations: int


_NONE = Counts(0, 0, 0, 0)


@dataclass(frozen=True, slots=True)
class Room:
    """The size of tables, which compiled code depends on.

    Attributes:
        levels: how many levels there are.
        total: how much they have together.
        most: the most that one of them has.
        outcomes: the most outcomes of an action.
    """

    levels: int = 0
    total: Counts = _NONE
    most: Counts = _NONE
    outcomes: int = 1

    def and_level(self, counts: Counts, outcomes: int) -> Self:
        """Return the room for one more level."""
        return replace(
            self,
            levels=self.levels + 1,
            total=Counts(*map(sum, zip(self.total, counts, strict=True))),
            most=Counts(*map(max, self.most, counts)),
            outcomes=max(self.outcomes, outcomes),
        )

    def for_any(self, others: Iterable[tuple[Counts, int]]) -> Self:
        """Return the room for as many levels, each as large as the largest of these and others."""
        largest = self
        for counts, outcomes in others:
            largest = largest.and_level(counts, outcomes)
        total = Counts(*(self.levels * count for count in largest.most))
        return replace(self, total=total, most=largest.most, outcomes=largest.outcomes)

    def misfit(self, needed: Room) -> str | None:
        """Return why as many levels do not fit that need other room, None if they do."""
        for what, need, have in zip(_NAMES, needed.total, self.total, strict=True):
            if need > have:
                return f"they have {need:,} {what} together, and there is room for {have:,}"
        for what, need, have in zip(_NAMES, needed.most, self.most, strict=True):
            if need > have:
                return f"one of them has {need:,} {what}, and there is room for {have:,}"
        if needed.outcomes > self.outcomes:
            return (
                f"an action has {needed.outcomes} outcomes, and there is room for {self.outcomes}"
            )
        return None


_NAMES = ("states", "pairs of state and action with several outcomes", "starts", "configurations")
