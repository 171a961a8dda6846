"""Findings to report: those of all faulty files, and some that are hard to write down."""

from __future__ import annotations

from functools import cache

from babyrobot_levels.text.diagnostics import Diagnostic, Edit, Fix, Severity
from babyrobot_levels.text.source import Position, SourceFile, Span
from support.reports import BAD, read


@cache
def real() -> list[Diagnostic]:
    """Return what is wrong with the faulty files of the tests: they take a second to read."""
    return [diagnostic for path in BAD for diagnostic in read(path)[1]]


TITLES = {"BR105": "a field is there twice", "BR601": "a title, with: 100%"}

HOSTILE = "]]>&amp;<b>\"'\x1b[31m\x00\ud800\ufffe\u2028\r\n::error::%0A,[link](http://example.org)"
"""A text that means something to each of the formats."""


def finding(
    code: str = "BR601",
    severity: Severity = Severity.WARNING,
    message: str = "it could be shorter",
    file: str = "levels/one.yaml",
    end: tuple[int, int] = (2, 5),
    fix: Fix | None = None,
    help: str | None = None,  # noqa: A002  (the field's name)
) -> Diagnostic:
    """Return a finding at the first field of a small file's second line."""
    source = SourceFile(file, "version: 1\nsize: [3, 3]\n")
    return Diagnostic(code, severity, message, file, 2, 1, Position(*end), fix, help, source)


FIX = Fix("write it so", (Edit(Span(Position(2, 1), Position(2, 5)), "size"),))

HOSTILE_NAME = HOSTILE.replace("\x00", "").replace("\ud800", "\udcff").replace("//", "/")
"""A file's name can hold all of it that is left, bytes that are not UTF-8 among them."""

MADE_UP = [
    finding(),
    finding("BR105", Severity.ERROR, message=HOSTILE, help=HOSTILE, file=HOSTILE_NAME),
    finding("BR602", Severity.INFO, fix=FIX, end=(3, 1), file="levels/ä b#c:d,e%.yaml"),
]
