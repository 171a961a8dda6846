"""What a YAML text holds: data and comments, and where each part of it stands."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

from babyrobot_levels.text.diagnostics import (
    Diagnostic,
    Edit,
    Fix,
    Issue,
    Key,
    Location,
    Mark,
    Route,
)
from babyrobot_levels.text.source import START, Position, SourceFile, Span


@dataclass(slots=True)
class Node:
    """A value of the document with its place. `children` and `keys` fill the containers."""

    data: Any
    source: SourceFile = field(repr=False)
    first: int
    """Where it begins in the text, in characters from 0."""
    last: int
    """The character just behind it."""
    keys: dict[Any, Node]
    """A mapping's key nodes, by key."""
    children: dict[Any, Node]
    """A container's value nodes, by key or index."""
    block: bool = False
    """True for a literal block (`|`), whose lines stand in the file as they are in the data."""
    size: int = 1
    """How many nodes it holds, aliases expanded."""

    @property
    def span(self) -> Span:
        """Where the value stands. Worked out when it is asked for: most nodes never are."""
        return Span(self.source.position(self.first), self.source.position(self.last))


@dataclass(frozen=True, slots=True, eq=False)
class Document:
    """A text that was read: `data` is plain Python, `issues` are what did not stop it."""

    source: SourceFile
    root: Node
    issues: tuple[Issue, ...]

    @property
    def data(self) -> Any:
        """The document as dicts, lists, texts, numbers, booleans and None."""
        return self.root.data

    def node(self, route: Route) -> tuple[Node, int]:
        """Return the deepest node on the route, and how many of its segments lead there."""
        node = self.root
        for count, segment in enumerate(route):
            if segment not in node.children:
                return node, count
            node = node.children[segment]
        return node, len(route)

    def nodes(self) -> Iterator[Node]:
        """Yield every key and value, containers of aliases once."""
        waiting, seen = [self.root], set()
        while waiting:
            node = waiting.pop()
            if isinstance(node.data, dict | list):
                # Aliases lead to the same nodes again.
                if id(node.children) in seen:
                    continue
                seen.add(id(node.children))
                waiting += [*node.keys.values(), *node.children.values()]
            yield node

    def span(self, location: Location) -> Span:
        """Return where a location is in the text.

        A route that is deeper than the file gives the deepest part that is there.
        """
        if isinstance(location, Span):
            return location
        if isinstance(location, Mark):
            return self._drawing_span(location) or self.span(("map",))
        if isinstance(location, Key):
            *above, name = location.route
            parent, depth = self.node(tuple(above))
            if depth == len(above) and name in parent.keys:
                return parent.keys[name].span
            location = location.route
        return self.node(location)[0].span

    def diagnostic(self, issue: Issue) -> Diagnostic:
        """Return an issue placed in this file; one of the whole file points to its first line."""
        span = Span(START, Position(1, len(self.source.line(1)) + 1))
        if issue.location:
            span = self.span(issue.location)
        spans = [self._drawing_span(mark) for mark, _ in issue.redrawn]
        edits = [
            Edit(span, text) for span, (_, text) in zip(spans, issue.redrawn, strict=True) if span
        ]
        if edits and len(edits) == len(spans):
            issue = replace(issue, fix=Fix("draw each mark in its place", tuple(edits)))
        return diagnostic_of(issue, span, self.source)

    def mark(self, place: Position) -> Mark | None:
        """Return which character of the drawing in `map` is at a place of the text.

        None if there is none, or if the drawing is no block of literal text.
        """
        node, depth = self.node(("map",))
        if not node.block or depth < 1:
            return None
        span = node.span
        first = span.start.line + 1
        if not first <= place.line <= span.end.line:
            return None
        column = place.column - self._indent(node, first) - 1
        return Mark(place.line - first, column, 1) if column >= 0 else None

    def _drawing_span(self, mark: Mark) -> Span | None:
        """Return where characters of the drawing are; None if it is no block of literal text."""
        node, depth = self.node(("map",))
        if not node.block or depth < 1:
            return None
        # The text of a block scalar begins on the line below its `|`, less a common indentation.
        first = node.span.start.line + 1
        if not self.source.line(first + mark.row).strip():
            return None
        start = Position(first + mark.row, self._indent(node, first) + mark.column + 1)
        # What is missing at the end of a line is shown there, but takes no room.
        end = min(start.column + mark.length, len(self.source.line(start.line)) + 1)
        return Span(start, Position(start.line, end))

    def _indent(self, node: Node, first: int) -> int:
        """Return the indentation of the text of a block scalar that begins on a line."""
        begin = 0
        for line in range(first, len(self.source.lines) + 1):
            whole = self.source.line(line)
            end = node.data.find("\n", begin)
            text = node.data[begin : end if end >= 0 else None]
            if text:
                return len(whole) - len(text)
            begin = end + 1
        return 0


def diagnostic_of(issue: Issue, span: Span, source: SourceFile) -> Diagnostic:
    """Return an issue placed at a span of a file."""
    return Diagnostic(
        issue.code,
        issue.severity,
        issue.message,
        source.name,
        span.start.line,
        span.start.column,
        span.end,
        issue.fix,
        help=issue.help,
        source=source if issue.location or not source.is_made else None,
        field=_field_of(issue.location, source) if source.is_made else None,
    )


def _field_of(location: Location, source: SourceFile) -> str:
    """Return the field at a location, as in `walls[2].side`; an empty text for none."""
    if isinstance(location, Span):
        # Each field begins a line.
        return "".join(re.findall(r"^\w+", source.line(location.start.line)))
    if isinstance(location, Mark):
        return "map"
    route = location.route if isinstance(location, Key) else location
    names = (f"[{each}]" if isinstance(each, int) else f".{each}" for each in route)
    return "".join(names).removeprefix(".")


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment, from its `#` to the end of the line."""

    text: str
    span: Span
    is_alone: bool
    """True where nothing but blanks stands before it on its line."""


@lru_cache(maxsize=4)
def comments(document: Document) -> Sequence[Comment]:
    """Return the comments of a document, in the order of the text."""
    source = document.source
    text, found, index = source.text, [], -1
    texts: list[tuple[int, int]] | None = None
    while (index := text.find("#", index + 1)) >= 0:
        if index and text[index - 1] not in " \t\r\n\ufeff":
            continue
        if texts is None:
            texts = sorted(_texts(document))
        place = bisect_right(texts, (index, len(text))) - 1
        if place >= 0 and index < texts[place][1]:
            # Within a text it is a character like others; there may be a comment behind the text.
            index = texts[place][1] - 1
            continue
        start = source.position(index)
        line = source.line(start.line)
        end = Position(start.line, len(line) + 1)
        column = start.column - 1
        found.append(Comment(line[column:], Span(start, end), not line[:column].strip()))
        index += len(line) - column
    return found


def _texts(document: Document) -> Iterator[tuple[int, int]]:
    """Yield where texts and other scalars begin and end, in characters from 0."""
    text = document.source.text
    for node in document.nodes():
        if isinstance(node.data, dict | list):
            continue
        if text[node.first : node.first + 1] in ("|", ">"):
            # Behind the sign of a block there is room for a comment.
            ends = (text.find(end, node.first) for end in "\r\n")
            yield min((end for end in ends if end >= 0), default=len(text)), node.last
        else:
            yield node.first, node.last
