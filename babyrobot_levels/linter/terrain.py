"""The effects of walls and openings on the grid, and of areas, puddles and skidding on its cells.

A cell's reward is that of its puddle, else of the last area with a reward, else the level's step;
its skid likewise; whether it ends the episode is up to the last area that says so. Properties
therefore form layers. They are applied from bottom to top, noting where each changes something, and
then checked from top to bottom, where the effective ones above hide those below.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import Enum, auto
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.cells import Area, Opening, SkidLike, Wall, as_skid
from babyrobot_levels.library.level import Level
from babyrobot_levels.linter.finding import count_drawn
from babyrobot_levels.linter.variants import rewarded_cells
from babyrobot_levels.mdp.grid import BIT, Grid
from babyrobot_levels.mdp.tables import Flags

Where = tuple[Any, Any]

PROPERTIES = ("reward", "skid", "ends")


class Effect(Enum):
    """The effect of a property on all cells that have it."""

    WORKS = auto()
    """It changes the MDP."""
    UNREACHABLE = auto()
    """It changes only states that are never occupied: cells of a warp that acts on entering."""
    SAME = auto()
    """Without it, the cells would have the same value."""
    NEVER = auto()
    """It never applies: the episode ends there, or something else takes precedence."""
    COVERED = auto()
    """Later areas or puddles override it on all of its cells."""


@dataclass(slots=True)
class AreaEffect:
    """The effect of an area.

    Attributes:
        number: its index among the level's areas.
        effects: the effect of each property that it sets.
        colored: whether its colour is visible; None if it has none.
        labelled: whether it has a label.
    """

    number: int
    effects: dict[str, Effect] = field(default_factory=dict)
    colored: bool | None = None
    labelled: bool = False

    @property
    def works(self) -> bool:
        """Whether the MDP or the picture would be different without it."""
        return Effect.WORKS in self.effects.values() or bool(self.colored) or self.labelled

    @property
    def is_covered(self) -> bool:
        """Whether it sets something, and all of it is covered."""
        covered = [effect is Effect.COVERED for effect in self.effects.values()]
        covered += [] if self.colored is None else [not self.colored]
        return bool(covered) and all(covered)

    @property
    def is_safe(self) -> bool:
        """Whether removing it would leave the tables unchanged."""
        return all(self.is_safe_without(name) for name in self.effects)

    def is_safe_without(self, name: str) -> bool:
        """Return whether removing a property would leave the tables unchanged."""
        return self.effects[name] not in (Effect.WORKS, Effect.UNREACHABLE)

    def is_idle(self, name: str) -> bool:
        """Return whether a property is set and never applies, whatever its value."""
        return self.effects.get(name) in (Effect.UNREACHABLE, Effect.NEVER, Effect.COVERED)


class TerrainEffects:
    """The effects of all layers of a level's terrain.

    Attributes:
        areas: the effect of each area that the file lists.
        puddles: the puddles without effect: index, and the effects of reward and skid.
        skid: the effect of the level's `skid`, None if it has none.
    """

    def __init__(self, level: Level) -> None:
        self._level = level
        self._blocked = level.grid().blocked
        shape = self._blocked.shape
        enters = [warp.at for warp in self._level.warps if warp.when == "enter"]
        leaves = [warp.at for warp in self._level.warps if warp.when == "leave"]
        self._stood = ~_flags(shape, enters)
        self._fixed = _flags(shape, sure_exits(level)) | self._blocked
        self._drawn = count_drawn(self._level, "areas")
        self._value = {
            "reward": np.full(shape, self._level.rewards.step, object),
            "skid": np.full(shape, skid_code(self._level.skid), complex),
            "ends": np.zeros(shape, bool),
        }
        self._hidden = {name: np.zeros(shape, bool) for name in (*PROPERTIES, "color")}
        changes = self._layers()
        self._over: Flags = self._fixed | self._value["ends"]
        self._moved = ~self._over & ~_flags(shape, leaves)
        self.puddles = self._puddles()
        self.areas = self._areas(changes)
        self.skid = self._skid()

    def _layers(self) -> list[dict[str, Flags]]:
        """Apply the areas; return where the properties of each listed area change something."""
        for area in self._level.areas[: self._drawn]:
            for name in PROPERTIES:
                if getattr(area, name) is not None:
                    self._value[name][area.at[1], area.at[0]] = _code(area, name)
        changes = []
        for area in self._level.areas[self._drawn :]:
            where, change = place(area), {}
            for name in PROPERTIES:
                if getattr(area, name) is not None:
                    value = _code(area, name)
                    change[name] = self._value[name][where] != value
                    self._value[name][where] = value
            changes.append(change)
        return changes

    def _puddles(self) -> list[tuple[int, Effect, Effect]]:
        found = []
        for size in ("small", "large"):
            kind = getattr(self._level.puddle_types, size)
            numbers = [n for n, puddle in enumerate(self._level.puddles) if puddle.size == size]
            if not numbers:
                continue
            at = np.array([self._level.puddles[number].at for number in numbers])
            where = (at[:, 1], at[:, 0])
            reward = self._value["reward"][where] != kind.reward
            skid = self._value["skid"][where] != skid_code(kind.skid)
            works = (reward & self._surely_given[where]) | (
                skid & (self._moved & self._stood)[where]
            )
            for name in ("reward", "skid"):
                self._hidden[name][where] = True
            for index in np.flatnonzero(~works):
                one = (where[0][index : index + 1], where[1][index : index + 1])
                seen = np.ones(1, bool)
                effects = (
                    self._effect("reward", one, seen, reward[index : index + 1]),
                    self._effect("skid", one, seen, skid[index : index + 1]),
                )
                if Effect.WORKS not in effects:
                    found.append((numbers[index], *effects))
                    for name in ("reward", "skid"):
                        self._hidden[name][one] = False
        return sorted(found, key=lambda each: each[0])

    def _areas(self, changes: list[dict[str, Flags]]) -> list[AreaEffect]:
        found: list[AreaEffect] = []
        listed = [*enumerate(self._level.areas)][self._drawn :]
        if not listed:
            return found
        shown = self._shown()
        for (number, area), change in zip(reversed(listed), reversed(changes), strict=True):
            where = place(area)
            one = AreaEffect(number, labelled=bool((area.label or "").split()))
            for name, differs in change.items():
                seen = ~self._hidden[name][where]
                dry = name == "skid" and skid_code(area.skid) == 0
                one.effects[name] = self._effect(name, where, seen, differs, dry=dry)
            if area.color is not None:
                one.colored = bool((shown[where] & ~self._hidden["color"][where]).any())
            found.append(one)
            if one.works:
                for name in change:
                    # Of a skid that applies: without what lies below, it would be the same.
                    if name != "skid" or one.effects[name] in (Effect.WORKS, Effect.SAME):
                        self._hidden[name][where] = True
                if area.color is not None and is_opaque(area.color):
                    self._hidden["color"][where] = True
        return found[::-1]

    def _shown(self) -> Flags:
        """Return the cells whose ground is visible because nothing else is drawn over it."""
        level, colors = self._level, self._level.resolved_theme.colors
        shown = np.ones_like(self._over)
        exits = level.exits if level.exit_one_of is None else ()
        for cells, color in ((level.starts, colors.start), (exits, colors.exit)):
            if is_opaque(color):
                shown &= ~_flags(shown.shape, cells)
        if is_opaque(colors.blocked):
            shown &= ~self._blocked
        return shown

    def _skid(self) -> Effect | None:
        if self._level.skid is None:
            return None
        everywhere = (slice(None), slice(None))
        seen, dry = ~self._hidden["skid"], skid_code(self._level.skid) == 0
        return self._effect("skid", everywhere, seen, np.full_like(seen, not dry), dry=dry)

    def _effect(
        self, name: str, where: Where, seen: Flags, differs: Flags, *, dry: bool = False
    ) -> Effect:
        """Return the effect of a property on some cells.

        Args:
            name: the property.
            where: the cells.
            seen: on which of them nothing overrides it.
            differs: on which of them the value would be different without it.
            dry: whether it is a skid with probability 0.
        """
        if not seen.any():
            return Effect.COVERED
        changes = seen & differs
        stood = self._stood[where]
        if name == "reward" and (changes & self._surely_given[where]).any():
            return Effect.WORKS
        counts = self._counts(name)[where]
        if (changes & counts & stood).any():
            return Effect.WORKS
        if (changes & counts).any():
            return Effect.UNREACHABLE
        return Effect.SAME if not dry and (seen & counts & stood).any() else Effect.NEVER

    def _counts(self, name: str) -> Flags:
        """Return the cells on which a property applies."""
        if name == "reward":
            return self._rewarded
        return self._moved if name == "skid" else ~self._fixed

    @cached_property
    def _rewarded(self) -> Flags:
        # With things, it may take a configuration that no episode comes to.
        if self._level.has_things:
            pays = isinstance(self._level.rewards.exit, str)
            anywhere: Flags = ~(self._blocked if pays else self._fixed)
            return anywhere
        return rewarded_cells(self._level)

    @property
    def _surely_given(self) -> Flags:
        """Some of the cells whose own reward is given, known without a compiled variant."""
        # Staying there gives it.
        plain = self._level.rewards.stay is None
        return ~self._over & self._stood if plain else np.zeros_like(self._over)


def sure_exits(level: Level) -> tuple[tuple[int, int], ...]:
    """Return the cells that end every episode that comes there, because they are exits."""
    return () if level.exit_keys or level.exit_one_of is not None else level.exits


def place(area: Area) -> tuple[slice, slice]:
    """Return the position of an area in arrays `[height, width]`."""
    (x, y), (columns, rows) = area.at, area.size
    return slice(y, y + rows), slice(x, x + columns)


def skid_code(skid: SkidLike | None) -> complex:
    """Return a skid as one number, which is 0 for all skids with probability 0."""
    if skid is None:
        return 0j
    given = as_skid(skid)
    return given.probability * {"open": 1, "sides": -1, "others": 1j}[given.to]


def is_opaque(color: str) -> bool:
    """Return whether a CSS colour certainly hides what is below it."""
    if color.startswith("#"):
        return len(color) in (4, 7)
    return color != "transparent" and not color.startswith("rgba")


def _code(area: Area, name: str) -> Any:
    value = getattr(area, name)
    return skid_code(value) if name == "skid" else value


def _flags(shape: tuple[int, ...], cells: Any) -> Flags:
    flags = np.zeros(shape, bool)
    for x, y in cells:
        flags[y, x] = True
    return flags


Numbers = NDArray[np.int32]
Place = tuple[int, tuple[slice, slice]]
"""A run of sides: 0 for horizontal sides (N and S) or 1 for vertical ones, and the slices."""


@dataclass(frozen=True, slots=True)
class Undoing:
    """An opening that removes a wall of the level.

    Attributes:
        opening: the index of the opening.
        wall: the index of the wall.
        wholly: whether nothing is left of the wall that would not exist without it.
        idle: whether the opening would have no effect without that wall.
    """

    opening: int
    wall: int
    wholly: bool
    idle: bool


class Barriers:
    """The walls and openings of a level that have no effect or cancel each other.

    Entries are checked from last to first, given all the others, and one without effect counts as
    removed from then on. Of two equal entries the later one is reported, and all reported entries
    can be removed together.

    Indices count the level's walls and openings from 0, including those of its drawing.

    Attributes:
        idle_walls: walls without which grid and picture would be the same, except for those that
            an opening removes.
        idle_openings: openings without which grid and picture would be the same.
        undoings: openings that remove walls of the level.
    """

    def __init__(self, level: Level, bare: Grid) -> None:
        """Compare the entries of a level.

        Args:
            level: the level.
            bare: its grid without its own walls and openings.
        """
        self._level = level
        self._base, self._hidden, self._joins = _base(bare)
        shapes = [sides.shape for sides in self._base]
        self._walls = [np.zeros(shape, np.int32) for shape in shapes]
        self._openings = [np.zeros(shape, np.int32) for shape in shapes]
        self._owner = [np.full(shape, -1, np.int32) for shape in shapes]
        before = self._count()
        self.undoings = [*self._undoings()]
        self.idle_openings = self._idle_openings()
        self.idle_walls = self._idle_walls(before)

    def _count(self) -> dict[int, NDArray[np.float64]]:
        """Count walls and openings; return the values that each given `pass` replaces."""
        before = {}
        passes = [np.zeros(sides.shape) for sides in self._base]
        drawn = count_drawn(self._level, "walls")
        for number, wall in enumerate(self._level.walls):
            axis, where = run_of(wall)
            self._walls[axis][where] += 1
            self._owner[axis][where] = number
            if "pass_" in wall.model_fields_set:
                before[number] = passes[axis][where].copy()
                # The `pass` that a drawing implies never equals one that is given.
                passes[axis][where] = np.nan if number < drawn else wall.pass_
        for opening in self._level.openings:
            axis, where = run_of(opening)
            self._openings[axis][where] += 1
        return before

    def _undoings(self) -> Iterator[Undoing]:
        for number, opening in enumerate(self._level.openings):
            axis, where = run_of(opening)
            owner = self._owner[axis][where]
            for wall in np.unique(owner[(owner >= 0) & ~self._hidden[axis][where]]).tolist():
                rest = self._walls[axis][where] - (owner == wall) > 0
                idle = not self._removes_wall(axis, where, self._base[axis][where] | rest)
                yield Undoing(number, wall, self._is_undone(wall), idle)

    def _is_undone(self, number: int) -> bool:
        """Return whether openings leave nothing of a wall that would not exist without it."""
        wall = self._level.walls[number]
        axis, where = run_of(wall)
        gone = (self._openings[axis][where] > 0) | self._hidden[axis][where]
        if "pass_" not in wall.model_fields_set and not _has_looks(wall):
            gone |= self._base[axis][where] | (self._walls[axis][where] > 1)
        return bool(gone.all())

    def _idle_openings(self) -> list[int]:
        found = []
        for number, opening in reversed([*enumerate(self._level.openings)]):
            axis, where = run_of(opening)
            if not self._removes_wall(axis, where, self._is_wall(axis, where)):
                found.append(number)
                self._openings[axis][where] -= 1
        return found[::-1]

    def _idle_walls(self, before: dict[int, NDArray[np.float64]]) -> list[int]:
        found = []
        later = [np.zeros(sides.shape, bool) for sides in self._base]
        drawn = count_drawn(self._level, "walls")
        for number, wall in reversed([*enumerate(self._level.walls)][drawn:]):
            axis, where = run_of(wall)
            opened = self._openings[axis][where] > 0
            stands = ~opened & ~self._hidden[axis][where]
            alone = stands & ~self._base[axis][where] & (self._walls[axis][where] == 1)
            matters = bool(alone.any() or opened.any())
            if number in before:
                new = before[number] != wall.pass_
                joins = self._joins[axis][where]
                matters = matters or bool((stands & joins & new & ~later[axis][where]).any())
            if matters or (_has_looks(wall) and stands.any()):
                later[axis][where] |= number in before
            else:
                found.append(number)
                self._walls[axis][where] -= 1
        return found[::-1]

    def _is_wall(self, axis: int, where: tuple[slice, slice]) -> Flags:
        return self._base[axis][where] | (self._walls[axis][where] > 0)

    def _removes_wall(self, axis: int, where: tuple[slice, slice], walls: Flags) -> bool:
        """Return whether there is a wall that no other opening removes."""
        alone = self._openings[axis][where] == 1
        return bool((walls & alone & ~self._hidden[axis][where]).any())


def run_of(entry: Opening) -> Place:
    """Return the position of a wall or an opening in arrays over the sides of cells.

    Horizontal sides have shape `[height + 1, width]`, vertical ones `[height, width + 1]`.
    """
    x, y = entry.at
    if entry.side in ("N", "S"):
        y += entry.side == "S"
        return 0, (slice(y, y + 1), slice(x, x + entry.length))
    x += entry.side == "E"
    return 1, (slice(y, y + entry.length), slice(x, x + 1))


def _base(bare: Grid) -> tuple[list[Flags], list[Flags], list[Flags]]:
    """Return walls, sides between two blocked cells, and sides between two free ones."""
    shape = (bare.height, bare.width)
    bits = np.frombuffer(bare.wall_bits, np.uint8).reshape(shape)
    blocked = np.frombuffer(bare.blocked_cells, np.uint8).reshape(shape) > 0
    walls: list[Flags] = []
    hidden: list[Flags] = []
    joins: list[Flags] = []
    for first, last, cells, known in (("N", "S", bits, blocked), ("W", "E", bits.T, blocked.T)):
        sides = np.concatenate([cells & BIT[first], cells[-1:] & BIT[last]]) > 0
        both, none = np.zeros_like(sides), np.zeros_like(sides)
        both[1:-1] = known[:-1] & known[1:]
        none[1:-1] = ~(known[:-1] | known[1:])
        for found, values in ((walls, sides), (hidden, both), (joins, none)):
            found.append(values if first == "N" else values.T)
    return walls, hidden, joins


def _has_looks(wall: Wall) -> bool:
    return wall.color is not None or wall.width is not None or wall.fit
