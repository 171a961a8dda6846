"""Which levels environments play: the same ones always, or others in each episode.

Levels of a suite, and mazes that grow at each reset, are made when an episode starts in them, and
put into a slot of the tables.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import prod
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.envs.arguments import start_states
from babyrobot_levels.envs.engine.factory import limits_of, make_engine
from babyrobot_levels.envs.engine.tables import (
    Part,
    Room,
    Span,
    build_tables,
    empty_tables,
    needed,
    part_of,
    write_part,
)
from babyrobot_levels.envs.observations.extent import Extent
from babyrobot_levels.envs.single import MAX_MAZE_SEED
from babyrobot_levels.envs.suite import suite_extent
from babyrobot_levels.envs.vector.rendering import RenderedVectorEnv
from babyrobot_levels.envs.vector.seeding import SeededVectorEnv
from babyrobot_levels.generate.suites import Suite
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level

if TYPE_CHECKING:
    from babyrobot_levels.envs.action_sets import ActionSet
    from babyrobot_levels.envs.engine.state import Engine
    from babyrobot_levels.envs.engine.tables import Flags, Ints, Tables
    from babyrobot_levels.envs.spaces import BatchActions
    from babyrobot_levels.envs.vector.observations import BatchObserver

KEPT_STATES = 2**19
"""Levels of a suite are kept as long as they have no more states than this together."""

_MOST = np.iinfo(np.int64).max


class Family(Protocol):
    """Levels that are made from their numbers.

    All have the same time limit and the same number of starts.

    Attributes:
        key: the name of a level's number in infos.
        option: the name of the option of `reset` that selects a number.
        count: numbers are drawn from 0 up to but not including this.
        kept: how many levels to keep at most for later episodes.
        levels: the levels, as they were given.
    """

    key: str
    option: str
    count: int
    kept: int
    levels: Sequence[Level]

    def level(self, number: int) -> Level:
        """Return the level of a number."""


class SuiteLevels:
    """The levels of a suite, or of a part of it."""

    key = "level_index"
    option = "index"

    def __init__(self, suite: Suite) -> None:
        self.levels: Sequence[Level] = suite
        self.count = self.kept = len(suite)

    def level(self, number: int) -> Level:
        """Return a level by its number in the suite, or in the part of it."""
        return self.levels[number]


class GrownMazes:
    """The mazes of a level with `maze: {seed: random}`."""

    key = option = "maze_seed"
    count = MAX_MAZE_SEED
    kept = 0

    def __init__(self, level: Level) -> None:
        self.levels: Sequence[Level] = (level,)

    def level(self, number: int) -> Level:
        """Return the level with the maze of a seed."""
        return self.levels[0].with_maze_seed(number)


@dataclass(frozen=True, slots=True)
class Played:
    """The levels of a vector environment.

    Attributes:
        levels: the levels, as they were given.
        extent: the extent of all of them.
        num_items: the most items of one of them.
        has_movers: whether one of them has movers.
        family: makes levels at resets; None if `levels` has all that are needed.
    """

    levels: Sequence[Level]
    extent: Extent
    num_items: int
    has_movers: bool
    family: Family | None = None


def checked_levels(
    level: Any, levels: Any, draw_levels: bool, num_envs: int | None, turns: bool
) -> Played:
    """Return the levels that the arguments of a vector environment name.

    Args:
        level: a level, or None.
        levels: several of them, a suite, or None.
        draw_levels: whether each episode draws its level.
        num_envs: how many environments there are, if it is given.
        turns: whether robots turn.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid.
        ValueError: both or none are given, or one of several levels has `maze: {seed: random}`.
    """
    if (level is None) == (levels is None):
        raise ValueError("give either `level` or `levels`")
    if levels is not None and (isinstance(levels, str) or not isinstance(levels, Sequence)):
        raise ValueError(f"levels must be a list of levels or a suite, not {levels!r}")
    if levels is not None and not len(levels):
        raise ValueError("levels must have at least one level in it")
    if isinstance(levels, Suite):
        extent = suite_extent(levels, turns=turns)
        if draw_levels:
            return Played(levels, extent, levels.most_items, levels.has_guards, SuiteLevels(levels))
        # No more levels are needed, and a suite may have a billion.
        return _played(tuple(levels[:num_envs]), extent)
    loaded = tuple(load(each) for each in ([level] if levels is None else levels))
    is_random = any(each.has_random_maze for each in loaded)
    if is_random and len(loaded) > 1:
        raise ValueError(
            "a level with `maze: {seed: random}` must be the only one; instead, draw some of its "
            "mazes: levels=[level.with_maze_seed(seed) for seed in range(100)], draw_levels=True"
        )
    family = GrownMazes(loaded[0]) if is_random else None
    return _played(loaded, Extent.of(loaded, turns=turns), family)


def _played(levels: tuple[Level, ...], extent: Extent, family: Family | None = None) -> Played:
    num_items = max(len(level.items) for level in levels)
    return Played(levels, extent, num_items, any(level.movers for level in levels), family)


def checked_numbers(options: Mapping[str, Any], family: Family | None, num_envs: int) -> Any:
    """Return the numbers of the levels that a reset selects, int64 `[num_envs]`, or None.

    Raises:
        ValueError: they are not numbers of levels.
    """
    given = None if family is None else options.get(family.option)
    if family is None or given is None:
        return None
    array = np.asarray(given)
    if array.dtype.kind not in "iu" or array.shape not in ((), (num_envs,)):
        raise ValueError(
            f"options[{family.option!r}] must be a whole number, or {num_envs} of them, "
            f"not {given!r}"
        )
    if (array > _MOST).any():
        raise ValueError(f"options[{family.option!r}] must be below 2**63, not {given!r}")
    if not isinstance(family, GrownMazes) and not ((array >= 0) & (array < family.count)).all():
        raise ValueError(
            f"options[{family.option!r}] must be below {family.count:,}, not {given!r}"
        )
    return np.broadcast_to(array.astype(np.int64), num_envs)


class Slots:
    """Tables with a slot for each level in use, and an LRU cache of those that were in use before.

    A level that still has a slot costs nothing when it is drawn again. A new one takes the least
    recently used slot in which no environment is.

    Attributes:
        family: makes the levels.
        tables: the tables; they are replaced when they have to grow.
        levels: the level in each slot, None in an empty one.
        numbers: int64 `[slots]`: the level's number in the family.
    """

    tables: Tables

    def __init__(
        self,
        played: Played,
        num_envs: int,
        actions: ActionSet,
        limit: int,
        observer: BatchObserver,
    ) -> None:
        """Put the level of number 0 into slot 0.

        Args:
            played: the levels, of which a family makes each.
            num_envs: how many environments there are; there may be as many slots at least.
            actions: the actions of the environments.
            limit: the time limit of all levels.
            observer: the observer of the levels in the slots.
        """
        assert played.family is not None
        self.family, self._observer = played.family, observer
        self._actions, self._limit, self._num_envs = actions, limit, num_envs
        self._has_movers = played.has_movers
        self._slot_of: dict[int, int] = {}
        self.levels: list[Level | None] = []
        self.numbers = np.empty(0, np.int64)
        self._used_at, self._clock = np.empty(0, np.int64), 0
        first = self.family.level(0)
        part = self._part(first)
        # A level of the largest size, if it has as many configurations as the first one.
        states = part.state_info.size // prod(first.size) * played.extent.cells
        self._room = Room(0, states, part.starts.size, played.num_items)
        self.place(np.zeros(1, np.intp), np.zeros(1, np.intp), np.zeros(1, np.int64), {0: first})

    def levels_of(self, numbers: Iterable[int]) -> dict[int, Level]:
        """Return the levels with these numbers. Those without a slot are made, but get none yet."""
        found = {}
        for number in dict.fromkeys(numbers):
            slot = self._slot_of.get(number)
            present = None if slot is None else self.levels[slot]
            found[number] = present or self.family.level(number)
        return found

    def place(
        self, level: Ints, which: Ints, numbers: NDArray[np.int64], levels: Mapping[int, Level]
    ) -> list[Span] | None:
        """Assign levels to environments.

        Args:
            level: intp `[envs]`: the slot of each environment; changed in place.
            which: the environments that change their level.
            numbers: the number of the new level of each of them.
            levels: what `levels_of` returned for these numbers.

        Returns:
            The parts of the tables that were written; None if the tables were replaced.
        """
        self._clock += 1
        new = {
            number: self._part(made)
            for number, made in levels.items()
            if number not in self._slot_of
        }
        is_grown = self._make_room(list(new.values()))
        spans = []
        if new:
            others = np.delete(level, which)
            staying = [self._slot_of[number] for number in levels if number not in new]
            for slot, number in zip(self._free(others, staying), new, strict=False):
                spans.append(self._write(slot, number, levels[number], new[number]))
        level[which] = [self._slot_of[number] for number in numbers.tolist()]
        self._used_at[level[which]] = self._clock
        return None if is_grown else spans

    def _free(self, *busy: Any) -> list[int]:
        """Return the slots that are not among these, the least recently used first."""
        is_free = np.ones(self._room.slots, np.bool_)
        for slots in busy:
            is_free[slots] = False
        free = is_free.nonzero()[0]
        found: list[int] = free[np.argsort(self._used_at[free], kind="stable")].tolist()
        return found

    def _part(self, level: Level) -> Part:
        return part_of(level, self._actions.tables(level), self._actions.first)

    def _write(self, slot: int, number: int, level: Level, part: Part) -> Span:
        """Put a level into a slot, in place of the one before."""
        if self.levels[slot] is not None:
            self._slot_of.pop(int(self.numbers[slot]), None)
        self._slot_of[number] = slot
        self.levels[slot], self.numbers[slot] = level, number
        span = self._room.span(slot, self.tables.num_actions)
        write_part(self.tables, span, part)
        self._observer.write(slot, level)
        return span

    def _make_room(self, new: Sequence[Part]) -> bool:
        """Make room for levels, and return whether the tables had to grow for it."""
        room = self._room
        needs = [needed(part) for part in new]
        states = max((part.state_info.size for part in new), default=0)
        stochastic = max((count for count, _ in needs), default=0)
        outcomes = max((count for _, count in needs), default=0)
        # More than these levels need, so that the tables do not grow for each larger one.
        if states > room.states:
            room = replace(room, states=states + states // 2)
        if stochastic > room.stochastic:
            room = replace(room, stochastic=stochastic + stochastic // 2)
        if outcomes > room.outcomes:
            room = replace(room, outcomes=outcomes)
        most = max(self._num_envs, min(self.family.kept, KEPT_STATES // room.states))
        empty = room.slots - len(self._slot_of)
        if len(new) > empty and room.slots < most:
            slots = max(room.slots + len(new), 2 * room.slots)
            room = replace(room, slots=min(slots, most))
        if room is self._room:
            return False
        self._grow(room)
        return True

    def _grow(self, room: Room) -> None:
        more = room.slots - self._room.slots
        self._room = room
        num_actions = self._actions.num_actions
        self.tables = empty_tables(room, num_actions, self._limit, self._has_movers)
        self._observer.grow(self.tables.offset)
        self.levels += [None] * more
        self.numbers = np.append(self.numbers, np.zeros(more, np.int64))
        self._used_at = np.append(self._used_at, np.zeros(more, np.int64))
        for slot, level in enumerate(self.levels):
            if level is not None:
                write_part(self.tables, room.span(slot, num_actions), self._part(level))
                self._observer.write(slot, level)


class ChangingVectorEnv(SeededVectorEnv, RenderedVectorEnv):
    """A vector environment whose levels can change. Subclasses define `reset` and `step`."""

    action_space: BatchActions
    _observer: BatchObserver
    _engine: Engine
    _engine_name: str | None
    _slots: Slots | None = None

    def _set_levels(
        self, played: Played, actions: ActionSet, max_episode_steps: Any, draw_levels: bool
    ) -> None:
        """Make the tables of the levels, and an engine for them."""
        self._actions = actions
        if played.family is None:
            limits = limits_of(self.levels, max_episode_steps)
            parts = [part_of(each, actions.tables(each), actions.first) for each in self.levels]
            tables = build_tables(parts, limits, draw_levels)
            self._observer.write_all(tables.offset, self.levels)
            self._playing = self.levels
        else:
            limit = limits_of([played.family.level(0)], max_episode_steps)[0]
            self._slots = Slots(played, self.num_envs, actions, limit, self._observer)
            tables, self._playing = self._slots.tables, self._slots.levels
        self._use(tables)

    def _use(self, tables: Tables) -> None:
        """Switch to tables."""
        self._tables = tables
        self._engine = make_engine(self._engine_name, tables, self._observer.table, self.num_envs)
        if self._actions.samples_valid:
            self.action_space.state_info = tables.state_info

    def _level_numbers(self) -> dict[str, NDArray[np.int64]]:
        """Return the numbers of the current levels, under their key in infos."""
        if self._slots is not None:
            numbers = self._slots.numbers.take(self._envs.level)
            return {self._slots.family.key: numbers}
        return {"level_index": self._envs.level.copy()} if len(self.levels) > 1 else {}

    def _digests(self, where: Flags) -> dict[str, NDArray[Any]]:
        """Return the digests of the levels of some environments, for infos as they once were."""
        if self._slots is not None and self._slots.family.key == "maze_seed":
            return {}
        digests = np.array(self.call("level_digest"), object)
        digests[~where] = None
        return {"level_digest": digests, "_level_digest": where}

    def _change_levels(self, which: Ints, numbers: Any = None, start: Any = None) -> None:
        """Assign other levels to environments: those with `numbers`, `[num_envs]`, or drawn ones.

        If a level cannot be made, or an episode cannot start in the cell `start`, nothing changes.
        """
        slots = self._slots
        assert slots is not None
        if numbers is None:
            drawn = self._draws.uniform(which) * slots.family.count
            wanted = drawn.astype(np.int64)
        else:
            wanted = numbers[which]
        levels = slots.levels_of(wanted.tolist())
        if start is not None:
            for level in levels.values():
                start_states(start, level, self._actions.tables(level))
        envs, before = self._envs, self._envs.level.copy()
        spans = slots.place(envs.level, which, wanted, levels)
        if spans is None:
            # The states of their levels may begin elsewhere now.
            moved = slots.tables.offset.take(before) - self._tables.offset.take(before)
            envs.state[envs.state >= 0] += moved[envs.state >= 0]
            self._use(slots.tables)
        else:
            for span in spans:
                self._engine.update(span)
