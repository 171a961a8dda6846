"""Fixes that rules share: entries that go, and entries that come."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from babyrobot_levels.lint.edits import remove
from babyrobot_levels.lint.rule import Route
from babyrobot_levels.text.diagnostics import Edit, Fix
from babyrobot_levels.text.document import Document, Node
from babyrobot_levels.text.source import Position, Span


def removal(document: Document, message: str, *routes: Route, safe: bool = True) -> Fix | None:
    """Return the fix that takes some values away.

    None where the text does not have them, or where aliases make one text stand for several values.
    """
    try:
        edits = tuple(remove(document, route) for route in routes)
    except KeyError:
        return None
    if any(_is_shared(document, route) for route in routes):
        return None
    return Fix(message, edits, safe)


def append(
    document: Document, field: str, entries: Sequence[str], after: Sequence[str]
) -> Edit | None:
    """Return the edit that adds entries to a list of the file, which need not be there yet.

    Args:
        document: the file.
        field: the list.
        entries: the entries as YAML in flow style.
        after: the fields below which a new list belongs; one of them is there.

    Returns:
        None where there is no good place for them: the whole file is in flow style, or the list
        is an alias.
    """
    source, root = document.source, document.root
    newline = "\r\n" if "\r\n" in source.text else "\n"
    if _is_flow(root) or _is_shared(document, (field,)):
        return None
    old = root.children.get(field)
    if old is not None and _is_flow(old):
        place = source.position(old.last - 1)
        text = ", ".join(entries)
        return Edit(Span(place, place), f", {text}" if old.children else text)
    if old is None:
        indent, lines = "  ", [f"{field}:"]
        last = max((root.children[name] for name in after if name in root.children), key=_end)
    else:
        if not old.children:
            return None
        last = [*old.children.values()][-1]
        first = source.line(old.span.start.line)
        indent, lines = first[: len(first) - len(first.lstrip())], []
        if not first.lstrip().startswith("-"):
            return None
    lines += [f"{indent}- {entry}" for entry in entries]
    end = source.position(len(source.text[: last.last].rstrip()) - 1).line
    place = Position(end + 1, 1)
    text = newline.join(lines)
    if end == len(source.lines):
        place = Position(end, len(source.line(end)) + 1)
        return Edit(Span(place, place), f"{newline}{text}")
    return Edit(Span(place, place), f"{text}{newline}")


def _is_shared(document: Document, route: Route) -> bool:
    """Tell whether a container on the way to a value is anchored text that aliases repeat."""
    if "*" not in document.source.text:
        return False
    times: Counter[int] = Counter()
    waiting, seen = [document.root], set[int]()
    while waiting:
        node = waiting.pop()
        times[id(node.children)] += bool(node.children)
        if id(node.children) not in seen:
            seen.add(id(node.children))
            waiting += node.children.values()
    nodes = [document.node(route[:depth])[0] for depth in range(len(route) + 1)]
    return any(times[id(node.children)] > 1 for node in nodes)


def _is_flow(node: Node) -> bool:
    return node.source.text[node.first] in "[{"


def _end(node: Node) -> int:
    return node.last
