"""What of a level stands in its drawing, and where."""

from __future__ import annotations

from babyrobot_levels.library.level import Level

Mark = tuple[int, int, int]
"""Line and character of the drawing's text (from 0), and how many characters."""


def count_drawn(level: Level, field: str) -> int:
    """Return how many of the first entries of a list come from the drawing."""
    return len(getattr(level, field)) - sum(1 for _ in level.written(field))


def cell_mark(level: Level, x: int, y: int) -> Mark:
    """Return where a drawing shows a cell."""
    row, column = _corner(level)
    # Two lines and four characters a cell, of which three are its own.
    return row + 2 * y + 1, column + 4 * x + 1, 3


def side_mark(level: Level, x: int, y: int, side: str) -> Mark:
    """Return where a drawing shows the eastern or the southern side of a cell."""
    row, column, length = cell_mark(level, x, y)
    return (row, column + 3, 1) if side == "E" else (row + 1, column, length)


def _corner(level: Level) -> tuple[int, int]:
    """Return line and character at which a drawing begins: blank lines and blanks do not count."""
    rows = [row.rstrip() for row in (level.map or "").split("\n")]
    first = next((number for number, row in enumerate(rows) if row), 0)
    return first, min((len(row) - len(row.lstrip(" ")) for row in rows if row), default=0)
