"""Sides of cells in a line: where entries of walls, openings and doors run."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Literal, Self

from babyrobot_levels.language.base import SIDE_NAMES
from babyrobot_levels.language.geometry import Cell

Entry = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Run:
    """Sides in a line, each named as the E or S side of a cell.

    Attributes:
        axis: E for sides to the east of cells, S for sides below them.
        line: the column (E) or the row (S) of these cells. -1 for the outer wall at the west or
            the north.
        first: the row (E) or the column (S) of the first of them.
        stop: that behind the last one.
    """

    axis: Literal["E", "S"]
    line: int
    first: int
    stop: int

    @classmethod
    def of(cls, at: Iterable[float], side: str, length: float = 1) -> Self:
        """Return the run of an entry's fields."""
        x, y = map(int, at)
        side = SIDE_NAMES.get(side, side)
        if side in ("E", "W"):
            return cls("E", x - (side == "W"), y, y + int(length))
        return cls("S", y - (side == "N"), x, x + int(length))

    @classmethod
    def of_entry(cls, entry: Entry) -> Self:
        """Return the run of an entry."""
        return cls.of(entry["at"], entry["side"], entry.get("length", 1))

    @property
    def cells(self) -> list[Cell]:
        """The cells whose E or S sides these are."""
        return [self.cell(place) for place in range(self.first, self.stop)]

    def cell(self, place: int) -> Cell:
        """Return the cell whose E or S side is at a place from `first` on."""
        return (self.line, place) if self.axis == "E" else (place, self.line)

    def part(self, first: int, stop: int) -> Run:
        """Return the part from one place to before another one."""
        return Run(self.axis, self.line, max(first, self.first), min(stop, self.stop))

    def entry(self, **fields: Any) -> Entry:
        """Return an entry with this run and further fields."""
        side: str = self.axis
        x, y = self.cell(self.first)
        if self.line < 0:
            side, x, y = ("W", 0, y) if side == "E" else ("N", x, 0)
        length = {} if self.stop - self.first == 1 else {"length": self.stop - self.first}
        return {"at": [x, y], "side": side, **length, **fields}


def cut(entries: list[Entry], run: Run, keep: Entry | None = None) -> None:
    """Take the sides of a run out of entries, of which up to two shorter ones are left.

    Args:
        entries: the entries, changed in place.
        run: the run.
        keep: an entry that stays as it is.
    """
    left = []
    for entry in entries:
        left += [entry] if entry is keep else _pieces(entry, run)
    entries[:] = left


def _pieces(entry: Entry, run: Run) -> list[Entry]:
    """Return what is left of an entry without the sides of a run."""
    own = Run.of_entry(entry)
    if (own.axis, own.line) != (run.axis, run.line):
        return [entry]
    if own.stop <= run.first or run.stop <= own.first:
        return [entry]
    pieces = [own.part(own.first, run.first), own.part(run.stop, own.stop)]
    return [placed(entry, piece) for piece in pieces if piece.first < piece.stop]


def placed(entry: Entry, run: Run) -> Entry:
    """Return an entry with another run, on the side that it names."""
    x, y = run.cell(run.first)
    side = SIDE_NAMES.get(entry["side"], entry["side"])
    at = [x + (side == "W"), y + (side == "N")]
    fields = {"at": at, "side": entry["side"], "length": 0, **entry}
    fields |= {"at": at, "length": run.stop - run.first}
    if fields["length"] == 1:
        del fields["length"]
    return fields
