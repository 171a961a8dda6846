"""The ASCII drawing of a level, both ways: text to `Drawing` and back.

Corners are `+`; `---` and `|` are walls, `- -` and `:` walls of glass, `-/-` and `/` doors. A cell
is three characters wide, and its middle one says what it is. Composing and parsing are each other's
inverse. `runs`, `consecutive` and `rectangles` take neighbours together.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import add
from typing import Any, TypeVar

from babyrobot_levels.text.diagnostics import Issue, Mark

BLOCKED, PLAIN, START, EXIT, SMALL, LARGE = "#", " ", "S", "E", "o", "O"
RESERVED = frozenset("#SEoO+-|: ")
"""Characters that a legend cannot define."""

MAX_PROBLEMS = 100
"""At most so many errors are reported per drawing."""

SOLID, GLASS, DOOR, OPEN = "|", ":", "/", " "
"""The marks of a side, in both directions."""

_HORIZONTAL = {"---": SOLID, "- -": GLASS, "-/-": DOOR, "   ": OPEN}
_BLOCK_CHARACTERS = frozenset("#. @$*SEXGFH01")
"""What such maps are drawn with."""

_HORIZONTAL_TEXT = {mark: text for text, mark in _HORIZONTAL.items()}


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
        return [
            (x, y)
            for y, row in enumerate(self.cells)
            for x, shown in enumerate(row)
            if shown == character
        ]

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
            below = map(_HORIZONTAL_TEXT.__getitem__, drawing.south[y])
            lines.append("+" + "+".join(below) + "+")
    return "\n".join([*lines, border, ""])


def parse(
    text: str, is_known: Callable[[str], bool], max_size: int
) -> tuple[Drawing | None, list[Issue]]:
    """Return the drawing that `text` shows, or None and its errors.

    `is_known` tells whether the legend defines a character. Blank lines around the drawing,
    blanks at the ends of its lines and a common indentation do not count.
    """
    return _Parser(text, is_known, max_size).parse()


def mark_of(text: str, x: int, y: int, side: str | None = None) -> Mark:
    """Return where a drawing shows a cell, or its side E or S."""
    first, indent, _ = _framed(text)
    row, column = first + 2 * y + 1, indent + 4 * x + 1
    if side == "E":
        return Mark(row, column + 3, 1)
    return Mark(row + (side == "S"), column, 3)


def _framed(text: str) -> tuple[int, int, list[str]]:
    """Return the number of the drawing's first row, its indentation, and its rows without it."""
    rows = [row.rstrip() for row in text.split("\n")]
    first = next((number for number, row in enumerate(rows) if row), 0)
    while rows and not rows[-1]:
        rows.pop()
    rows = rows[first:]
    indent = min((len(row) - len(row.lstrip(" ")) for row in rows if row), default=0)
    return first, indent, [row[indent:] for row in rows]


class _Parser:
    def __init__(self, text: str, is_known: Callable[[str], bool], max_size: int):
        self.first, self.indent, self.rows = _framed(text)
        self.is_known = is_known
        self.max_size = max_size
        self.issues: list[Issue] = []

    @property
    def is_full(self) -> bool:
        return len(self.issues) >= MAX_PROBLEMS

    def parse(self) -> tuple[Drawing | None, list[Issue]]:
        if not self._check_frame():
            return None, self.issues
        width = len(self.rows[0]) // 4
        cells, east, south = [], [], []
        for number, row in enumerate(self.rows):
            if self.is_full:
                break
            if number % 2:
                shown, marks = self._cell_row(number, row, width)
                cells.append(shown)
                east.append(marks)
            else:
                line = self._wall_row(number, row, width)
                if 0 < number < len(self.rows) - 1:
                    south.append(line)
        if self.issues:
            return None, self.issues
        return Drawing(tuple(cells), tuple(east), tuple(south)), []

    def _report(
        self, row: int, column: int, length: int, message: str, help_text: str | None = None
    ) -> None:
        if self.is_full:
            return
        self.issues.append(
            Issue(
                "BR312",
                Mark(self.first + row, self.indent + column, max(length, 1)),
                message,
                help_text,
            )
        )

    def _check_frame(self) -> bool:
        """Check the outline: odd numbers of lines, of one length, that fit whole cells."""
        if not self.rows:
            self._report(0, 0, 1, "the drawing is empty", "draw at least one cell")
            return False
        length = len(self.rows[0])
        if is_block_map(self.rows):
            message = "this is a map of blocks, in which a wall takes a whole cell"
            self._report(0, 0, length, message, "convert it with `babyrobot import`")
            return False
        if length < 5 or length % 4 != 1 or self.rows[0][0] in (SOLID, GLASS):
            self._report(
                0,
                0,
                length,
                "the first line of the drawing is not a wall of the form `+---+---+`",
                "write `+---` for each cell and a final `+`",
            )
            return False
        for number, row in enumerate(self.rows):
            if len(row) != length and not self.is_full:
                self._report(
                    number,
                    min(len(row), length),
                    max(len(row) - length, 1),
                    f"this line has {len(row)} characters, the first one has {length}",
                    "draw each cell three characters wide, with one character between cells",
                )
        if len(self.rows) < 3 or len(self.rows) % 2 == 0:
            self._report(
                len(self.rows) - 1,
                0,
                len(self.rows[-1]),
                "the drawing ends in the middle of a row of cells",
                "add a line of `+` and walls below each line of cells",
            )
        height = len(self.rows) // 2
        if max(length // 4, height) > self.max_size:
            most = self.max_size
            self._report(0, 0, length, f"the level has more than {most} columns or rows")
        return not self.issues

    def _wall_row(self, number: int, row: str, width: int) -> str:
        marks = []
        outer = number in (0, len(self.rows) - 1)
        for x in range(width + 1):
            if row[4 * x] != "+":
                self._report(number, 4 * x, 1, f"expected the corner `+`, found `{row[4 * x]}`")
        for x in range(width):
            text = row[4 * x + 1 : 4 * x + 4]
            mark = _HORIZONTAL.get(text)
            if mark is None:
                self._report(
                    number,
                    4 * x + 1,
                    3,
                    f"`{text}` is not a wall",
                    "use `---` for a wall, `- -` for glass, `-/-` for a door, "
                    "three spaces for no wall",
                )
            elif outer and mark != SOLID:
                self._report_outer(number, 4 * x + 1, 3)
            marks.append(mark or OPEN)
        return "".join(marks)

    def _cell_row(self, number: int, row: str, width: int) -> tuple[str, str]:
        marks = []
        for x in range(width + 1):
            mark = row[4 * x]
            if mark not in (SOLID, GLASS, DOOR, OPEN):
                self._report(
                    number,
                    4 * x,
                    1,
                    f"`{mark}` cannot be between two cells",
                    "use `|` for a wall, `:` for glass, `/` for a door, a space for no wall",
                )
                mark = SOLID
            elif x in (0, width) and mark != SOLID:
                self._report_outer(number, 4 * x, 1)
            marks.append(mark)
        cells = [self._cell(number, 4 * x + 1, row[4 * x + 1 : 4 * x + 4]) for x in range(width)]
        return "".join(cells), "".join(marks[1:-1])

    def _cell(self, number: int, column: int, text: str) -> str:
        if text == "###":
            return BLOCKED
        middle = text[1]
        if text[0] != " " or text[2] != " ":
            self._report(
                number,
                column,
                3,
                f"`{text}` is not a cell",
                "write `###`, or one character between two spaces",
            )
        elif middle not in (PLAIN, START, EXIT, SMALL, LARGE) and not self.is_known(middle):
            self._report(
                number,
                column + 1,
                1,
                f"`{middle}` is not in the legend",
                "built in: S start, E exit, o small puddle, O large puddle, ### blocked",
            )
        return middle

    def _report_outer(self, number: int, column: int, length: int) -> None:
        self._report(number, column, length, "the outer wall must be solid")


Item = TypeVar("Item")


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
