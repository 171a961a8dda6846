"""Texts, places in them, and how many columns of a terminal they take."""

from __future__ import annotations

import pytest

from babyrobot_levels.text.source import Position, SourceFile, Span, columns


@pytest.mark.parametrize(
    ("text", "count"),
    [("", 0), ("maze", 4), ("é", 1), ("e\u0301", 1), ("a\u200db", 2), ("迷路", 4), ("ＡＢ", 4)],
)
def test_wide_and_combining_characters_are_counted_as_terminals_show_them(
    text: str, count: int
) -> None:
    assert columns(text) == count


def test_carets_stand_below_what_is_wide() -> None:
    source = SourceFile("x.yaml", "title: 迷路 x")
    shown, carets = source.excerpt(Span(Position(1, 8), Position(1, 10)))
    assert (shown, carets) == ("title: 迷路 x", " " * 7 + "^" * 4)


@pytest.mark.parametrize("room", [3, 10, 20, 40])
@pytest.mark.parametrize("word", ["first", "middle", "last"])
@pytest.mark.parametrize("filling", ["迷路 ", "a\tb ", "e\u0301 "])
def test_a_line_that_is_cut_shows_the_word_that_is_meant(
    room: int, word: str, filling: str
) -> None:
    text = f"first {9 * filling}middle {9 * filling}last"
    begin = text.index(word) + 1
    span = Span(Position(1, begin), Position(1, begin + len(word)))
    shown, carets = SourceFile("x.yaml", text).excerpt(span, room)
    assert columns(shown) <= room
    assert len(carets) <= room
    assert set(carets.strip()) == {"^"}
    place = len(carets) - len(carets.lstrip())
    below = next(index for index in range(len(shown)) if columns(shown[:index]) == place)
    assert shown[below:].startswith(word[: carets.count("^")])
    assert carets.count("^") == len(word) or room < 2 * len(word)
    assert shown.startswith("…") or word == "first" or columns(text) <= room
    assert shown.endswith("…") or word == "last" or columns(text) <= room


def test_a_line_that_fits_is_whole() -> None:
    text = 150 * "a"
    span = Span(Position(1, 150), Position(1, 151))
    assert SourceFile("x.yaml", text).excerpt(span, 150) == (text, 149 * " " + "^")
