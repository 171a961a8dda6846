"""Comments are found where they stand, and nowhere else."""

from __future__ import annotations

import pytest

from babyrobot_levels.text.document import comments
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile


def found(text: str) -> list[tuple[str, int, int, bool]]:
    return [
        (each.text, each.span.start.line, each.span.start.column, each.is_alone)
        for each in comments(read(SourceFile("x.yaml", text)))
    ]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a: 1\n", []),
        ("# one\na: 1  # two # still two\n   # three", [
            ("# one", 1, 1, True), ("# two # still two", 2, 7, False), ("# three", 3, 4, True)]),
        ("a: b#c\n", []),
        ("a: 'b # c' # d\n", [("# d", 1, 12, False)]),
        ('a: "b # c" # d\n', [("# d", 1, 12, False)]),
        ('a: "b\n  # c" # d\n', [("# d", 2, 8, False)]),
        ("'a # b': 1 # c\n", [("# c", 1, 12, False)]),
        ("a: | # b\n  # c\n  d # e\n# f\ng: 1\n", [
            ("# b", 1, 6, False), ("# f", 4, 1, True)]),
        ("a: >-\n  b # c\n", []),
        ("a: [1, # b\n  2] # c\n", [("# b", 1, 8, False), ("# c", 2, 6, False)]),
        ("a: &x {b: '# c'}\nd: *x # e\n", [("# e", 2, 7, False)]),
        ("\ufeff# a\r\nb: 1 # c\r\n", [("# a", 1, 1, True), ("# c", 2, 6, False)]),
        ("a: 1\n#\n", [("#", 2, 1, True)]),
    ],
)  # fmt: skip
def test_what_is_a_comment(text: str, expected: list[tuple[str, int, int, bool]]) -> None:
    assert found(text) == expected
