"""Where the findings in a level are shown in its picture."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import islice
from typing import Any, TypeGuard

from babyrobot_levels.editor.shown.linting import Linting
from babyrobot_levels.language.kinds import KINDS
from babyrobot_levels.linter.finding import marked_at
from babyrobot_levels.linter.rules import find
from babyrobot_levels.text.document import Document, Node
from babyrobot_levels.text.source import Span

PLACED = {field for kind in KINDS for field in kind.fields}
"""The fields that say where something stands."""

MOST_PLACES = 400
"""The most cells or sides at which a finding is shown."""

_CELL = re.compile(r"\[(\d{1,4}), (\d{1,4})\]")

Place = tuple[int, int, str]
"""A cell `(x, y)` and a side of it, which is empty for the cell itself."""


def findings_of(linting: Linting, size: tuple[int, int]) -> list[dict[str, Any]]:
    """Return findings as plain data, each with where it is shown.

    To `Diagnostic.to_dict` it adds `title`, what its rule is about; `is_outdated`, whether it was
    found in the text before, and not looked for again yet; `cells`, `[x, y]` each; and `sides`,
    `[x, y, side]` each. The places are those of the entry, or of the part of the drawing, at which
    a finding points; or else those that its message names.

    Args:
        linting: the findings.
        size: the size of the picture; what is off it is left out.
    """
    document = linting.report.document
    found = [(each, False) for each in linting.report.diagnostics]
    found += [(each, True) for each in linting.outdated]
    shown = []
    for each, is_outdated in sorted(found, key=lambda pair: (pair[0].line, pair[0].column)):
        places = [*_places(document, each.span)] if document is not None else []
        named = ((int(x), int(y), "") for x, y in _CELL.findall(each.message))
        inside = [
            (x, y, side)
            for x, y, side in dict.fromkeys(places or named)
            if x < size[0] and y < size[1]
        ]
        rule = find(each.code)
        shown.append(
            {
                **each.to_dict(),
                "title": "" if rule is None else rule.summary,
                "is_outdated": is_outdated,
                "cells": [[x, y] for x, y, side in inside if not side],
                "sides": [[x, y, side] for x, y, side in inside if side],
            }
        )
    return shown


def _places(document: Document, span: Span) -> Iterator[Place]:
    """Yield what the text at a span is about."""
    mark, data = document.mark(span.start), document.data
    if mark is not None:
        place = marked_at(data["map"], mark)
        if place is not None:
            yield place
        return
    index = document.source.index(span.start)
    for name in PLACED & document.root.children.keys():
        node = document.root.children[name]
        if node.first <= index < node.last:
            inner = (child for child in node.children.values() if _holds(child, index))
            entry = next(inner, node) if isinstance(node.data, list) else node
            # The entry is a coordinate where the field is a single cell.
            whole = node if isinstance(entry.data, int) else entry
            yield from islice(_of_entry(whole.data), MOST_PLACES)


def _holds(node: Node, index: int) -> bool:
    return node.first <= index < node.last


def _of_entry(entry: Any) -> Iterator[Place]:
    """Yield the cells or sides of an entry, which need not be valid."""
    if _is_pair(entry):
        yield entry[0], entry[1], ""
    elif isinstance(entry, list):
        for each in entry:
            yield from _of_entry(each)
    elif isinstance(entry, dict):
        at, size, side = entry.get("at"), entry.get("size"), entry.get("side")
        length = entry.get("length", 1)
        if _is_pair(at) and side in ("N", "E", "S", "W"):
            for step in range(length if isinstance(length, int) else 1):
                yield at[0] + step * (side in "NS"), at[1] + step * (side in "EW"), side
            return
        if _is_pair(at) and _is_pair(size):
            columns, rows = size
            yield from ((at[0] + x, at[1] + y, "") for y in range(rows) for x in range(columns))
            return
        for name in ("at", "one_of", "to", "path"):
            yield from _of_entry(entry.get(name))


def _is_pair(value: Any) -> TypeGuard[list[int]]:
    """Return whether a value may be a cell or a size."""
    is_list = isinstance(value, list) and len(value) == 2
    return is_list and all(type(number) is int and number >= 0 for number in value)
