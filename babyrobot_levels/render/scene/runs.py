"""Neighbours taken together: runs in a row, rectangles in a grid. Fewer shapes, and no seams."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence


def runs(marks: Iterable[object]) -> Iterator[tuple[int, int]]:
    """Yield start and length of each run of true marks."""
    start, index = None, -1
    for index, mark in enumerate(marks):
        if mark and start is None:
            start = index
        elif not mark and start is not None:
            yield start, index - start
            start = None
    if start is not None:
        yield start, index + 1 - start


def rectangles(marks: Sequence[object], width: int) -> Iterator[tuple[int, int, int, int]]:
    """Yield rectangles `(x, y, columns, rows)` that together cover the true marks, row by row."""
    growing: dict[tuple[int, int], tuple[int, int]] = {}
    for y in range(len(marks) // width + 1):
        found = dict.fromkeys(runs(marks[y * width : (y + 1) * width]))
        for run in [run for run in growing if run not in found]:
            first, rows = growing.pop(run)
            yield run[0], first, run[1], rows
        for run in found:
            first, rows = growing.get(run, (y, 0))
            growing[run] = first, rows + 1
