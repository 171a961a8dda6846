"""Edits of a level file that leave everything else as it stands: comments, quotes, order."""

from __future__ import annotations

from typing import Any

from babyrobot_levels.lint.rule import Route
from babyrobot_levels.text.diagnostics import Edit, Fix
from babyrobot_levels.text.document import Document, Node
from babyrobot_levels.text.emitter import flow
from babyrobot_levels.text.source import Position, SourceFile, Span


def replace(document: Document, route: Route, text: str) -> Edit:
    """Return the edit that writes `text` in the place of a value.

    Raises:
        KeyError: the file has no such value.
    """
    return Edit(_node(document, route).span, text)


def remove(document: Document, route: Route) -> Edit:
    """Return the edit that takes a field or an entry of a list away.

    What would be left empty goes with it: the list whose only entry it is, or the mapping.

    Raises:
        KeyError: the file has no such value.
    """
    _node(document, route)
    parent = _node(document, route[:-1])
    while len(parent.children) == 1 and len(route) > 1:
        route = route[:-1]
        parent = _node(document, route[:-1])
    first, last = _extent(parent, route[-1])
    places = [*parent.children]
    number = places.index(route[-1])
    source = document.source
    if _is_flow(parent, source) or not _has_its_lines(route[-1], first, source):
        if number + 1 < len(places):
            return _cut(source, first, _extent(parent, places[number + 1])[0])
        return _cut(source, _extent(parent, places[number - 1])[1], last)
    start, end = source.position(first).line, source.position(last - 1).line
    if isinstance(route[-1], int):
        # The dash may stand on a line of its own.
        while not source.line(start).lstrip().startswith("-"):
            start -= 1
    while not source.line(end).strip():
        end -= 1
    return Edit(Span(Position(start, 1), Position(end + 1, 1)), "")


def merge(
    document: Document, field: str, first: int, count: int, merged: dict[str, Any]
) -> Fix | None:
    """Return the fix that writes one entry in the place of several that follow each other.

    None where the list stands on one line: what follows what is not safely cut there.
    """
    if _is_flow(_node(document, (field,)), document.source):
        return None
    entry = replace(document, (field, first), flow(merged))
    rest = [remove(document, (field, number)) for number in range(first + 1, first + count)]
    return Fix(f"write `{flow(merged)}`", (entry, *rest))


def _node(document: Document, route: Route) -> Node:
    node, depth = document.node(route)
    if depth < len(route):
        raise KeyError(route)
    return node


def _extent(parent: Node, key: str | int) -> tuple[int, int]:
    """Return where a field (with its name) or an entry begins and ends."""
    child = parent.children[key]
    return parent.keys.get(key, child).first, child.last


def _is_flow(node: Node, source: SourceFile) -> bool:
    return source.text[node.first] in "[{"


def _has_its_lines(key: str | int, first: int, source: SourceFile) -> bool:
    """Tell whether nothing but an entry's own dash stands before it on its line."""
    position = source.position(first)
    before = source.line(position.line)[: position.column - 1].strip()
    return before in (("", "-") if isinstance(key, int) else ("",))


def _cut(source: SourceFile, first: int, last: int) -> Edit:
    return Edit(Span(source.position(first), source.position(last)), "")
