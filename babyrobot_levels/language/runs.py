"""Neighbours taken together: runs in a line, rectangles in a grid."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import groupby
from typing import Any, TypeVar

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
