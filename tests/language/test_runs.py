"""Neighbours taken together: runs, items that follow each other, rectangles."""

from __future__ import annotations

from collections.abc import Iterable

import pytest

from babyrobot_levels.language.runs import consecutive, rectangles, runs


@pytest.mark.parametrize(
    ("values", "wanted", "expected"),
    [
        ([], 1, []),
        ([0, 0], 1, []),
        ([1], True, [(0, 1)]),
        ([0, 1, 1, 0, 1], 1, [(1, 2), (4, 1)]),
        ("##  #", "#", [(0, 2), (4, 1)]),
        (b"\1\0\0\1", 0, [(1, 2)]),
    ],
)
def test_runs_have_a_start_and_a_length(
    values: Iterable[object], wanted: object, expected: list[object]
) -> None:
    assert list(runs(values, wanted)) == expected


def test_consecutive_items_are_on_one_line_and_one_place_apart() -> None:
    cells = [(0, 0), (0, 1), (0, 3), (1, 3), (1, 4), (2, 5)]
    found = list(consecutive(cells, lambda cell: (cell[0], cell[1])))
    assert found == [[(0, 0), (0, 1)], [(0, 3)], [(1, 3), (1, 4)], [(2, 5)]]
    assert list(consecutive([], lambda cell: cell)) == []


def test_rectangles_cover_each_mark_once() -> None:
    marks = bytes([1, 1, 0, 1, 1, 1, 0, 0, 0, 1, 1, 1])
    found = sorted(rectangles(marks, 4))
    assert found == [(0, 0, 2, 2), (1, 2, 3, 1), (3, 0, 1, 1)]
