"""What each wall and each opening of a level does to the grid, beside all the others.

Entries are looked at from the last one to the first, and one that does nothing counts as gone
from then on. So of two that say the same the later one is told, and all that are told can go
together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.walls import Opening, Wall
from babyrobot_levels.library.level import Level
from babyrobot_levels.lint.drawn import count_drawn
from babyrobot_levels.mdp.grid import BIT, Grid

Flags = NDArray[np.bool_]
Numbers = NDArray[np.int32]
Place = tuple[int, tuple[slice, slice]]
"""Sides that lie in a row: 0 for sides across (N and S) or 1 for sides that run down, and where."""


@dataclass(frozen=True, slots=True)
class Undoing:
    """An opening that takes a wall of the level away.

    Attributes:
        opening: its number.
        wall: the number of the wall.
        wholly: whether nothing is left of it that would not be there anyway.
        idle: whether without that wall the opening would take nothing away.
    """

    opening: int
    wall: int
    wholly: bool
    idle: bool


class Barriers:
    """The walls and openings of a level that do nothing, or undo each other.

    Numbers count the level's walls and openings from 0, those of its drawing included.

    Attributes:
        idle_walls: walls without which grid and picture would be the same. Those that an opening
            takes away are not among them.
        idle_openings: openings without which grid and picture would be the same.
        undoings: openings that take walls of the level away.
    """

    def __init__(self, level: Level, bare: Grid) -> None:
        """Look at a level.

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
        """Count walls and openings; return what each `pass` that is given takes the place of."""
        before = {}
        passes = [np.zeros(sides.shape) for sides in self._base]
        drawn = count_drawn(self._level, "walls")
        for number, wall in enumerate(self._level.walls):
            way, where = place(wall)
            self._walls[way][where] += 1
            self._owner[way][where] = number
            if "pass_" in wall.model_fields_set:
                before[number] = passes[way][where].copy()
                # What a drawing leaves open is never the same as what an entry says.
                passes[way][where] = np.nan if number < drawn else wall.pass_
        for opening in self._level.openings:
            way, where = place(opening)
            self._openings[way][where] += 1
        return before

    def _undoings(self) -> list[Undoing]:
        found = []
        for number, opening in enumerate(self._level.openings):
            way, where = place(opening)
            owner = self._owner[way][where]
            for wall in np.unique(owner[(owner >= 0) & ~self._hidden[way][where]]).tolist():
                rest = self._walls[way][where] - (owner == wall) > 0
                idle = not self._takes_away(way, where, self._base[way][where] | rest)
                found.append(Undoing(number, wall, self._is_undone(wall), idle))
        return found

    def _is_undone(self, number: int) -> bool:
        """Tell whether openings leave nothing of a wall, or nothing that is not there anyway."""
        wall = self._level.walls[number]
        way, where = place(wall)
        gone = (self._openings[way][where] > 0) | self._hidden[way][where]
        if "pass_" not in wall.model_fields_set and not _has_looks(wall):
            gone |= self._base[way][where] | (self._walls[way][where] > 1)
        return bool(gone.all())

    def _idle_openings(self) -> list[int]:
        found = []
        for number, opening in reversed([*enumerate(self._level.openings)]):
            way, where = place(opening)
            if not self._takes_away(way, where, self._is_wall(way, where)):
                found.append(number)
                self._openings[way][where] -= 1
        return found[::-1]

    def _idle_walls(self, before: dict[int, NDArray[np.float64]]) -> list[int]:
        found = []
        later = [np.zeros(sides.shape, bool) for sides in self._base]
        drawn = count_drawn(self._level, "walls")
        for number, wall in reversed([*enumerate(self._level.walls)][drawn:]):
            way, where = place(wall)
            opened = self._openings[way][where] > 0
            stands = ~opened & ~self._hidden[way][where]
            alone = stands & ~self._base[way][where] & (self._walls[way][where] == 1)
            matters = bool(alone.any() or opened.any())
            if number in before:
                new = before[number] != wall.pass_
                joins = self._joins[way][where]
                matters = matters or bool((stands & joins & new & ~later[way][where]).any())
            if matters or (_has_looks(wall) and stands.any()):
                later[way][where] |= number in before
            else:
                found.append(number)
                self._walls[way][where] -= 1
        return found[::-1]

    def _is_wall(self, way: int, where: tuple[slice, slice]) -> Flags:
        return self._base[way][where] | (self._walls[way][where] > 0)

    def _takes_away(self, way: int, where: tuple[slice, slice], walls: Flags) -> bool:
        """Tell whether there is a wall that no other opening takes away."""
        alone = self._openings[way][where] == 1
        return bool((walls & alone & ~self._hidden[way][where]).any())


def place(entry: Opening) -> Place:
    """Return where a wall or an opening stands in arrays over the sides of cells.

    Sides across are `[height + 1, width]`, sides that run down `[height, width + 1]`.
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
