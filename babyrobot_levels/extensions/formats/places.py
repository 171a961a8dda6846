"""Where things stand in files of other programs: the line and the column of all that is lost."""

import ast
import re
import warnings
from collections.abc import Iterator, Sequence
from functools import cached_property

from babyrobot_levels.language.drawing import cells_with
from babyrobot_levels.text.source import START, Position, SourceFile

Route = tuple[str | int, ...]
"""The keys and indices that lead to a value of data: `("layers", 0, "name")`."""

At = Position | Route
"""A place: line and column, or what has them: a value of data, or a cell `(x, y)` of a map."""

_NUMBERS = re.compile(r"\[[\d\s,.]*\]")
"""A list of plain numbers, none of which is looked up: some have a million."""

_Entries = dict[str | int, tuple[ast.expr | ast.keyword, ast.expr]]


class Places:
    """The places of values in JSON or in a Python literal, which is parsed when one is asked for.

    The place of an entry of a mapping is that of its key.
    """

    def __init__(self, source: SourceFile):
        """Take a text that can be read as data."""
        self._source = source
        self._entries: dict[int, _Entries] = {}

    def __call__(self, route: Route) -> Position:
        """Return the place of a value, or of what holds it if it has no place of its own."""
        place: ast.expr | ast.keyword | None = None
        node = self._root
        for key in route:
            entry = self._entries_of(node).get(key) if node else None
            if entry is None:
                break
            place, node = entry
        return START if place is None else self._at(place)

    @cached_property
    def _root(self) -> ast.expr | None:
        """The text as the arguments of a call: then data, assignments and keywords are the same."""
        text = _NUMBERS.sub(lambda found: re.sub(r"[^\n\[\]]", " ", found[0]), self._source.text)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                return ast.parse(f"f(\n{text}\n)", mode="eval").body
            except (SyntaxError, ValueError, MemoryError, RecursionError):
                return None

    def _entries_of(self, node: ast.expr) -> _Entries:
        if id(node) not in self._entries:
            self._entries[id(node)] = {key: (at, to) for key, at, to in _children(node)}
        return self._entries[id(node)]

    def _at(self, node: ast.expr | ast.keyword) -> Position:
        line, offset = self._source.line(node.lineno - 1), node.col_offset
        # Python counts bytes.
        before = offset if line.isascii() else len(line.encode()[:offset].decode(errors="replace"))
        return Position(node.lineno - 1, before + 1)


def _children(node: ast.expr) -> Iterator[tuple[str | int, ast.expr | ast.keyword, ast.expr]]:
    """Yield the keys of what a node holds, each with the node of its place, and that of its value.

    A name that is given to data is left out of routes, so what this holds counts as well.
    """
    match node:
        case ast.List(elts=values) | ast.Tuple(elts=values):
            yield from ((index, value, value) for index, value in enumerate(values))
        case ast.Dict(keys=keys, values=values):
            for key, value in zip(keys, values, strict=True):
                if isinstance(key, ast.Constant) and isinstance(key.value, str | int):
                    yield key.value, key, value
        case ast.Call(args=values, keywords=keywords):
            yield from ((each.arg, each, each.value) for each in keywords if each.arg)
            for value in values or [each.value for each in keywords][:1]:
                yield from _children(value)


def route_of(field: str) -> Route:
    """Return the route that a name like `walls[2] color` stands for."""
    return tuple(int(key) if key.isdecimal() else key for key in re.findall(r"\w+", field))


def places_of_rows(source: SourceFile, rows: Sequence[str]) -> list[Position]:
    """Return where the rows of a map begin, which stand on lines of their own, below each other.

    Where they do not, as in a text with escaped line ends, each has the beginning of the text.
    """
    lines = source.lines
    for first in range(len(lines) - len(rows) + 1):
        if all(row in lines[first + y] for y, row in enumerate(rows)):
            return [
                Position(first + y + 1, lines[first + y].index(row) + 1)
                for y, row in enumerate(rows)
            ]
    return [START] * len(rows)


def rows_from(first: Position, count: int, step: int = 1) -> list[Position]:
    """Return where so many rows begin, of which each is some lines below the one before."""
    return [Position(first.line + step * number, first.column) for number in range(count)]


def cell_of(rows: Sequence[str], mark: str, number: int = 0) -> tuple[int, int]:
    """Return column and row of a mark in a map: of the first, or of another one."""
    return cells_with(rows, mark)[number]
