"""Where entries stand: sides of cells in a line, and rectangles of cells."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import chain
from typing import Any, Literal, NamedTuple, Self

from babyrobot_levels.language.base import SIDE_NAMES
from babyrobot_levels.language.drawing import rectangles
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


def cut_sides(entries: list[Entry], run: Run, keep: Entry | None = None) -> None:
    """Take the sides of a run out of entries, of which up to two shorter ones are left.

    Args:
        entries: the entries, changed in place.
        run: the run.
        keep: an entry that stays as it is.
    """
    parts = ([entry] if entry is keep else _pieces(entry, run) for entry in entries)
    entries[:] = chain.from_iterable(parts)


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


# -- rectangles --------------------------------------------------------------------------


class Box(NamedTuple):
    """A rectangle of cells."""

    x: int
    y: int
    columns: int
    rows: int

    @classmethod
    def of(cls, entry: Entry) -> Box:
        """Return the rectangle of an entry."""
        (x, y), (columns, rows) = entry["at"], entry.get("size", (1, 1))
        return cls(int(x), int(y), int(columns), int(rows))

    @classmethod
    def between(cls, one: Cell, other: Cell) -> Box:
        """Return the rectangle of which two cells are opposite corners."""
        (left, right), (top, bottom) = (sorted(pair) for pair in zip(one, other, strict=True))
        return cls(left, top, right - left + 1, bottom - top + 1)

    @property
    def cells(self) -> Iterator[Cell]:
        """The cells, row by row."""
        for y in range(self.y, self.y + self.rows):
            for x in range(self.x, self.x + self.columns):
                yield x, y

    def has(self, cell: Cell) -> bool:
        """Tell whether a cell is one of it."""
        x, y = cell[0] - self.x, cell[1] - self.y
        return 0 <= x < self.columns and 0 <= y < self.rows

    def within(self, other: Box) -> Box | None:
        """Return what two rectangles have in common; None if they have no cell."""
        x, y = max(self.x, other.x), max(self.y, other.y)
        columns = min(self.x + self.columns, other.x + other.columns) - x
        rows = min(self.y + self.rows, other.y + other.rows) - y
        return Box(x, y, columns, rows) if columns > 0 and rows > 0 else None

    def joined(self, other: Box) -> Box | None:
        """Return the rectangle that two of them side by side make together, if they make one."""
        for one, two in ((self, other), (other, self)):
            if (one.x, one.columns, one.y + one.rows) == (two.x, two.columns, two.y):
                return Box(one.x, one.y, one.columns, one.rows + two.rows)
            if (one.y, one.rows, one.x + one.columns) == (two.y, two.rows, two.x):
                return Box(one.x, one.y, one.columns + two.columns, one.rows)
        return None

    def put(self, entry: Entry) -> Entry:
        """Return an entry with this rectangle instead of its own."""
        fields = {"at": [self.x, self.y], "size": [self.columns, self.rows], **entry}
        fields |= {"at": [self.x, self.y], "size": [self.columns, self.rows]}
        if (self.columns, self.rows) == (1, 1):
            del fields["size"]
        return fields


def boxes_of(cells: Iterable[Cell]) -> list[Box]:
    """Return rectangles that together have some cells."""
    found = {*cells}
    if not found:
        return []
    left, top = (min(each) for each in zip(*found, strict=True))
    right, bottom = (max(each) for each in zip(*found, strict=True))
    columns = right - left + 1
    flags = bytearray(columns * (bottom - top + 1))
    for x, y in found:
        flags[(y - top) * columns + x - left] = 1
    return [
        Box(left + x, top + y, width, height) for x, y, width, height in rectangles(flags, columns)
    ]


def cut_boxes(entries: list[Entry], cells: set[Cell], where: Callable[[Entry], bool]) -> None:
    """Take cells out of rectangles, each of which leaves smaller ones. A label stays with one.

    Args:
        entries: the entries, changed in place.
        cells: the cells.
        where: which of the entries are cut.
    """
    left = []
    for entry in entries:
        box = Box.of(entry)
        if cells.isdisjoint(box.cells) or not where(entry):
            left.append(entry)
            continue
        rest = boxes_of(cell for cell in box.cells if cell not in cells)
        plain = {name: value for name, value in entry.items() if name != "label"}
        left += [each.put(plain if number else entry) for number, each in enumerate(rest)]
    entries[:] = left


def add_box(entries: list[Entry], box: Box, fields: Entry, *, in_order: bool) -> None:
    """Add a rectangle; entries that are like it and lie beside it become one with it.

    Args:
        entries: the entries, changed in place.
        box: the rectangle.
        fields: the entry's further fields.
        in_order: whether later entries win over earlier ones. Then none grows below another.
    """
    place = len(entries)
    found = _beside(entries, box, fields, in_order)
    while found is not None:
        place, box = found
        fields = entries.pop(place)
        found = None if in_order else _beside(entries, box, fields, in_order)
    entries.insert(place, box.put(fields))


def _beside(
    entries: list[Entry], box: Box, fields: Entry, in_order: bool
) -> tuple[int, Box] | None:
    """Return the number of an entry that can grow by a rectangle, and what it becomes."""
    for index in reversed(range(len(entries))):
        other = Box.of(entries[index])
        union = box.joined(other)
        if union is not None and traits_of(entries[index]) == traits_of(fields):
            return index, union
        if in_order and box.within(other) is not None:
            return None
    return None


def traits_of(entry: Entry) -> Entry:
    """Return the fields of an entry without its place."""
    return {name: value for name, value in entry.items() if name not in ("at", "size")}
