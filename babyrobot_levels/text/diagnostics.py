"""What is wrong with a file, where, and what to do about it: issues and diagnostics.

An `Issue` points into a document by keys, by characters of its drawing, or by a span of its text.
A `Diagnostic` is an issue placed in its file, by line and column. Both are frozen values.
"""

import dataclasses
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from babyrobot_levels.text.source import Position, SourceFile, Span, printable
from babyrobot_levels.text.words import Telling


class Severity(StrEnum):
    """How bad a finding is: an `error` keeps a level from loading, the others do not."""

    __module__ = "babyrobot_levels"

    ERROR = "error"
    WARNING = "warning"
    INFO = "info"


@dataclass(frozen=True, slots=True)
class Edit:
    """Replace the text of `span` by `text`."""

    span: Span
    text: str


@dataclass(frozen=True, slots=True)
class Fix:
    """Edits that fix an issue. `safe` says that they leave the MDP unchanged."""

    message: str
    edits: tuple[Edit, ...]
    safe: bool = True

    def to_dict(self) -> dict[str, Any]:
        """Return the fix as plain data; lines and columns count from 1, ends are exclusive."""
        edits = [
            {
                "line": edit.span.start.line,
                "column": edit.span.start.column,
                "end_line": edit.span.end.line,
                "end_column": edit.span.end.column,
                "text": edit.text,
            }
            for edit in self.edits
        ]
        return {"message": self.message, "safe": self.safe, "edits": edits}


Route = tuple[str | int, ...]
"""The keys and indices that lead to a value, as in `("walls", 2, "side")`; `()` is the whole file.

A route that is deeper than the file stands for the deepest part that is there.
"""


@dataclass(frozen=True, slots=True)
class Key:
    """The name of the field at a route, and not its value."""

    route: Route


@dataclass(frozen=True, slots=True)
class Mark:
    """Characters of the drawing in `map`: line and column from 0, and how many."""

    row: int
    column: int
    length: int


Location = Route | Key | Mark | Span
"""Where an issue is."""


@dataclass(frozen=True, slots=True)
class Issue:
    """Something wrong with a document, which knows nothing of files yet.

    Attributes:
        code: the stable code, `BR` and three digits.
        location: where it is.
        message: what is wrong.
        help: what to do about it.
        fix: edits that do it.
        severity: how bad it is.
        redrawn: what to write in place of parts of the drawing; with them a text has a fix.
    """

    code: str
    location: Location
    message: str
    help: str | None = None
    fix: Fix | None = None
    severity: Severity = Severity.ERROR
    redrawn: tuple[tuple[Mark, str], ...] = ()


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding.

    `line` and `column` count from 1 and `end` is the place just behind the faulty text. Where
    nobody has seen the text, as it was made of a mapping, `field` says what to look at.
    """

    __module__ = "babyrobot_levels"

    code: str
    severity: Severity
    message: str
    file: str
    line: int
    column: int
    end: Position
    fix: Fix | None = None
    help: str | None = None
    source: SourceFile | None = dataclasses.field(default=None, repr=False, compare=False)
    field: str | None = None

    @property
    def span(self) -> Span:
        """Where the faulty text is."""
        return Span(Position(self.line, self.column), self.end)

    @property
    def location(self) -> str:
        """The place as editors and terminals link it, `file:line:column`, or the field."""
        if self.field is None:
            return f"{self.file}:{self.line}:{self.column}"
        named = "" if self.file.startswith("<") else self.file
        return ": ".join(filter(None, (named, self.field)))

    def excerpt(self, room: int | None = None) -> tuple[str, str] | None:
        """Return the source line and its carets, or None where there is no text to show.

        A longer line is cut to `room` columns; see `SourceFile.excerpt`.
        """
        if self.source is None or not self.source.line(self.line):
            return None
        return self.source.excerpt(self.span, room)

    def to_dict(self) -> dict[str, Any]:
        """Return the finding as plain data, the shape of `--format json`."""
        return {
            "code": self.code,
            "severity": str(self.severity),
            "message": self.message,
            "file": self.file,
            "line": self.line,
            "column": self.column,
            "end_line": self.end.line,
            "end_column": self.end.column,
            "help": self.help,
            "fix": None if self.fix is None else self.fix.to_dict(),
        }

    def __str__(self) -> str:
        """Return the whole finding as plain text: place, message, source line, caret, help."""
        return self.shown()

    def shown(self, width: int | None = None) -> str:
        """Return the finding as `str` does, its source line cut to the width of a terminal."""
        place, message = (one_line(text) for text in (self.location, self.message))
        lines = [f"{place}: " * bool(place) + f"{self.severity} {self.code}: {message}"]
        number = str(self.line) if self.field is None else ""
        gutter = " " * len(number)
        excerpt = self.excerpt(None if width is None else max(1, width - len(number) - 5))
        if excerpt is not None:
            lines += [f"  {gutter} |", f"  {number} | {excerpt[0]}", f"  {gutter} | {excerpt[1]}"]
        if self.help:
            lines.append(f"  help: {one_line(self.help)}")
        if self.fix is not None:
            option = "--fix" if self.fix.safe else "--fix --unsafe-fixes"
            lines.append(f"  fix: {one_line(self.fix.message)} ({option})")
        return "\n".join(lines)


class Findings(Telling, list[Diagnostic], public=True):
    """What was found in levels, in the order of the levels; empty if all is well."""

    def __repr__(self) -> str:
        return "\n\n".join(map(str, self)) or "no findings"


def one_line(text: str) -> str:
    """Return a text that may hold anything as one printable line."""
    return printable(text).replace("\n", "\\n")
