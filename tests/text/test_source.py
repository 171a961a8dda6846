"""Texts, places in them, and how many columns of a terminal they take."""

from __future__ import annotations

import pytest

from babyrobot_levels.text.source import Position, SourceFile, Span, columns


@pytest.mark.parametrize(
    ("text", "count"), [("", 0), ("maze", 4), ("é", 1), ("e\u0301", 1), ("迷路", 4), ("ＡＢ", 4)]
)
def test_wide_and_combining_characters_are_counted_as_terminals_show_them(
    text: str, count: int
) -> None:
    assert columns(text) == count


def test_carets_stand_below_what_is_wide() -> None:
    source = SourceFile("x.yaml", "title: 迷路 x")
    shown, carets = source.excerpt(Span(Position(1, 8), Position(1, 10)))
    assert (shown, carets) == ("title: 迷路 x", " " * 7 + "^" * 4)
