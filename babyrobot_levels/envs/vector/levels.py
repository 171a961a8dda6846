"""Which levels environments play: the same ones always, or others in each episode.

Levels of a suite, and mazes that grow at each reset, are made when an episode starts in them, and
put into a slot of the tables.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.envs.arguments import limits_of, start_states
from babyrobot_levels.envs.engine.plain import make_engine
from babyrobot_levels.envs.engine.state import Engine
from babyrobot_levels.envs.engine.tables import (
    Ints,
    Part,
    Room,
    Span,
    Tables,
    build_tables,
    empty_tables,
    needed,
    part_of,
    write_part,
)
from babyrobot_levels.envs.observations.base import BatchObserver, Extent
from babyrobot_levels.envs.samplers import (
    DrawnLevels,
    ExchangedLevels,
    Family,
    GrownMazes,
    checked_sampler,
)
from babyrobot_levels.envs.spaces import ActionSet, BatchActions
from babyrobot_levels.envs.suite import extent_of
from babyrobot_levels.envs.vector.base import RenderedVectorEnv, SeededVectorEnv
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.configurations import largest_radices
from babyrobot_levels.suites.sources import Bounds
from babyrobot_levels.suites.suite import Suite

KEPT_STATES = 2**19
"""Levels of a suite are kept as long as they have no more states than this together."""

_MOST = np.iinfo(np.int64).max


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
    level: Any, levels: Any, draw_levels: bool, sampler: Any, num_envs: int | None, turns: bool
) -> Played:
    """Return the levels that the arguments of a vector environment name.

    Args:
        level: a level, or None.
        levels: several of them, a suite, or None.
        draw_levels: whether each episode draws its level.
        sampler: what selects the levels that are drawn, None for the default.
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
    if sampler is not None and (levels is None or not draw_levels):
        raise ValueError("a sampler needs several `levels` or a suite, and draw_levels=True")
    if isinstance(levels, Suite):
        extent = extent_of(levels.bounds, turns=turns)
        if draw_levels:
            drawn = DrawnLevels(levels, checked_sampler(sampler, levels), levels.bounds.num_starts)
            return Played(levels, extent, levels.most_items, levels.has_guards, drawn)
        # No more levels are needed, and a suite may have a billion.
        return _played(tuple(levels[:num_envs]), extent)
    loaded = tuple(load(each) for each in ([level] if levels is None else levels))
    is_random = any(each.has_random_maze for each in loaded)
    if is_random and len(loaded) > 1:
        raise ValueError(
            "a level with `maze: {seed: random}` must be the only one; instead, draw some of its "
            "mazes: levels=[level.with_maze_seed(seed) for seed in range(100)], draw_levels=True"
        )
    family: Family | None = GrownMazes(loaded[0]) if is_random else None
    if sampler is not None:
        most_starts = Bounds.joined(map(Bounds.of, loaded)).num_starts
        family = DrawnLevels(loaded, checked_sampler(sampler, loaded), most_starts)
    return _played(loaded, Extent.of(loaded, turns=turns), family)


def _played(levels: tuple[Level, ...], extent: Extent, family: Family | None = None) -> Played:
    num_items = max(len(level.items) for level in levels)
    return Played(levels, extent, num_items, any(level.movers for level in levels), family)


def checked_numbers(options: Mapping[str, Any], family: Family | None, num_envs: int) -> Any:
    """Return the numbers of the levels that a reset selects, int64 `[num_envs]`, or None.

    Raises:
        ValueError: they are not numbers of levels.
    """
    option = None if family is None else family.option
    given = None if option is None else options.get(option)
    if family is None or given is None:
        return None
    array = np.asarray(given)
    if array.dtype.kind not in "iu" or array.shape not in ((), (num_envs,)):
        raise ValueError(
            f"options[{option!r}] must be a whole number, or {num_envs} of them, not {given!r}"
        )
    if (array > _MOST).any():
        raise ValueError(f"options[{option!r}] must be below 2**63, not {given!r}")
    if not isinstance(family, GrownMazes) and not ((array >= 0) & (array < family.count)).all():
        raise ValueError(f"options[{option!r}] must be below {family.count:,}, not {given!r}")
    return np.broadcast_to(array.astype(np.int64), num_envs)


def checked_environments(which: Any, num_envs: int) -> Ints:
    """Return the indices of environments, which are given as such or as a mask; None for all.

    Raises:
        ValueError: there are no such environments.
    """
    if which is None:
        return np.arange(num_envs)
    array = np.atleast_1d(np.asarray(which))
    is_mask = array.dtype == np.bool_ and array.shape == (num_envs,)
    indices = array.nonzero()[0] if is_mask else array
    is_valid = array.ndim == 1 and (is_mask or array.dtype.kind in "iu")
    if not is_valid or ((indices < 0) | (indices >= num_envs)).any() or not indices.size:
        raise ValueError(
            f"which must be indices of environments, 0 to {num_envs - 1}, or a mask, bool "
            f"[{num_envs}], of at least one environment, not {which!r}"
        )
    return np.unique(indices).astype(np.intp)


def misfit(level: Level, extent: Extent, num_items: int, *, has_movers: bool) -> str | None:
    """Return why a level does not fit into the spaces of an environment, None if it does.

    Args:
        level: the level, whose maze has a seed.
        extent: the extent of the levels that the environment was made with.
        num_items: the most items of these.
        has_movers: whether one of them has movers.
    """
    own = Extent.of([level], turns=extent.headings > 1)
    if own.size[0] > extent.size[0] or own.size[1] > extent.size[1]:
        sizes = ["x".join(map(str, size)) for size in (own.size, extent.size)]
        return f"it has {sizes[0]} cells, and the spaces {sizes[1]}"
    if len(level.items) > num_items:
        return f"it has {len(level.items)} items, and the spaces have {num_items}"
    if own.moves != extent.moves:
        return f"its robot moves in {own.moves} ways, and the actions are for {extent.moves}"
    if own.has_wind and not extent.has_wind:
        return "it has wind, and the spaces have none"
    if own.has_boxes and not extent.has_boxes:
        return "it has boxes or targets, and the spaces have none"
    if level.movers and not has_movers:
        return "it has movers, and the spaces have none"
    if largest_radices(own.radices, extent.radices) != extent.radices:
        return "its things have more values than those of the spaces"
    if own.configurations > extent.configurations:
        return (
            f"it has {own.configurations:,} configurations, and the spaces have "
            f"{extent.configurations:,}"
        )
    return None


def check_fits(level: Level, extent: Extent, num_items: int, *, has_movers: bool) -> None:
    """Raise a ValueError if a level does not fit into the spaces; see `misfit`."""
    if level.has_random_maze:
        raise ValueError("set_levels: a level with `maze: {seed: random}` has no maze of its own")
    if (problem := misfit(level, extent, num_items, has_movers=has_movers)) is not None:
        raise ValueError(
            f"{level!r} does not fit: {problem}; make the environment with such a level among "
            "its `levels`, behind those that are played at first"
        )


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
        max_episode_steps: Any,
        observer: BatchObserver,
    ) -> None:
        """Put the level of number 0 into slot 0.

        Args:
            played: the levels, of which a family makes each.
            num_envs: how many environments there are; there may be as many slots at least.
            actions: the actions of the environments.
            max_episode_steps: the time limit of all levels, None for each level's own.
            observer: the observer of the levels in the slots.
        """
        assert played.family is not None
        self.family, self._observer = played.family, observer
        self._actions, self._max_episode_steps = actions, max_episode_steps
        self._num_envs = num_envs
        self._has_movers = played.has_movers
        self._slot_of: dict[int, int] = {}
        self.levels: list[Level | None] = []
        self.numbers = np.empty(0, np.int64)
        self._used_at, self._clock = np.empty(0, np.int64), 0
        first = self.family.level(0)
        part = self._part(first)
        # A level of the largest size, if it has as many configurations as the first one.
        states = part.state_info.size // prod(first.size) * played.extent.cells
        starts = max(part.starts.size, self.family.most_starts)
        self._room = Room(0, states, starts, played.num_items)
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
        self._fill(slot, level, part)
        return span

    def _fill(self, slot: int, level: Level, part: Part) -> None:
        limit = limits_of([level], self._max_episode_steps)[0]
        write_part(self.tables, self._room.span(slot, self.tables.num_actions), part, limit)
        self._observer.write(slot, level)

    def forget(self, numbers: Iterable[int]) -> None:
        """Empty the slots of levels that are not played and whose numbers stand for others now."""
        for number in numbers:
            if (slot := self._slot_of.pop(number, None)) is not None:
                self.levels[slot] = None

    def _make_room(self, new: Sequence[Part]) -> bool:
        """Make room for levels, and return whether the tables had to grow for it."""
        room = self._room
        needs = [needed(part) for part in new]
        states = max((part.state_info.size for part in new), default=0)
        stochastic = max((count for count, _ in needs), default=0)
        outcomes = max((count for _, count in needs), default=0)
        starts = max((part.starts.size for part in new), default=0)
        # More than these levels need, so that the tables do not grow for each larger one.
        if states > room.states:
            room = replace(room, states=states + states // 2)
        if stochastic > room.stochastic:
            room = replace(room, stochastic=stochastic + stochastic // 2)
        if outcomes > room.outcomes:
            room = replace(room, outcomes=outcomes)
        if starts > room.starts:
            room = replace(room, starts=starts)
        most = max(self._num_envs, min(self.family.kept, KEPT_STATES // room.states))
        empty = room.slots - len(self._slot_of)
        if len(new) > empty and room.slots < most:
            room = replace(room, slots=min(max(room.slots + len(new), 2 * room.slots), most))
        if room is self._room:
            return False
        self._grow(room)
        return True

    def _grow(self, room: Room) -> None:
        more = room.slots - self._room.slots
        self._room = room
        self.tables = empty_tables(room, self._actions.num_actions, self._has_movers)
        self._observer.grow(self.tables.offset)
        self.levels += [None] * more
        self.numbers = np.append(self.numbers, np.zeros(more, np.int64))
        self._used_at = np.append(self._used_at, np.zeros(more, np.int64))
        for slot, level in enumerate(self.levels):
            if level is not None:
                self._fill(slot, level, self._part(level))


class ChangingVectorEnv(SeededVectorEnv, RenderedVectorEnv):
    """A vector environment whose levels can change. Subclasses define `reset` and `step`."""

    action_space: BatchActions
    _observer: BatchObserver
    _new_observer: Callable[[], BatchObserver]
    _engine: Engine
    _engine_name: str | None
    _slots: Slots | None = None
    num_items: int
    _has_movers: bool
    _has_level_numbers: bool
    _all_have_items: bool
    _all_have_movers: bool

    def _set_levels(
        self, played: Played, actions: ActionSet, max_episode_steps: Any, draw_levels: bool
    ) -> None:
        """Make the tables of the levels, and an engine for them."""
        self._actions, self._max_episode_steps = actions, max_episode_steps
        if played.family is None:
            parts = [part_of(each, actions.tables(each), actions.first) for each in self.levels]
            tables = build_tables(parts, limits_of(self.levels, max_episode_steps), draw_levels)
            self._observer.write_all(tables.offset, self.levels)
            self._playing = self.levels
        else:
            self._slots = Slots(played, self.num_envs, actions, max_episode_steps, self._observer)
            tables, self._playing = self._slots.tables, self._slots.levels
        self._use(tables)

    def set_levels(self, levels: Any, which: Any = None) -> None:
        """Give environments other levels, from their next episodes on.

        Present episodes go on in their levels. `levels` changes: the levels of environments have
        the numbers `info["level_index"]` there, and numbers that no environment has any more are
        given to new levels.

        Args:
            levels: a level, for all these environments, or a list or a suite, of which the one in
                place i of `which` gets level `i % len(levels)`.
            which: the environments: their indices, or a mask, bool `[num_envs]`. All by default.

        Raises:
            LevelNotFoundError: there is no such level.
            LevelError: a level is not valid.
            ValueError: a level does not fit into the spaces, there are no such environments, or
                the levels of the environments are drawn.
        """
        chosen = checked_environments(which, self.num_envs)
        several = isinstance(levels, Sequence) and not isinstance(levels, str)
        given = levels if several else [levels]
        if not len(given):
            raise ValueError("levels must have at least one level in it")
        loaded = [load(given[number]) for number in range(min(len(given), chosen.size))]
        for level in loaded:
            check_fits(level, self._extent, self.num_items, has_movers=self._has_movers)
        family = self._exchanged()
        assert self._slots is not None
        playing = self._slots.numbers.take(self._envs.level)
        each = [loaded[number % len(loaded)] for number in range(chosen.size)]
        self._slots.forget(family.exchange(each, chosen, playing))
        self.levels = family.levels

    def _exchanged(self) -> ExchangedLevels:
        """Return the levels as those that can be exchanged, which takes tables with slots."""
        if self._slots is not None:
            if isinstance(self._slots.family, ExchangedLevels):
                return self._slots.family
            raise ValueError(
                "set_levels is for levels that stay; where episodes draw their levels, a sampler "
                "selects them: LevelVectorEnv(levels=…, draw_levels=True, sampler=…)"
            )
        if self._tables.draws_levels:
            raise ValueError("set_levels is for levels that stay, and not for draw_levels=True")
        family = ExchangedLevels(self.levels, self._envs.level)
        played = Played(self.levels, self._extent, self.num_items, self._has_movers, family)
        before, envs = self._tables, self._envs
        offset = before.offset.take(envs.level)
        self._observer = self._new_observer()
        slots = Slots(played, self.num_envs, self._actions, self._max_episode_steps, self._observer)
        self._slots, self._playing = slots, slots.levels
        numbers = family.next_level.copy()
        slots.place(
            envs.level, np.arange(self.num_envs), numbers, slots.levels_of(numbers.tolist())
        )
        moved = slots.tables.offset.take(envs.level) - offset
        envs.state[envs.state >= 0] += moved[envs.state >= 0]
        self._use(slots.tables)
        self._has_level_numbers = True
        self._all_have_items = self._all_have_movers = False
        return family

    def _use(self, tables: Tables) -> None:
        """Go over to tables."""
        self._tables = tables
        self._reserve_draws(self.num_envs * (tables.most_draws + int(self._slots is not None)))
        self._engine = make_engine(self._engine_name, tables, self._observer.table, self.num_envs)
        if self._actions.samples_valid:
            self.action_space.state_info = tables.state_info

    def _level_numbers(self) -> dict[str, NDArray[np.int64]]:
        """Return the numbers of the current levels, under their key in infos."""
        if self._slots is not None:
            return {self._slots.family.key: self._slots.numbers.take(self._envs.level)}
        return {"level_index": self._envs.level.copy()} if len(self.levels) > 1 else {}

    def _change_levels(self, which: Ints, numbers: Any = None, start: Any = None) -> None:
        """Assign other levels to environments: those with `numbers`, `[num_envs]`, or drawn ones.

        If a level cannot be made, or an episode cannot start in the cell `start`, nothing changes.
        """
        slots = self._slots
        assert slots is not None
        if numbers is None:
            wanted = slots.family.next_numbers(which, self._draws)
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
