"""Changed fields written into an existing text, so that comments and layout stay as they are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from babyrobot_levels.text.document import Document
from babyrobot_levels.text.emitter import emit_field
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile


def splice(text: str, data: dict[str, Any], order: Sequence[str]) -> str | None:
    """Return `text` with its top-level fields changed to `data`, or None where that is not safe.

    Fields that are equal are not touched. New fields are put where `order` wants them.
    """
    document = _read(text)
    if document is None:
        return None
    if document.data == data:
        return text
    if document.source.line(document.root.span.start.line)[:1] == "{":
        return None
    lines = list(document.source.lines)
    changes: list[tuple[int, int, list[str]]] = []
    for name in document.root.keys:
        if name not in data or document.data[name] != data[name]:
            first, last = _lines_of(document, name)
            new = [] if name not in data else _new_lines(document, name, data[name], first, last)
            changes.append((first, last, new))
    for name in [name for name in order if name in data and name not in document.root.keys]:
        row = _place_for(document, name, order)
        changes.append((row, row, emit_field(name, data[name]).splitlines()))
    # From the bottom up, so that no change moves the lines of another.
    for first, last, new in sorted(changes, key=lambda change: change[:2], reverse=True):
        lines[first:last] = new
    result = ("\r\n" if "\r\n" in text else "\n").join(lines)
    check = _read(result)
    return result if check is not None and check.data == data else None


def _read(text: str) -> Document | None:
    try:
        document = read(SourceFile("", text))
    except LevelError:
        return None
    return document if isinstance(document.data, dict) and not document.issues else None


def _lines_of(document: Document, name: str) -> tuple[int, int]:
    """Return the lines of a field, from 0, the last one exclusive."""
    first = document.root.keys[name].span.start.line - 1
    end = document.root.children[name].span.end
    last = end.line if end.column > 1 else end.line - 1
    while last > first + 1 and not document.source.lines[last - 1].strip():
        last -= 1
    return first, max(last, first + 1)


def _new_lines(document: Document, name: str, value: Any, first: int, last: int) -> list[str]:
    """Return the lines that take a field's place; a comment behind a short value stays."""
    new = emit_field(name, value).splitlines()
    span = document.root.children[name].span
    if len(new) == 1 and last - first == 1 and span.start.line == span.end.line == first + 1:
        old = document.source.lines[first]
        shown = new[0].partition(": ")[2]
        return [old[: span.start.column - 1] + shown + old[span.end.column - 1 :]]
    return new


def _place_for(document: Document, name: str, order: Sequence[str]) -> int:
    """Return the line before which a new field belongs."""
    before = [other for other in order[: order.index(name)] if other in document.root.keys]
    if before:
        return max(_lines_of(document, other)[1] for other in before)
    return min(_lines_of(document, other)[0] for other in document.root.keys)
