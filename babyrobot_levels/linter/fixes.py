"""Fixes: edits of a level file that leave comments, quotes and the order of fields unchanged."""

import copy
from collections import Counter
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

from babyrobot_levels.language.cells import sides_of
from babyrobot_levels.library.level import Level
from babyrobot_levels.linter.finding import side_mark
from babyrobot_levels.text.diagnostics import Edit, Fix, Route
from babyrobot_levels.text.document import Document, Node, comments
from babyrobot_levels.text.emitter import flow
from babyrobot_levels.text.source import Position, SourceFile, Span
from babyrobot_levels.text.splice import common_ends, spliced


def replace(document: Document, route: Route, text: str) -> Edit:
    """Return the edit that replaces a value by `text`.

    Raises:
        KeyError: the file has no such value.
    """
    return Edit(_node(document, route).span, text)


def remove(document: Document, route: Route) -> Edit:
    """Return the edit that removes a field or an entry of a list.

    A list or mapping that would be left empty is removed as well. Comments stay, on lines of
    their own.

    Raises:
        KeyError: the file has no such value.
    """
    _node(document, route)
    parent = _node(document, route[:-1])
    while len(parent.children) == 1 and len(route) > 1:
        route = route[:-1]
        parent = _node(document, route[:-1])
    first, last = _extent(parent, route[-1])
    source = document.source
    if _is_flow(parent) or not _has_its_lines(route[-1], first, source):
        before, after = _beside(parent, route[-1])
        if after is not None:
            return _cut(document, first, _extent(parent, after)[0])
        assert before is not None
        return _cut(document, _extent(parent, before)[1], last)
    start, end = source.position(first).line, source.position(last - 1).line
    if isinstance(route[-1], int):
        # The dash may be on a line of its own.
        while not source.line(start).lstrip().startswith("-"):
            start -= 1
    while not source.line(end).strip():
        end -= 1
    return _cut(document, source.index(Position(start, 1)), source.index(Position(end + 1, 1)))


def merge(
    document: Document, field: str, first: int, count: int, merged: dict[str, Any]
) -> Fix | None:
    """Return the fix that replaces several consecutive entries by one.

    Returns None if the list is in flow style, where entries cannot be removed safely.
    """
    if _is_flow(_node(document, (field,))):
        return None
    entry = replace(document, (field, first), flow(merged))
    rest = [remove(document, (field, number)) for number in range(first + 1, first + count)]
    return Fix(f"write `{flow(merged)}`", (entry, *rest))


def removal(document: Document, message: str, *routes: Route, safe: bool = True) -> Fix | None:
    """Return the fix that removes some values.

    Returns None if the text does not contain them, or if they are part of an anchored value that
    aliases repeat.
    """
    try:
        edits = tuple(remove(document, route) for route in routes)
    except KeyError:
        return None
    if any(_is_shared(document, route) for route in routes):
        return None
    return Fix(message, edits, safe)


def setting(document: Document, route: Route, value: int | float) -> Fix | None:
    """Return the fix that gives a field another value, with what it is in; it changes the MDP.

    Returns None if the text around it cannot stay as it is.
    """
    data = copy.deepcopy(document.data)
    *above, name = route
    inner = data
    for segment in above:
        inner = inner.setdefault(segment, {}) if isinstance(segment, str) else inner[segment]
    inner[name] = value
    after = spliced(document, data, [*Level.model_fields])
    if after is None:
        return None
    source, text = document.source, after.source.text
    first, same = common_ends(source.text, text)
    span = Span(source.position(first), source.position(len(source.text) - same))
    dotted = ".".join(str(each) for each in route if isinstance(each, str))
    edit = Edit(span, text[first : len(text) - same])
    return Fix(f"set `{dotted}` to {value}", (edit,), safe=False)


def door_removal(document: Document, level: Level, number: int, *, safe: bool) -> Fix | None:
    """Return the fix that removes a door, by its index, also from the drawing.

    Returns None if the door is part of an anchored value that aliases repeat, or if the drawing is
    no block of literal text.
    """
    fix = removal(document, "remove the door", ("doors", number), safe=safe)
    if fix is None or level.map is None:
        return fix
    if not document.node(("map",))[0].block:
        return None
    door = level.doors[number]
    dx, dy, side = {"W": (-1, 0, "E"), "N": (0, -1, "S")}.get(door.side, (0, 0, door.side))
    marks = [side_mark(level, x + dx, y + dy, side) for x, y in sides_of(door)]
    blank = [Edit(document.span(mark), " " * mark.length) for mark in marks]
    return Fix(fix.message, (*fix.edits, *blank), safe)


def append(
    document: Document, field: str, entries: Sequence[str], after: Sequence[str]
) -> Edit | None:
    """Return the edit that adds entries to a list of the file, creating the list if necessary.

    Args:
        document: the file.
        field: the list.
        entries: the entries as YAML in flow style.
        after: fields after which a new list is inserted; the file has at least one of them.

    Returns:
        None if there is no good position: the whole file is in flow style, or the list is an
        alias.
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
        last = max(
            (root.children[name] for name in after if name in root.children),
            key=lambda node: node.last,
        )
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


def _node(document: Document, route: Route) -> Node:
    node, depth = document.node(route)
    if depth < len(route):
        raise KeyError(route)
    return node


def _extent(parent: Node, key: str | int) -> tuple[int, int]:
    """Return the bounds of a field (with its name) or of an entry."""
    child = parent.children[key]
    return parent.keys.get(key, child).first, child.last


def _beside(parent: Node, key: str | int) -> tuple[str | int | None, str | int | None]:
    """Return the keys before and after a field or an entry, None where there is none."""
    if isinstance(key, int):
        before, after = key - 1, key + 1
        known = parent.children
        return before if before in known else None, after if after in known else None
    places = [None, *parent.children, None]
    number = places.index(key)
    return places[number - 1], places[number + 1]


def _is_flow(node: Node) -> bool:
    return node.source.text[node.first] in "[{"


def _has_its_lines(key: str | int, first: int, source: SourceFile) -> bool:
    """Return whether nothing but an entry's own dash precedes it on its line."""
    position = source.position(first)
    before = source.line(position.line)[: position.column - 1].strip()
    return before in (("", "-") if isinstance(key, int) else ("",))


def _cut(document: Document, first: int, last: int) -> Edit:
    """Return the edit that removes a part of the text, but for its comments."""
    source = document.source
    span = Span(source.position(first), source.position(last))
    if "#" not in source.text[first:last]:
        return Edit(span, "")
    newline = "\r\n" if "\r\n" in source.text else "\n"
    line = source.line(span.start.line if span.start.column == 1 else span.end.line)
    rest = newline + line[: len(line) - len(line.lstrip())]
    within = (each for each in comments(document) if span.start <= each.span.start < span.end)
    kept = rest.join(each.text for each in within)
    if not kept:
        return Edit(span, "")
    if span.start.column == 1:
        return Edit(span, f"{rest.removeprefix(newline)}{kept}{newline}")
    return Edit(span, ("" if source.text[first - 1].isspace() else "  ") + kept + rest)


def _is_shared(document: Document, route: Route) -> bool:
    """Return whether a container on the route to a value is anchored and repeated by aliases."""
    repeated = _repeated(document)
    nodes = [document.node(route[:depth])[0] for depth in range(len(route) + 1)]
    return any(id(node.children) in repeated for node in nodes)


@lru_cache(maxsize=4)
def _repeated(document: Document) -> frozenset[int]:
    """Return which containers aliases repeat, by the identity of their children."""
    if "*" not in document.source.text:
        return frozenset()
    times: Counter[int] = Counter()
    waiting, seen = [document.root], set[int]()
    while waiting:
        node = waiting.pop()
        times[id(node.children)] += bool(node.children)
        if id(node.children) not in seen:
            seen.add(id(node.children))
            waiting += node.children.values()
    return frozenset(each for each, count in times.items() if count > 1)
