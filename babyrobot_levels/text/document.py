"""What a YAML text holds: data, and where each part of it stands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from babyrobot_levels.text.source import SourceFile, Span

Route = Sequence[str | int]
"""The way to a value: keys and indices from the top, as in `("walls", 2, "side")`."""


@dataclass(frozen=True, slots=True)
class YamlProblem:
    """A fault of the text itself: its code, its place, and what to say."""

    code: str
    span: Span
    message: str
    help: str | None = None


class YamlFault(Exception):
    """The text cannot be read as data at all. Carries the one problem that says why."""

    def __init__(self, problem: YamlProblem):
        self.problem = problem
        super().__init__(problem.message)


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


@dataclass(frozen=True, slots=True)
class Document:
    """A text that was read: `data` is plain Python, `problems` are faults that did not stop it."""

    source: SourceFile
    root: Node
    problems: tuple[YamlProblem, ...]

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

    def span(self, route: Route, *, key: bool = False) -> Span:
        """Return where the route's value stands, or its key if `key` is set.

        A route that goes deeper than the file gives the deepest part that is there.
        """
        node, depth = self.node(route)
        if key and route and depth == len(route):
            parent, _ = self.node(route[:-1])
            if route[-1] in parent.keys:
                return parent.keys[route[-1]].span
        return node.span
