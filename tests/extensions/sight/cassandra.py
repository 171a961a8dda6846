"""A reader of Cassandra's format, by its specification, and what an agent can earn in such a file.

It reads what is written here and no more, and refuses what readers disagree on.
"""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass
from functools import cache

NUMBER = re.compile(r"-?\d+\.\d+")
"""At least one digit on both sides of the point, and no exponent."""


@dataclass(frozen=True, eq=False)
class File:
    """A file: tables by their indices."""

    discount: float
    states: int
    actions: int
    observations: int
    start: list[float]
    transitions: dict[tuple[int, int], list[tuple[int, float]]]
    observed: dict[tuple[int, int], int]
    rewards: dict[tuple[int, int], float]

    @cache  # noqa: B019  (a file lives as long as its test)
    def value(self, belief: frozenset[tuple[int, float]], steps: int) -> float:
        """Return the best expected return of so many steps from a belief."""
        if not steps:
            return 0.0
        return max(self.ahead(belief, action, steps) for action in range(self.actions))

    def ahead(self, belief: frozenset[tuple[int, float]], action: int, steps: int) -> float:
        """Return what an action earns, and what follows."""
        paid = 0.0
        parts: dict[int, dict[int, float]] = defaultdict(lambda: defaultdict(float))
        for state, weight in belief:
            paid += weight * self.rewards.get((action, state), 0.0)
            for after, chance in self.transitions[action, state]:
                parts[self.observed[action, after]][after] += weight * chance
        for part in parts.values():
            total = sum(part.values())
            following = frozenset((s, round(w / total, 12)) for s, w in part.items())
            paid += self.discount * total * self.value(following, steps - 1)
        return paid

    def within(self, steps: int) -> float:
        """Return the best expected return of so many steps."""
        return self.value(frozenset((s, p) for s, p in enumerate(self.start) if p), steps)


def number(text: str) -> float:
    """Return a number as all readers take it."""
    assert NUMBER.fullmatch(text), text
    return float(text)


def read(text: str) -> File:
    """Return a file."""
    assert text.isascii()
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    head, body = dict(line.split(": ", 1) for line in lines[:6]), lines[6:]
    assert [*head] == ["discount", "values", "states", "actions", "observations", "start"]
    assert head["values"] == "reward"
    assert [line[0] for line in body] == sorted((line[0] for line in body), key="TOR".index)
    transitions: dict[tuple[int, int], list[tuple[int, float]]] = defaultdict(list)
    observed: dict[tuple[int, int], int] = {}
    rewards: dict[tuple[int, int], float] = {}
    for line in body:
        kind, action, state, *places = re.split(": | : ", line)
        at = int(action), int(state)
        *rest, value = " ".join(places).split(" ")
        if kind == "T":
            (after,) = rest
            assert int(after) not in dict(transitions[at])
            transitions[at].append((int(after), number(value)))
        elif kind == "O":
            (seen,) = rest
            assert at not in observed
            assert value == "1.0"
            observed[at] = int(seen)
        else:
            assert rest == ["*", "*"]
            assert at not in rewards
            rewards[at] = number(value)
    found = File(
        number(head["discount"]),
        int(head["states"]),
        int(head["actions"]),
        int(head["observations"]),
        [number(each) for each in head["start"].split(" ")],
        transitions,
        observed,
        rewards,
    )
    assert len(found.start) == found.states
    assert len(transitions) == len(observed) == found.states * found.actions
    return found
