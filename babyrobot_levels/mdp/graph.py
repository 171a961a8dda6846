"""Which states lead to which, whatever the probabilities: breadth-first search, for everybody."""

from __future__ import annotations

import sys
from array import array
from collections.abc import Iterable, Sequence
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

MANY = 50_000
"""From so many nodes on, distances are found with SciPy: fewer take no longer than its import."""

FEW = 150
"""Up to so many nodes, SciPy gains nothing, even where it is imported already."""

Successors = Sequence[Sequence[int]]
"""For each node, the nodes to which an edge leads."""


def distances(sources: Iterable[int], successors: Successors) -> list[int]:
    """Return for each node the fewest edges from a source, -1 where none leads there."""
    found = [-1] * len(successors)
    frontier = list(sources)
    for node in frontier:
        found[node] = 0
    steps = 0
    while frontier:
        steps += 1
        beyond = []
        for node in frontier:
            for other in successors[node]:
                if found[other] < 0:
                    found[other] = steps
                    beyond.append(other)
        frontier = beyond
    return found


def differs(values: NDArray[Any]) -> NDArray[np.bool_]:
    """Return whether each value is another than the one before it."""
    flags = np.ones(values.size, bool)
    np.not_equal(values[1:], values[:-1], out=flags[1:])
    return flags


def expanded(
    first: NDArray[np.signedinteger], last: NDArray[np.signedinteger]
) -> tuple[NDArray[np.signedinteger], NDArray[np.signedinteger]]:
    """Return all numbers of some ranges, and before them, of which range each is."""
    count = last - first
    which = np.repeat(np.arange(count.size), count)
    begin = np.cumsum(count) - count
    return which, np.arange(which.size) + (first - begin)[which]


def counts(distances: NDArray[np.int32]) -> array[int]:
    """Return distances as Python's integers, in little room."""
    return array("i", distances.tobytes())


class Graph:
    """A directed graph of numbered nodes.

    Args:
        size: the number of nodes.
        source: where each edge begins, `[edges]`.
        target: where it ends, `[edges]`.
    """

    def __init__(
        self, size: int, source: NDArray[np.signedinteger], target: NDArray[np.signedinteger]
    ):
        self.size, self.source, self.target = size, source, target

    @cached_property
    def rows(self) -> tuple[NDArray[np.signedinteger], NDArray[np.int32]]:
        """The targets of all nodes, one node after the other, and where those of each begin."""
        begin = np.zeros(self.size + 1, np.int32)
        np.cumsum(np.bincount(self.source, minlength=self.size), out=begin[1:])
        if (self.source[1:] >= self.source[:-1]).all():
            return self.target, begin
        if self.size < MANY:
            return self.target[np.argsort(self.source, kind="stable")], begin
        from scipy.sparse import csr_array  # type: ignore[import-untyped]

        ones = np.ones(self.source.size, np.int8)
        rows = csr_array((ones, (self.source, self.target)), shape=(self.size, self.size))
        return rows.indices, rows.indptr

    @cached_property
    def successors(self) -> Successors:
        """For each node, the nodes to which an edge leads; of many nodes, made when asked for."""
        ordered, begin = self.rows
        if self.size >= MANY:
            return Rows(ordered, begin)
        targets = ordered.tolist()
        return [targets[first:last] for first, last in pairwise(begin.tolist())]

    def components(self) -> int:
        """Return how many connected components there are, where each edge leads both ways."""
        from scipy.sparse import csr_array
        from scipy.sparse.csgraph import connected_components  # type: ignore[import-untyped]

        targets, begin = self.rows
        weights = np.broadcast_to(1.0, targets.size)
        edges = csr_array((weights, targets, begin), shape=(self.size, self.size))
        return int(connected_components(edges, directed=False, return_labels=False))

    def reversed(self) -> Graph:
        """Return the graph with all edges reversed."""
        return Graph(self.size, self.target, self.source)

    def distances(self, sources: Iterable[int] | NDArray[np.intp]) -> NDArray[np.int32]:
        """Return for each node the fewest edges from a source, -1 where none leads there.

        Sources given as an array are distinct.
        """
        if self.size < MANY and (self.size <= FEW or "scipy.sparse" not in sys.modules):
            nodes = sources.tolist() if isinstance(sources, np.ndarray) else sources
            return np.array(distances(nodes, self.successors), np.int32)
        from scipy.sparse import csr_array
        from scipy.sparse.csgraph import breadth_first_order

        # One more node, from which an edge leads to each source.
        size, roots = self.size, sources
        if not isinstance(roots, np.ndarray):
            roots = np.unique(np.fromiter(roots, np.intp))
        targets, begin = self.rows
        targets = np.concatenate([targets, roots.astype(np.int32)], dtype=np.int32)
        # SciPy wants a weight for each edge, of this type: one number serves all of them.
        weights = np.broadcast_to(1.0, targets.size)
        graph = csr_array(
            (weights, targets, np.append(begin, np.int32(targets.size))), shape=(size + 1, size + 1)
        )
        order, before = breadth_first_order(graph, size)
        # Nodes come in the order of their distances. Those of the next distance begin with the
        # first that was found from one of this distance.
        place = np.empty(size + 1, np.int32)
        place[order] = np.arange(order.size, dtype=np.int32)
        ahead = np.bincount(place[before[order[1:]]], minlength=order.size)
        behind = (1 + np.cumsum(ahead) - ahead).tolist()
        begins, at = [], 1
        while at < order.size:
            begins.append(at)
            at = behind[at]
        count = np.zeros(order.size, np.int32)
        count[begins] = 1
        found = np.full(size, -1, np.int32)
        found[order[1:]] = np.cumsum(count)[1:] - 1
        return found


class Rows(Sequence[Sequence[int]]):
    """A list of lists that is kept as two: of all their values, and of where each begins."""

    def __init__(self, values: NDArray[np.signedinteger], begin: NDArray[np.int32]):
        self.values, self.begin, self.bounds = values, begin, begin.tolist()

    def __len__(self) -> int:
        return len(self.bounds) - 1

    def __getitem__(self, row: Any) -> Any:
        return self.values[self.bounds[row] : self.bounds[row + 1]].tolist()

    def of(self, rows: NDArray[np.signedinteger]) -> tuple[NDArray[np.signedinteger], ...]:
        """Return the values of some rows, and before them, of which of these rows each is."""
        which, place = expanded(self.begin[rows], self.begin[rows + 1])
        return which, self.values[place]
