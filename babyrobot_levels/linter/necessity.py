"""What the optimum needs: the doors and needs without which the best policies are the same."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.things import Door
from babyrobot_levels.library.level import Level
from babyrobot_levels.linter.optimal_policy import solution_of
from babyrobot_levels.linter.variants import changed
from babyrobot_levels.mdp.graph import Graph
from babyrobot_levels.mdp.states import ends_by_hit
from babyrobot_levels.text.errors import LevelError

Entry = TypeVar("Entry")

MAX_STATES = 20_000
"""After variants with so many states together, no further one is solved."""

TOLERANCE = 1e-9
"""Optimal returns that differ by no more than this share are the same."""


class Optimum:
    """The best policies of a level from its starts on, and what they come to.

    Attributes:
        expected_return: the optimal return from the start.
        facts: arrays that describe all that can happen under best policies, and that are the same
            for another level if and only if it has the same best policies there.
    """

    def __init__(self, level: Level) -> None:
        """Solve a level.

        Raises:
            ArithmeticError: it has no optimum, none that is finite, or takes too long to solve.
            LevelError: its tables are too large.
        """
        solution, mdp = solution_of(level), level.compile()
        if solution is None or not np.isfinite(solution.expected_return):
            raise ArithmeticError
        self.expected_return = solution.expected_return
        best = solution.greedy.reshape(mdp.num_states, -1)
        taken = best & ~mdp.is_terminal[:, None]
        happens = (mdp.probability > 0) & taken[..., None]
        states, actions, outcomes = (happens & ~ends_by_hit(mdp)).nonzero()
        ways = Graph(mdp.num_states, states, mdp.next_state[states, actions, outcomes])
        reached = ways.distances(mdp.start.nonzero()[0]) >= 0
        rows = happens & reached[:, None, None]
        self.facts: list[NDArray[Any]] = []
        # Numbers of configurations may differ, so states are told by the values of things.
        for numbers in (np.flatnonzero(reached), mdp.next_state[rows]):
            self.facts += [mdp.configurations[numbers // mdp.cells], numbers % mdp.cells]
        self.facts += [best[reached], rows.sum(axis=2)[reached]]
        self.facts += [mdp.probability[rows], mdp.reward[rows], mdp.terminal[rows]]

    def equals(self, other: Optimum) -> bool:
        """Return whether another level has the same optimum and the same best policies."""
        one, two = self.expected_return, other.expected_return
        return abs(one - two) <= TOLERANCE * max(1.0, abs(one)) and all(
            map(np.array_equal, self.facts, other.facts)
        )


@dataclass(frozen=True, slots=True)
class Need:
    """A name in `needs` or `unless` of a door, or in `exit_needs`.

    Attributes:
        name: the name.
        door: the index of the door, None for `exit_needs`.
        field: `needs` or `unless`; of the exits, `exit_needs`.
        index: its place among the names.
    """

    name: str
    door: int | None
    field: str
    index: int

    def removed(self, doors: tuple[Door, ...], exit_needs: tuple[str, ...]) -> dict[str, Any]:
        """Return the fields of a level with such doors and needs that change without the name."""
        if self.door is None:
            return {"exit_needs": without(exit_needs, self.index)}
        door = doors[self.door]
        names = door.keys if self.field == "needs" else door.locks
        other = door.model_copy(update={self.field: without(names, self.index)})
        return {"doors": (*doors[: self.door], other, *doors[self.door + 1 :])}


class Necessity:
    """The needs and doors without which a level has the same optimum.

    They are checked from last to first, needs before doors, and one without effect counts as
    removed from then on: all of them can be removed together.

    Attributes:
        idle_needs: the needs without effect.
        idle_doors: the doors without effect, by index.
    """

    def __init__(self, level: Level, doors: Sequence[int], *, check_needs: bool) -> None:
        """Solve variants of a level, as long as there is time.

        Args:
            level: the level.
            doors: the doors to check, by index, with what they need.
            check_needs: whether needs are checked, too.
        """
        self.idle_needs: list[Need] = []
        self.idle_doors: list[int] = []
        self._level, self._left = level, MAX_STATES
        self._now: dict[str, Any] = {"doors": level.doors, "exit_needs": level.exit_keys}
        try:
            self._optimum = Optimum(level)
        except ArithmeticError:
            return
        for need in self._needs(doors) if check_needs else ():
            if self._is_idle(need.removed(**self._now)):
                self.idle_needs.append(need)
        for number in sorted(doors, reverse=True):
            # The others keep their numbers: a door that needs nothing is none.
            gone = level.doors[number].model_copy(update={"needs": (), "unless": ()})
            others = self._now["doors"]
            if self._is_idle({"doors": (*others[:number], gone, *others[number + 1 :])}):
                self.idle_doors.append(number)

    def _needs(self, doors: Sequence[int]) -> Iterator[Need]:
        """Yield the needs to check; the last one of a door is none of them."""
        for index in reversed(range(len(self._level.exit_keys))):
            yield Need(self._level.exit_keys[index], None, "exit_needs", index)
        for number in sorted(doors, reverse=True):
            door = self._level.doors[number]
            for field, names in (("unless", door.locks), ("needs", door.keys)):
                for index in reversed(range(len(names))):
                    now = self._now["doors"][number]
                    if len(now.keys) + len(now.locks) > 1:
                        yield Need(names[index], number, field, index)

    def _is_idle(self, fields: dict[str, Any]) -> bool:
        """Return whether the optimum is the same with other values for some fields.

        False where this is not proved. If it is, the fields keep these values.
        """
        if self._left < 0:
            return False
        try:
            variant = changed(self._level, **{**self._now, **fields})
            self._left -= variant.compile().num_states
            is_idle = self._optimum.equals(Optimum(variant))
        except (ArithmeticError, LevelError):
            return False
        if is_idle:
            self._now.update(fields)
        return is_idle


def without(entries: tuple[Entry, ...], number: int) -> tuple[Entry, ...]:
    """Return entries without one of them, by its index."""
    return (*entries[:number], *entries[number + 1 :])
