"""The effect of each wall and each opening on the grid, given all the others.

Entries are checked from last to first, and one without effect counts as removed from then on. Of
two equal entries the later one is reported, and all reported entries can be removed together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.cells import Opening, Wall
from babyrobot_levels.library.level import Level
from babyrobot_levels.linter.finding import count_drawn
from babyrobot_levels.mdp.grid import BIT, Grid
from babyrobot_levels.mdp.tables import Flags

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
        self.undoings = self._undoings()
        self.idle_openings = self._idle_openings()
        self.idle_walls = self._idle_walls(before)

    def _count(self) -> dict[int, NDArray[np.float64]]:
        """Count walls and openings; return the values that each given `pass` replaces."""
        before = {}
        passes = [np.zeros(sides.shape) for sides in self._base]
        drawn = count_drawn(self._level, "walls")
        for number, wall in enumerate(self._level.walls):
            axis, where = place(wall)
            self._walls[axis][where] += 1
            self._owner[axis][where] = number
            if "pass_" in wall.model_fields_set:
                before[number] = passes[axis][where].copy()
                # The `pass` that a drawing implies never equals one that is given.
                passes[axis][where] = np.nan if number < drawn else wall.pass_
        for opening in self._level.openings:
            axis, where = place(opening)
            self._openings[axis][where] += 1
        return before

    def _undoings(self) -> list[Undoing]:
        found = []
        for number, opening in enumerate(self._level.openings):
            axis, where = place(opening)
            owner = self._owner[axis][where]
            for wall in np.unique(owner[(owner >= 0) & ~self._hidden[axis][where]]).tolist():
                rest = self._walls[axis][where] - (owner == wall) > 0
                idle = not self._removes_wall(axis, where, self._base[axis][where] | rest)
                found.append(Undoing(number, wall, self._is_undone(wall), idle))
        return found

    def _is_undone(self, number: int) -> bool:
        """Return whether openings leave nothing of a wall that would not exist without it."""
        wall = self._level.walls[number]
        axis, where = place(wall)
        gone = (self._openings[axis][where] > 0) | self._hidden[axis][where]
        if "pass_" not in wall.model_fields_set and not _has_looks(wall):
            gone |= self._base[axis][where] | (self._walls[axis][where] > 1)
        return bool(gone.all())

    def _idle_openings(self) -> list[int]:
        found = []
        for number, opening in reversed([*enumerate(self._level.openings)]):
            axis, where = place(opening)
            if not self._removes_wall(axis, where, self._is_wall(axis, where)):
                found.append(number)
                self._openings[axis][where] -= 1
        return found[::-1]

    def _idle_walls(self, before: dict[int, NDArray[np.float64]]) -> list[int]:
        found = []
        later = [np.zeros(sides.shape, bool) for sides in self._base]
        drawn = count_drawn(self._level, "walls")
        for number, wall in reversed([*enumerate(self._level.walls)][drawn:]):
            axis, where = place(wall)
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


def place(entry: Opening) -> Place:
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
