"""The ASCII drawing of a level, both ways: text to `Drawing` and back.

Corners are `+`; `---` and `|` are walls, `- -` and `:` walls of glass, `-/-` and `/` doors. A cell
is three characters wide, and its middle one says what it is. Composing and parsing are each other's
inverse. `runs`, `consecutive` and `rectangles` take neighbours together.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import add
from typing import Any, TypeVar

from babyrobot_levels.text.diagnostics import Mark

BLOCKED, PLAIN, START, EXIT, SMALL, LARGE = "#", " ", "S", "E", "o", "O"
BOX, TARGET, COVERED = "$", ".", "*"
"""A box, a target, and a target with a box on it, unless the legend says something else."""

RESERVED = frozenset("#SEoO+-|: ")
"""Characters that a legend cannot define."""

SOLID, GLASS, DOOR, OPEN = "|", ":", "/", " "
"""The marks of a side, in both directions."""

HORIZONTAL = {"---": SOLID, "- -": GLASS, "-/-": DOOR, "   ": OPEN}
"""The marks of the sides below cells, as they are drawn."""

_BLOCK_CHARACTERS = frozenset("#. @$*SEXGFH01")
"""What such maps are drawn with."""

_HORIZONTAL_TEXT = {mark: text for text, mark in HORIZONTAL.items()}


@dataclass(frozen=True, slots=True)
class Drawing:
    """A drawing without its lines and corners.

    `cells[y][x]` is the middle character of a cell; `east[y][x]` is the mark between (x, y) and
    its eastern neighbour, `south[y][x]` the one below it: `SOLID`, `GLASS`, `DOOR` or `OPEN`.
    """

    cells: tuple[str, ...]
    east: tuple[str, ...]
    south: tuple[str, ...]

    @property
    def width(self) -> int:
        """The number of columns."""
        return len(self.cells[0])

    @property
    def height(self) -> int:
        """The number of rows."""
        return len(self.cells)

    def find(self, character: str) -> list[tuple[int, int]]:
        """Return the cells `(x, y)` that show the character, in reading order."""
        return cells_with(self.cells, character)

    def row_runs(self, character: str) -> Iterator[tuple[tuple[int, int], int]]:
        """Yield the cells that show the character, those side by side as one with a length."""
        for y, row in enumerate(self.cells):
            for x, length in runs(row, character):
                yield (x, y), length

    def runs(self, mark: str) -> Iterator[tuple[tuple[int, int], str, int]]:
        """Yield the walls of one mark as `(cell, side, length)`: S walls by row, E by column."""
        for y, row in enumerate(self.south):
            for x, length in runs(row, mark):
                yield (x, y), "S", length
        for x in range(self.width - 1):
            for y, length in runs((row[x] for row in self.east), mark):
                yield (x, y), "E", length


def is_block_map(lines: Iterable[str]) -> bool:
    """Tell whether lines are a map of another program, in which a wall takes a whole cell."""
    text = "".join(lines)
    return "##" in text and _BLOCK_CHARACTERS.issuperset(text)


def compose(drawing: Drawing) -> str:
    """Return the drawing as text; each line ends with a newline."""
    border = "+" + "---+" * drawing.width
    lines = [border]
    for y, cells in enumerate(drawing.cells):
        shown = {cell: "###" if cell == BLOCKED else f" {cell} " for cell in set(cells)}
        marks = drawing.east[y] + SOLID
        lines.append(SOLID + "".join(map(add, map(shown.__getitem__, cells), marks)))
        if y < drawing.height - 1:
            lines.append("+" + "+".join(map(_HORIZONTAL_TEXT.__getitem__, drawing.south[y])) + "+")
    return "\n".join([*lines, border, ""])


def together(one: str, other: str) -> str | None:
    """Return the mark of a cell with what two marks show, None if there is none."""
    if PLAIN in (one, other):
        return one if other == PLAIN else other
    return COVERED if {one, other} == {BOX, TARGET} else None


def mark_of(text: str, x: int, y: int, side: str | None = None) -> Mark:
    """Return where a drawing shows a cell, or its side E or S."""
    first, indent, _ = framed(text)
    row, column = first + 2 * y + 1, indent + 4 * x + 1
    if side == "E":
        return Mark(row, column + 3, 1)
    return Mark(row + (side == "S"), column, 3)


def framed(text: str) -> tuple[int, int, list[str]]:
    """Return the number of the drawing's first row, its indentation, and its rows without it."""
    rows = [row.rstrip() for row in text.split("\n")]
    first = next((number for number, row in enumerate(rows) if row), 0)
    while rows and not rows[-1]:
        rows.pop()
    rows = rows[first:]
    indent = min((len(row) - len(row.lstrip(" ")) for row in rows if row), default=0)
    return first, indent, [row[indent:] for row in rows]


Item = TypeVar("Item")


def cells_with(rows: Iterable[Iterable[str]], mark: str) -> list[tuple[int, int]]:
    """Return the places `(x, y)` of a mark in rows of marks, in reading order."""
    return [(x, y) for y, row in enumerate(rows) for x, each in enumerate(row) if each == mark]


def runs(values: Iterable[object], wanted: object) -> Iterator[tuple[int, int]]:
    """Yield start and length of each run of values that equal `wanted`."""
    start, index = None, -1
    for index, value in enumerate(values):
        if value == wanted:
            if start is None:
                start = index
        elif start is not None:
            yield start, index - start
            start = None
    if start is not None:
        yield start, index + 1 - start


def consecutive(
    items: Iterable[Item], position: Callable[[Item], tuple[Any, int]]
) -> Iterator[list[Item]]:
    """Yield lists of items that follow each other.

    Args:
        items: the items, sorted by their positions.
        position: returns an item's line and its place on that line. Items are in the same list
            if they are on the same line and each is one place after the one before.
    """

    def line_and_start(numbered: tuple[int, Item]) -> tuple[Any, int]:
        index, item = numbered
        line, place = position(item)
        return line, place - index

    for _, run in groupby(enumerate(items), line_and_start):
        yield [item for _, item in run]


def rectangles(flags: Sequence[int], width: int) -> Iterator[tuple[int, int, int, int]]:
    """Yield rectangles `(x, y, columns, rows)` that together cover the cells whose flag is 1.

    Args:
        flags: 0 or 1 for each cell, row by row.
        width: the number of cells in a row.
    """
    growing: dict[tuple[int, int], tuple[int, int]] = {}
    for y in range(len(flags) // width + 1):
        found = dict.fromkeys(runs(flags[y * width : (y + 1) * width], 1))
        for run in [run for run in growing if run not in found]:
            first, rows = growing.pop(run)
            yield run[0], first, run[1], rows
        for run in found:
            first, rows = growing.get(run, (y, 0))
            growing[run] = first, rows + 1
