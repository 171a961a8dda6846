"""What a rule finds, where it points, and how its message names cells."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, auto

from babyrobot_levels.library.level import Level
from babyrobot_levels.text.diagnostics import Fix, Location, Mark, Severity

MAX_NAMED = 4
"""A message names at most this many cells and gives the number of the others."""


@dataclass(frozen=True, slots=True)
class Finding:
    """One problem that a rule reports.

    Attributes:
        location: where it is; `()` stands for the first field.
        message: the defect.
        help: what to do about it.
        fix: edits that remove the problem.
        severity: the severity, if it differs from the rule's.
    """

    location: Location
    message: str
    help: str | None = None
    fix: Fix | None = None
    severity: Severity | None = None


class Needs(Enum):
    """What a rule needs to check a level."""

    LEVEL = auto()
    """The level and its text."""
    ARRAYS = auto()
    """The same, and NumPy."""
    TABLES = auto()
    """The compiled tables, which a level with random mazes does not have."""
    SIZE = auto()
    """The size of the tables, even if they are too large for rules to read."""


def cells_text(cells: Sequence[tuple[int, int]]) -> str:
    """Return cells as a message names them: `[1, 2]`, `[1, 2] and [1, 3]`, `... and 7 more`."""
    names = [f"[{x}, {y}]" for x, y in cells[:MAX_NAMED]]
    if len(cells) > MAX_NAMED:
        names.append(f"{len(cells) - MAX_NAMED} more")
    if len(names) == 1:
        return names[0]
    return f"{', '.join(names[:-1])} and {names[-1]}"


def cells_count(cells: Sequence[tuple[int, int]]) -> str:
    """Return the number of cells and their names: `cell [1, 2]`, `2 cells ([1, 2] and ...)`."""
    if len(cells) == 1:
        return f"cell {cells_text(cells)}"
    return f"{len(cells)} cells ({cells_text(cells)})"


def count_drawn(level: Level, field: str) -> int:
    """Return how many of the first entries of a list come from the drawing."""
    return len(getattr(level, field)) - sum(1 for _ in level.written(field))


def cell_mark(level: Level, x: int, y: int) -> Mark:
    """Return the position of a cell in the drawing."""
    row, column = _corner(level.map or "")
    # A cell takes two lines and four characters, three of which are its own.
    return Mark(row + 2 * y + 1, column + 4 * x + 1, 3)


def side_mark(level: Level, x: int, y: int, side: str) -> Mark:
    """Return the position of a cell's eastern or southern side in the drawing."""
    cell = cell_mark(level, x, y)
    if side == "E":
        return Mark(cell.row, cell.column + cell.length, 1)
    return Mark(cell.row + 1, cell.column, cell.length)


def marked_at(drawing: str, mark: Mark) -> tuple[int, int, str] | None:
    """Return the cell of which the drawing shows something at a mark, and which of its sides.

    The side is empty at the cell itself. At a corner of cells there is None.
    """
    first, indent = _corner(drawing)
    row, column = mark.row - first, mark.column - indent
    (y, is_row), (x, between) = divmod(row, 2), divmod(column, 4)
    if row < 0 or column < 0 or not (is_row or between):
        return None
    if is_row and between:
        return x, y, ""
    if is_row:
        return (x - 1, y, "E") if x else (x, y, "W")
    return (x, y - 1, "S") if y else (x, y, "N")


def _corner(drawing: str) -> tuple[int, int]:
    """Return line and character of a drawing's top-left corner, after blank lines and indent."""
    rows = [row.rstrip() for row in drawing.split("\n")]
    first = next((number for number, row in enumerate(rows) if row), 0)
    return first, min((len(row) - len(row.lstrip(" ")) for row in rows if row), default=0)
