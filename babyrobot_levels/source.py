"""Texts and places in them: what every message about a level file points at."""

from __future__ import annotations

import unicodedata
from dataclasses import dataclass, field
from typing import NamedTuple

EXCERPT_WIDTH = 96
"""The most columns of a source line that a message shows; longer lines are cut around the caret."""


class Position(NamedTuple):
    """A place in a text. Both numbers count from 1, as editors do; columns count characters."""

    line: int
    column: int


class Span(NamedTuple):
    """A stretch of a text, from `start` up to but not including `end`."""

    start: Position
    end: Position


START = Position(1, 1)


@dataclass(frozen=True, slots=True)
class SourceFile:
    """A text and the name under which messages speak of it.

    `lines` are the text's lines without their line ends, in the sense of YAML: a form feed
    or a Unicode separator inside a line does not end it.
    """

    name: str
    text: str
    lines: tuple[str, ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        unified = self.text.replace("\r\n", "\n").replace("\r", "\n")
        object.__setattr__(self, "lines", tuple(unified.split("\n")))

    def line(self, number: int) -> str:
        """Return line `number` (from 1), or an empty text past the end."""
        return self.lines[number - 1] if 0 < number <= len(self.lines) else ""

    def excerpt(self, span: Span) -> tuple[str, str]:
        """Return the span's first line and a line of carets below the span.

        Both are cut to `EXCERPT_WIDTH` columns around the span. Tabs become one blank and other
        control characters a `?`, so that no file can move the cursor of the reader's terminal.
        """
        text = self.line(span.start.line)
        first = min(span.start.column - 1, len(text))
        last = span.end.column - 1 if span.end.line == span.start.line else len(text)
        last = max(min(last, len(text)), first + 1)
        offset = 0
        if len(text) > EXCERPT_WIDTH:
            offset = max(0, min(first - EXCERPT_WIDTH // 3, len(text) - EXCERPT_WIDTH))
            text = text[offset : offset + EXCERPT_WIDTH]
        shown = "".join(map(_shown, text))
        first, last = first - offset, min(last - offset, EXCERPT_WIDTH)
        blank = columns(shown[:first])
        carets = columns(shown[first:last]) or 1
        return shown, " " * blank + "^" * carets


def printable(text: str) -> str:
    """Return a text with its control characters written as escapes, line ends kept.

    For whatever comes from a file or its name: no text may move the cursor of the reader's
    terminal, colour it, or forge a line of a report.
    """
    if text.isprintable():
        return text
    return "".join(
        character if character.isprintable() or character == "\n" else ascii(character)[1:-1]
        for character in text
    )


def columns(text: str) -> int:
    """Return how many columns of a terminal a text takes."""
    if text.isascii():
        return len(text)
    return sum(map(_columns, text))


def _shown(character: str) -> str:
    if character == "\t":
        return " "
    return character if character.isprintable() else "?"


def _columns(character: str) -> int:
    if unicodedata.combining(character):
        return 0
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1
