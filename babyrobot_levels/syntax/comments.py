"""The comments of a YAML text: no parser keeps them, but they stand where nothing else does."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from babyrobot_levels.source import Position, Span
from babyrobot_levels.syntax.document import Document, Node


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment, from its `#` to the end of the line."""

    text: str
    span: Span
    is_alone: bool
    """True where nothing but blanks stands before it on its line."""


def comments(document: Document) -> list[Comment]:
    """Return the comments of a document, in the order of the text."""
    source = document.source
    if "#" not in source.text:
        return []
    inside = _scalar_columns(document)
    found = []
    for number, line in enumerate(source.lines, 1):
        column = line.find("#")
        while column >= 0:
            is_free = column == 0 or line[column - 1] in " \t"
            spans = inside.get(number, ())
            if is_free and not any(first <= column < last for first, last in spans):
                span = Span(Position(number, column + 1), Position(number, len(line) + 1))
                found.append(Comment(line[column:], span, not line[:column].strip()))
                break
            column = line.find("#", column + 1)
    return found


def _scalar_columns(document: Document) -> dict[int, list[tuple[int, int]]]:
    """Return, for each line, the columns (from 0, the last exclusive) that texts take."""
    source = document.source
    columns: dict[int, list[tuple[int, int]]] = {}
    for node in _scalars(document.root):
        start, end = node.span
        is_block = source.line(start.line)[start.column - 1 : start.column] in ("|", ">")
        # Behind the sign of a block there is room for a comment.
        for line in range(start.line + is_block, end.line + 1):
            first = start.column - 1 if line == start.line else 0
            last = end.column - 1 if line == end.line else len(source.line(line))
            columns.setdefault(line, []).append((first, last))
    return columns


def _scalars(root: Node) -> Iterator[Node]:
    waiting, seen = [root], set()
    while waiting:
        node = waiting.pop()
        # Aliases lead to the same node again.
        if id(node) in seen:
            continue
        seen.add(id(node))
        if isinstance(node.data, dict | list):
            waiting += [*node.keys.values(), *node.children.values()]
        else:
            yield node
