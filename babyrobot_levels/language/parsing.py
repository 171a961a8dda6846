"""Reading the drawing of a level, and telling what is wrong with one that cannot be read."""

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import islice
from typing import NamedTuple

from babyrobot_levels.language.drawing import (
    BLOCKED,
    BOX,
    COVERED,
    DOOR,
    EXIT,
    GLASS,
    HORIZONTAL,
    LARGE,
    PLAIN,
    SMALL,
    SOLID,
    START,
    TARGET,
    Drawing,
    framed,
    is_block_map,
)
from babyrobot_levels.text.diagnostics import Issue, Mark

MAX_PROBLEMS = 100
"""At most so many errors are reported per drawing."""

_BORDER = re.compile(r"\+(?:---\+)+")
_WALLS = re.compile(r"\+(?:(?:---|- -|-/-|   )\+)+")
_CELLS = re.compile(r"\|(?: [^#] |###)(?:[|:/ ](?: [^#] |###))*\|")
_TOKENS = re.compile(r"#+|-+|[|:/]|[^ |:/#-]+")
"""What stands in a line of cells: blocked cells, dashes, sides, and other characters."""

_BUILT_IN = (
    "S start, E exit, o small puddle, O large puddle, ### blocked, $ box, . target, "
    "* box on a target"
)
_MEANT = {
    "a start is `S`": "sAaPpR@>",
    "an exit is `E`": "eGgXxT",
    "a cell without anything is a space": "F_,",
    "a blocked cell is `###`, all of its three characters": "#BW",
    "a small puddle is `o`, a large one `O`": "0~",
    "a hole is `H: {reward: -1, ends: true}` in `legend`": "H",
}
"""What a character means to those who know other programs."""

_MARKS = frozenset((PLAIN, START, EXIT, SMALL, LARGE, BLOCKED, BOX, TARGET, COVERED))
_SIDES = {SOLID: "a wall", GLASS: "glass", DOOR: "a door"}

_BOXES = re.compile("[\u2500-\u257f]")
_PLAIN_BOXES = dict.fromkeys(range(0x2500, 0x2580), "+") | {
    ord(box): text for text, boxes in (("-", "─━═╌┄┈"), ("|", "│┃║╎┆┊")) for box in boxes
}
_LONGEST = 400
"""In longer lines nobody looks for the place where a character is missing."""


class Fault(NamedTuple):
    """What is wrong at a place of a line, counted from 0."""

    column: int
    length: int
    message: str
    help: str | None = None


IsKnown = Callable[[str], bool]


def parse(text: str, is_known: IsKnown, max_size: int) -> tuple[Drawing | None, list[Issue]]:
    """Return the drawing that `text` shows, or None and its errors.

    `is_known` tells whether the legend defines a character. Blank lines around the drawing,
    blanks at the ends of its lines and a common indentation do not count.

    Where each mark that is out of place is beside it, the first error has a fix that moves all.
    """
    first, indent, rows = framed(text)
    if (drawing := _read(rows, is_known, max_size)) is not None:
        return drawing, []
    issues = [
        Issue("BR312", Mark(first + row, indent + column, max(length, 1)), message, help_text)
        for row, (column, length, message, help_text) in islice(
            _faults(rows, is_known, max_size), MAX_PROBLEMS
        )
    ]
    is_small = len(issues) < MAX_PROBLEMS
    mended = [_mended(row, len(rows[0]), is_known) for row in rows] if is_small else []
    if _read(mended, is_known, max_size) is not None:
        changed = tuple(
            (Mark(first + number, indent, len(row)), new)
            for number, (row, new) in enumerate(zip(rows, mended, strict=True))
            if row != new
        )
        issues[0] = replace(issues[0], redrawn=changed)
    return None, issues


def _read(rows: list[str], is_known: IsKnown, max_size: int) -> Drawing | None:
    """Return what rows show, or None if anything is wrong."""
    if len(rows) < 3 or len(rows) % 2 == 0 or len({len(row) for row in rows}) > 1:
        return None
    width, height = len(rows[0]) // 4, len(rows) // 2
    is_whole = (
        max(width, height) <= max_size
        and _BORDER.fullmatch(rows[0])
        and _BORDER.fullmatch(rows[-1])
        and all(map(_WALLS.fullmatch, rows[2:-1:2]))
        and all(map(_CELLS.fullmatch, rows[1::2]))
    )
    if not is_whole:
        return None
    cells = tuple(row[2::4] for row in rows[1::2])
    if not all(mark in _MARKS or is_known(mark) for mark in set("".join(cells))):
        return None
    east = tuple(row[4:-1:4] for row in rows[1::2])
    south = tuple(
        "".join(HORIZONTAL[row[column : column + 3]] for column in range(1, len(row), 4))
        for row in rows[2:-1:2]
    )
    return Drawing(cells, east, south)


def _faults(rows: list[str], is_known: IsKnown, max_size: int) -> Iterator[tuple[int, Fault]]:
    """Yield what is wrong, and in which row."""
    if (frame := _frame_fault(rows, max_size)) is not None:
        yield frame
        return
    length, above, y = len(rows[0]), "", -1
    for number, row in enumerate(rows):
        is_walls = row.startswith("+") or (not row.startswith("|") and above != "+")
        kind = "+" if is_walls else "|"
        y += not is_walls
        if not row:
            message = "below this line is an empty one"
            yield number - 1, Fault(0, len(rows[number - 1]), message, "remove it")
            continue
        if kind == above:
            yield number, _doubled(row, is_walls)
        elif len(row) != length:
            yield number, _length_fault(row, length, is_walls)
        elif is_walls:
            is_outer = number in (0, len(rows) - 1)
            yield from ((number, fault) for fault in _wall_faults(row, y, is_outer))
        else:
            yield from ((number, fault) for fault in _cell_faults(row, y, is_known))
        above = kind
    if above == "|" or len(rows) == 1:
        message = "the drawing ends in the middle of a row of cells"
        help_text = "add a line of `+` and walls below each line of cells"
        yield len(rows) - 1, Fault(0, len(rows[-1]), message, help_text)


def _frame_fault(rows: list[str], max_size: int) -> tuple[int, Fault] | None:
    """Return why this is no drawing of ours at all; None if it is one."""
    if not rows:
        return 0, Fault(0, 1, "the drawing is empty", "draw at least one cell")
    length = len(rows[0])
    if is_block_map(rows):
        message = "this is a map of blocks, in which a wall takes a whole cell"
        return 0, Fault(0, length, message, "convert it with `babyrobot import`")
    if "S" in (letters := set("".join(rows))) <= set("SFHG"):
        message = "this is a map of FrozenLake, in which each letter is a cell"
        return 0, Fault(0, length, message, "convert it with `babyrobot import`")
    for number, row in enumerate(rows):
        if box := _BOXES.search(row):
            message = f"`{box.group()}` is a box-drawing character"
            help_text = "draw corners with `+`, walls with `---` and `|`"
            return number, Fault(box.start(), 1, message, help_text)
        if "\t" in row:
            help_text = "use spaces: a cell is three characters wide, with one between cells"
            return number, Fault(row.index("\t"), 1, "a drawing has no tabs", help_text)
    if rows[0][0] == SOLID and length % 4 == 1 and length > 4:
        help_text = f"begin with the outer wall, `{'+---' * (length // 4)}+`"
        return 0, Fault(0, length, "the drawing begins with a row of cells", help_text)
    if length < 5 or length % 4 != 1 or "+" not in letters or rows[0][0] in (SOLID, GLASS):
        message = "the first line of the drawing is not a wall of the form `+---+---+`"
        help_text = "write `+---` for each cell and a final `+`"
        if "+" not in "".join(rows):
            help_text += "; a map of other programs is converted with `babyrobot import`"
        return 0, Fault(0, length, message, help_text)
    if max(length // 4, len(rows) // 2) > max_size:
        message = f"the level has more than {max_size} columns or rows"
        return 0, Fault(0, length, message)
    return None


def _doubled(row: str, is_walls: bool) -> Fault:
    if is_walls:
        message = "two lines of walls follow each other"
        return Fault(0, len(row), message, "remove one, or draw the cells between them")
    help_text = f"draw the walls between them, `{'+   ' * (len(row) // 4)}+` for none"
    return Fault(0, len(row), "two lines of cells follow each other", help_text)


def _length_fault(row: str, length: int, is_walls: bool) -> Fault:
    message = f"this line has {len(row)} characters, the first one has {length}"
    if not is_walls and len(row) < length and not row.endswith(SOLID):
        help_text = "end it with `|`: the outer wall is drawn all around"
        return Fault(len(row), 1, message, help_text)
    found = _of_length(row, length, is_walls)
    if found is None:
        help_text = "draw each cell three characters wide, with one character between cells"
        return Fault(min(len(row), length), max(len(row) - length, 1), message, help_text)
    column, change = found[1], length - len(row)
    what = {" ": "space", "-": "dash"}[row[column - 1 if change > 0 else column]]
    amount = f"a {what}" if abs(change) == 1 else f"{abs(change)} {what}s"
    help_text = f"insert {amount} here" if change > 0 else f"remove {amount} here"
    return Fault(column, max(-change, 1), message, help_text)


def _of_length(row: str, length: int, is_walls: bool) -> tuple[str, int] | None:
    """Return a line with as many characters as it should have, and where they are put or go.

    None if that can be done in no way, or in several that differ.
    """
    change = length - len(row)
    if abs(change) > 4 or length > _LONGEST:
        return None
    whole = _WALLS if is_walls else _CELLS
    found: dict[str, int] = {}
    for column in range(1, len(row)):
        if change > 0 and row[column - 1] in " -":
            new = row[:column] + row[column - 1] * change + row[column:]
        elif change < 0 and set(row[column : column - change]) in ({" "}, {"-"}):
            new = row[:column] + row[column - change :]
        else:
            continue
        if whole.fullmatch(new):
            found[new] = column
    return next(iter(found.items())) if len(found) == 1 else None


def _wall_faults(row: str, y: int, is_outer: bool) -> Iterator[Fault]:
    width = len(row) // 4
    displaced = set()
    for x in range(width + 1):
        column = 4 * x
        if row[column] == "+":
            continue
        beside = [each for each in (column + 1, column - 1) if row[each : each + 1] == "+"]
        if beside:
            displaced |= {x - 1, x}
            yield _beside(beside[0], "+", beside[0] - column, "where a corner is")
        else:
            message = f"expected the corner `+`, found `{row[column]}`"
            yield Fault(column, 1, message, "draw a `+` at each corner of a cell")
    for x in range(width):
        text = row[4 * x + 1 : 4 * x + 4]
        if x in displaced:
            continue
        if text not in HORIZONTAL:
            yield _no_wall(4 * x + 1, text, (x, y))
        elif is_outer and text != "---":
            yield _outer(4 * x + 1, 3)


def _no_wall(column: int, text: str, cell: tuple[int, int]) -> Fault:
    mark = text.strip()
    if len(mark) == 1 and (mark in _MARKS or mark.isalnum()):
        above, below = f"[{cell[0]}, {cell[1]}]", f"[{cell[0]}, {cell[1] + 1}]"
        message = f"`{mark}` is between the cells {above} and {below}"
        help_text = "move it one line up or down, to the middle of a cell"
        return Fault(column + text.index(mark), 1, message, help_text)
    help_text = "use `---` for a wall, `- -` for glass, `-/-` for a door, three spaces for no wall"
    return Fault(column, 3, f"`{text}` is not a wall", help_text)


def _cell_faults(row: str, y: int, is_known: IsKnown) -> Iterator[Fault]:
    for column in (0, len(row) - 1):
        if row[column] in (PLAIN, GLASS, DOOR):
            yield _outer(column, 1)
    for token in _TOKENS.finditer(row):
        column, text = token.start(), token.group()
        off = _off(text, column, is_known)
        if text[0] == "-":
            help_text = "draw walls between rows of cells in the lines of `+`"
            yield Fault(column, len(text), f"`{text}` is in a line of cells", help_text)
        elif text[0] == "#" and text != "###":
            yield Fault(column, len(text), f"`{text}` is not a cell", _hint("#"))
        elif len(text) > 1 and text != "###":
            message = f"`{text}` is more than one character"
            yield Fault(column, len(text), message, "draw one character in the middle of a cell")
        elif off == 2:
            yield _between(column, text, y, is_known)
        elif off:
            yield _beside(column, text, off, _place(column - off, text, y, len(row)))
        elif text not in (*_MARKS, *_SIDES, "###") and not is_known(text):
            yield Fault(column, 1, f"`{text}` is not in the legend", _hint(text))


def _off(text: str, column: int, is_known: IsKnown) -> int:
    """Return how many columns right of its place a mark is: -1, 0 or 1; 2 is as far to both."""
    if text in _SIDES and not (column % 4 == 2 and is_known(text)):
        return (column + 1) % 4 - 1
    return (column - (1 if text == "###" else 2) + 1) % 4 - 1


def _place(column: int, text: str, y: int, length: int) -> str:
    x = column // 4
    if text not in _SIDES:
        return f"the middle of the cell [{x}, {y}]"
    if column in (0, length - 1):
        return "the outer wall"
    return f"the line between the cells [{x - 1}, {y}] and [{x}, {y}]"


def _between(column: int, text: str, y: int, is_known: IsKnown) -> Fault:
    if (what := _SIDES.get(text)) is not None:
        message = f"`{text}` is in the middle of the cell [{column // 4}, {y}]"
        help_text = f"{what} stands between two cells: move it two columns"
        return Fault(column, 1, message, help_text)
    message = f"`{text}` is between two cells"
    help_text = "move it to the middle of a cell; between cells are `|` walls, `:` glass, `/` doors"
    return Fault(column, len(text), message, help_text)


def _hint(mark: str) -> str:
    if (meant := next((text for text, marks in _MEANT.items() if mark in marks), None)) is not None:
        return meant
    if mark.isascii() and mark.isalnum():
        return f"define it, as in `legend: {{{mark}: {{item: key}}}}`; built in: {_BUILT_IN}"
    return f"built in: {_BUILT_IN}"


def _beside(column: int, text: str, off: int, place: str) -> Fault:
    """Return the fault of what is one column beside its place."""
    where, back = ("right", "left") if off > 0 else ("left", "right")
    message = f"`{text}` is one column {where} of {place}"
    return Fault(column, len(text), message, f"move it one column to the {back}")


def _outer(column: int, length: int) -> Fault:
    help_text = "draw it with `---` and `|` all around; an exit is a cell, `E`"
    return Fault(column, length, "the outer wall must be solid", help_text)


def _mended(row: str, length: int, is_known: IsKnown) -> str:
    """Return a line in which what is one column beside its place is moved there, if it can be."""
    row = row.translate(_PLAIN_BOXES)
    is_walls = row.startswith("+")
    if len(row) != length:
        found = _of_length(row, length, is_walls)
        return row if found is None else found[0]
    if is_walls:
        return row
    moved = [" "] * length
    for token in _TOKENS.finditer(row):
        text, off = token.group(), _off(token.group(), token.start(), is_known)
        column = token.start() - off
        if off == 2 or any(each != " " for each in moved[column : column + len(text)]):
            return row
        moved[column : column + len(text)] = text
    return "".join(moved)
