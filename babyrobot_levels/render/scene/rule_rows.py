"""Where rules stand in a box: rows of a sample with lines of text beside it, in columns."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import NamedTuple

SAMPLE = 18.0
"""The side of a sample in pixels."""

RULE_SIZE = 11.5
"""The font size."""

RULE_LINE = 14.0
"""The height of a line."""

NARROWEST = 130.0
"""The least width of a box for rules."""

_EDGE, _GAP, _BETWEEN = 10.0, 8.0, 5.0
"""The padding of a box, and the distances between a sample and its text, and between two rows."""

TEXT_LEFT = SAMPLE + _GAP
"""The distance of a text from the left edge of its row."""

_COLUMN = 230.0
"""The least width of one of several columns."""

_ROUNDING = 1e-6
"""A box as high as its rules may be lower by rounding."""

_CHARACTER_WIDTH = 0.54
"""The average width of a character, as a share of the font size."""

_SCALES = (1.0, 0.9, 0.8, 0.7)
"""The scales of rules in a box that is given, from the largest: smaller letters are not read."""


class Row(NamedTuple):
    """A rule in a box.

    Attributes:
        rule: its number.
        left: its left edge, counted from that of the box.
        top: its upper edge, likewise.
        lines: the lines of its text.
    """

    rule: int
    left: float
    top: float
    lines: Sequence[str]


def height_for(texts: Sequence[str], width: float) -> float:
    """Return the height of a box in which all rules have room."""
    heights = list(map(_height, _wrapped(texts, width)))
    room = max(heights, default=0.0)
    while not _fits(heights, room, _columns(width)):
        room += 1.0
    return room - _BETWEEN + 2 * _EDGE


def scale_for(texts: Sequence[str], width: float, height: float) -> float | None:
    """Return the largest scale at which all rules have room in a box; None if there is none."""
    fits = (each for each in _SCALES if each * height_for(texts, width / each) <= height)
    return next(fits, None)


def rows_in(texts: Sequence[str], width: float, height: float) -> list[Row]:
    """Return the rows in a box that has room for all."""
    rows: list[Row] = []
    column, down = 0, 0.0
    room, columns = height - 2 * _EDGE + _BETWEEN, _columns(width)
    for number, lines in enumerate(_wrapped(texts, width)):
        tall = _height(lines)
        if down + tall > room + _ROUNDING and rows and column + 1 < columns:
            column, down = column + 1, 0.0
        rows.append(Row(number, _EDGE + column * width / columns, _EDGE + down, lines))
        down += tall
    return rows


def _columns(width: float) -> int:
    return max(1, int(width / _COLUMN))


def _wrapped(texts: Sequence[str], width: float) -> list[list[str]]:
    room = width / _columns(width) - 2 * _EDGE - TEXT_LEFT
    characters = max(1, int(room / (RULE_SIZE * _CHARACTER_WIDTH)))
    return [textwrap.wrap(text, characters) for text in texts]


def _height(lines: Sequence[str]) -> float:
    """Return the height of a row, with the distance to the next one."""
    return max(SAMPLE, RULE_LINE * len(lines)) + _BETWEEN


def _fits(heights: Sequence[float], room: float, columns: int) -> bool:
    down = 0.0
    for height in heights:
        if down + height > room:
            columns, down = columns - 1, 0.0
        down += height
    return columns > 0
