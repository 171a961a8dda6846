"""Texts and places in them: what every message about a level file points at."""

import re
import unicodedata
from bisect import bisect_right
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import PurePath
from typing import NamedTuple

MAX_BYTES = 1 << 20
"""The most bytes of a file that is read as a text."""

BOM = "\N{ZERO WIDTH NO-BREAK SPACE}"
"""The byte order mark, with which some programs begin a text."""

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


_LINE_END = re.compile(r"\r\n|\r|\n")

_RELATIVE_SCHEMA = (
    r"(?m)^(# yaml-language-server: *\$schema=)(?![A-Za-z][\w+.-]*:|/)\S+[ \t]*(?:\n|\Z)"
)


@dataclass(frozen=True)
class SourceFile:
    """A text and the name under which messages speak of it.

    Lines end as in editors, with LF, CRLF or CR; a form feed or a Unicode separator ends none.
    A byte order mark before the text is `mark`, else empty: whoever writes the file keeps it.
    Nobody has seen one that `is_made`, of a mapping or of another file: messages name its fields.
    """

    name: str
    text: str
    mark: str = field(default="", init=False, compare=False)
    is_made: bool = field(default=False, kw_only=True, compare=False)

    def __post_init__(self) -> None:
        # Parsers count a byte order mark as a character; editors do not.
        object.__setattr__(self, "mark", BOM if self.text.startswith(BOM) else "")
        object.__setattr__(self, "text", self.text.removeprefix(BOM))

    @cached_property
    def lines(self) -> tuple[str, ...]:
        """The lines of the text, without their line ends."""
        return tuple(_LINE_END.split(self.text))

    def line(self, number: int) -> str:
        """Return line `number` (from 1), or an empty text past the end."""
        return self.lines[number - 1] if 0 < number <= len(self.lines) else ""

    def position(self, index: int) -> Position:
        """Return the place of a character, counted from 0 through the whole text."""
        line = bisect_right(self._starts, index)
        return Position(line, index - self._starts[line - 1] + 1)

    def index(self, position: Position) -> int:
        """Return the character at a place, counted from 0; past the end of the text, its length."""
        if position.line > len(self._starts):
            return len(self.text)
        return min(self._starts[position.line - 1] + position.column - 1, len(self.text))

    @cached_property
    def _starts(self) -> list[int]:
        return [0, *(match.end() for match in _LINE_END.finditer(self.text))]

    def excerpt(self, span: Span, room: int | None = None) -> tuple[str, str]:
        """Return the span's first line and a line of carets below the span.

        Tabs become one blank and other control characters a `?`, so that no file can move the
        cursor of the reader's terminal.

        Args:
            span: the characters to point at.
            room: the columns of a terminal. A longer line is cut to a part around the span, with
                `…` where it goes on. None cuts it to `EXCERPT_WIDTH` characters.
        """
        text = self.line(span.start.line)
        first = min(span.start.column - 1, len(text))
        last = span.end.column - 1 if span.end.line == span.start.line else len(text)
        last = max(min(last, len(text)), first + 1)
        if room is not None:
            return _in_room("".join(map(_shown, text)), first, last, room)
        offset = 0
        if len(text) > EXCERPT_WIDTH:
            offset = max(0, min(first - EXCERPT_WIDTH // 3, len(text) - EXCERPT_WIDTH))
            text = text[offset : offset + EXCERPT_WIDTH]
        shown = "".join(map(_shown, text))
        first, last = first - offset, min(last - offset, EXCERPT_WIDTH)
        blank = columns(shown[:first])
        return shown, " " * blank + "^" * (columns(shown[first:last]) or 1)


_JOINERS = "\N{ZERO WIDTH NON-JOINER}\N{ZERO WIDTH JOINER}"


_OTHERS = {".toml": "TOML", ".py": "Python", ".ini": "INI", ".csv": "CSV"}
_OTHERS[".brlplay"] = "recorded episodes, which `babyrobot replay` verifies"
_PICTURES = (".png", ".jpg", ".jpeg", ".gif", ".pdf")


def other_form(name: str) -> str | None:
    """Return what to do with a file that is no YAML, by its name; None if that may be YAML."""
    suffix = PurePath(name).suffix.lower()
    form = "picture" if suffix in _PICTURES else f"file of {_OTHERS.get(suffix, '')}"
    is_known = suffix in (*_OTHERS, *_PICTURES)
    return f"a level is written in YAML or JSON, and this is a {form}" if is_known else None


def printable(text: str) -> str:
    """Return a text with its control characters written as escapes, line ends kept.

    For whatever comes from a file or its name: no text may move the cursor of the reader's
    terminal, colour it, or forge a line of a report. Joiners stay, which emojis and some scripts
    are written with.
    """
    if text.isprintable():
        return text
    return "".join(
        character
        if character.isprintable() or character == "\n" or character in _JOINERS
        else ascii(character)[1:-1]
        for character in text
    )


def columns(text: str) -> int:
    """Return how many columns of a terminal a text takes."""
    if text.isascii():
        return len(text)
    return sum(map(_columns, text))


def _in_room(text: str, first: int, last: int, room: int) -> tuple[str, str]:
    """Return the part of a line around some characters that fits, and the carets below them."""
    begin, end = 0, len(text)
    if columns(text) > room:
        room = max(1, room - 2)
        begin = end = first
        while begin > 0 and columns(text[begin - 1 : first]) <= room // 3:
            begin -= 1
        while end < len(text) and columns(text[begin : end + 1]) <= room:
            end += 1
        while begin > 0 and columns(text[begin - 1 : end]) <= room:
            begin -= 1
    before, after = "…" * (begin > 0), "…" * (end < len(text))
    blank = columns(before + text[begin:first])
    carets = columns(text[first : min(last, end)]) or 1
    return before + text[begin:end] + after, " " * blank + "^" * carets


def _shown(character: str) -> str:
    if character == "\t":
        return " "
    return character if character.isprintable() else "?"


def _columns(character: str) -> int:
    if unicodedata.combining(character) or character in _JOINERS:
        return 0
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1


def with_schema(text: str, schema: str | None = None) -> str:
    """Return the text of a file for another place, from where its relative schema is elsewhere.

    Args:
        text: the text.
        schema: the schema that its comment for editors names instead; None for no comment.
    """
    line = f"\\g<1>{schema}\n" if schema else ""
    return re.sub(_RELATIVE_SCHEMA, line, text, count=1)
