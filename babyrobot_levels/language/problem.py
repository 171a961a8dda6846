"""Faults that only the whole level shows, told by the way to the field that has them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Problem:
    """A fault of a level: its code, the route of keys to where it stands, and what to say."""

    code: str
    route: tuple[str | int, ...]
    message: str
    help: str | None = None
    key: bool = False
    """True where the field itself is the fault, and not its value."""
    mark: tuple[int, int, int] | None = None
    """In a drawing: line and character (from 0), and how many characters."""


class SpecProblems(ValueError):
    """The faults of one level, all of them, for whoever can point at them."""

    def __init__(self, problems: Iterable[Problem]):
        self.problems = tuple(problems)
        super().__init__("; ".join(problem.message for problem in self.problems))
