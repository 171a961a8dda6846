"""Levels that come and go while robots walk: in which slot of the tables each of them stands."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.envs.engine.slots import Room, Span, empty_tables, needed, write_level
from babyrobot_levels.envs.engine.tables import outcomes_of

if TYPE_CHECKING:
    from babyrobot_levels.envs.engine.tables import Ints, Outcomes, Tables
    from babyrobot_levels.envs.vector.families import Family
    from babyrobot_levels.envs.vector.observations import BatchObserver
    from babyrobot_levels.library.level import Level

KEPT_STATES = 2**19
"""Levels that may come again are kept as long as they have no more states than this together."""


class Slots:
    """Tables with a slot for each level that is played, and for the last ones that were.

    A level that is still there costs nothing when it comes again. Another one takes the slot that
    nobody plays in and that was longest not asked for.

    Attributes:
        family: where levels come from.
        tables: the tables; when they have to grow, these are new ones.
        levels: the level in each slot, None where none is.
        numbers: int64 `[slots]`: what number each of them has in the family.
    """

    tables: Tables

    def __init__(
        self,
        family: Family,
        num_robots: int,
        first_action: int,
        limit: int,
        observer: BatchObserver,
    ) -> None:
        """Put the level of number 0 into slot 0.

        Args:
            family: where levels come from.
            num_robots: how many robots there are; there are at least as many slots.
            first_action: the action that becomes number 0.
            limit: after how many steps episodes are cut off.
            observer: what shows the levels; it is told of each.
        """
        self.family, self._observer = family, observer
        self._first_action, self._limit = first_action, limit
        states = family.largest[0] * family.largest[1]
        self._most = max(num_robots, min(family.kept, KEPT_STATES // states))
        self._slot_of: dict[int, int] = {}
        self.levels: list[Level | None] = []
        self.numbers = np.empty(0, np.int64)
        self._asked_at, self._clock = np.empty(0, np.int64), 0
        first = family.level(0)
        self._room = Room(0, states, int(np.count_nonzero(first.compile().start)))
        self.place(np.zeros(1, np.intp), np.zeros(1, np.intp), np.zeros(1, np.int64), {0: first})

    def levels_of(self, numbers: Iterable[int]) -> dict[int, Level]:
        """Return the levels of numbers. Those that are not there are made, but not placed."""
        found = {}
        for number in dict.fromkeys(numbers):
            slot = self._slot_of.get(number)
            here = None if slot is None else self.levels[slot]
            found[number] = here or self.family.level(number)
        return found

    def place(
        self, level: Ints, which: Ints, numbers: NDArray[np.int64], levels: Mapping[int, Level]
    ) -> list[Span] | None:
        """Have robots play levels.

        Args:
            level: intp `[robots]`: the slot in which each robot plays; written into.
            which: the robots that go to another level.
            numbers: the number of the level of each of them.
            levels: what `levels_of` returned for these.

        Returns:
            The parts of the tables that were written into; None if the tables are new ones.
        """
        self._clock += 1
        new = {
            number: outcomes_of(made.compile(), self._first_action, 0)
            for number, made in levels.items()
            if number not in self._slot_of
        }
        is_grown = self._make_room(new)
        spans = []
        if new:
            others = np.delete(level, which)
            staying = [self._slot_of[number] for number in levels if number not in new]
            for slot, number in zip(self._free(others, staying), new, strict=False):
                spans.append(self._write(slot, number, levels[number], new[number]))
        level[which] = [self._slot_of[number] for number in numbers.tolist()]
        self._asked_at[level[which]] = self._clock
        return None if is_grown else spans

    def _free(self, *busy: Any) -> list[int]:
        """Return the slots that are not among these, the one longest not asked for first."""
        is_free = np.ones(self._room.slots, np.bool_)
        for slots in busy:
            is_free[slots] = False
        free = is_free.nonzero()[0]
        found: list[int] = free[np.argsort(self._asked_at[free], kind="stable")].tolist()
        return found

    def _write(self, slot: int, number: int, level: Level, outcomes: Outcomes) -> Span:
        """Put a level into a slot, in the place of the one that was there."""
        if self.levels[slot] is not None:
            self._slot_of.pop(int(self.numbers[slot]), None)
        self._slot_of[number] = slot
        self.levels[slot], self.numbers[slot] = level, number
        span = self._room.span(slot, self.tables.num_actions)
        write_level(self.tables, span, level.compile(), outcomes)
        self._observer.write(slot, level)
        return span

    def _make_room(self, new: Mapping[int, Outcomes]) -> bool:
        """Return whether the tables had to grow so that there is room for levels."""
        room = self._room
        needs = [needed(outcomes) for outcomes in new.values()]
        chances = max((count for count, _ in needs), default=0)
        outcomes = max((count for _, count in needs), default=0)
        if chances > room.chances:
            # Not much more than one level needs, and not once more for each that needs more.
            room = replace(room, chances=chances + chances // 2)
        if outcomes > room.outcomes:
            room = replace(room, outcomes=outcomes)
        empty = room.slots - len(self._slot_of)
        if len(new) > empty and room.slots < self._most:
            slots = max(room.slots + len(new), 2 * room.slots)
            room = replace(room, slots=min(slots, self._most))
        if room is self._room:
            return False
        self._grow(room)
        return True

    def _grow(self, room: Room) -> None:
        more = room.slots - self._room.slots
        self._room = room
        self.tables = empty_tables(room, self._first_action, self._limit)
        self._observer.grow(self.tables.offset)
        self.levels += [None] * more
        self.numbers = np.append(self.numbers, np.zeros(more, np.int64))
        self._asked_at = np.append(self._asked_at, np.zeros(more, np.int64))
        for slot, level in enumerate(self.levels):
            if level is not None:
                mdp = level.compile()
                outcomes = outcomes_of(mdp, self._first_action, 0)
                span = room.span(slot, self.tables.num_actions)
                write_level(self.tables, span, mdp, outcomes)
