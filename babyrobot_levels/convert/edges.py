"""Edges between two cells: which of them have walls, how these look, and runs of equal ones."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.runs import consecutive
from babyrobot_levels.language.walls import sides_of
from babyrobot_levels.mdp.grid import BIT, Grid

Edge = tuple[int, int, str]
"""The cell to the west or to the north of an edge, and its side there: `E` or `S`.

The outer wall's western and northern edges have x or y -1.
"""


def edge_of(x: int, y: int, side: str) -> Edge:
    """Return the edge at a side of a cell."""
    if side == "N":
        return (x, y - 1, "S")
    return (x - 1, y, "E") if side == "W" else (x, y, side)


def is_inner(x: int, y: int, side: str, width: int, height: int) -> bool:
    """Return whether an edge lies between two cells of the grid."""
    return x >= 0 and y >= 0 and (x < width - 1 if side == "E" else y < height - 1)


def free_edges(grid: Grid) -> Iterator[Edge]:
    """Yield the edges between two cells of which none is blocked."""
    for cell, blocked in enumerate(grid.blocked_cells):
        y, x = divmod(cell, grid.width)
        for side in ("E", "S"):
            other = grid.neighbour(cell, side)
            if other is not None and not blocked and not grid.blocked_cells[other]:
                yield x, y, side


def wall_at(grid: Grid, edge: Edge) -> float | None:
    """Return the `pass` probability of the wall at an edge, None if there is no wall."""
    x, y, side = edge
    cell = y * grid.width + x
    return grid.glass.get((cell, side), 0.0) if grid.wall_bits[cell] & BIT[side] else None


def wall_looks(level: LevelFields) -> dict[Edge, dict[str, Any]]:
    """Return the color, width and fit of the walls that have their own."""
    looks: dict[Edge, dict[str, Any]] = {}
    for wall in level.walls:
        given: dict[str, Any] = {} if wall.color is None else {"color": wall.color}
        given |= {} if wall.width is None else {"width": wall.width}
        given |= {"fit": True} if wall.fit else {}
        for x, y in sides_of(wall) if given else ():
            looks.setdefault(edge_of(x, y, wall.side), {}).update(given)
    return looks


def edge_runs(edges: Mapping[Edge, dict[str, Any]]) -> Iterator[tuple[Edge, int, dict[str, Any]]]:
    """Yield for each run of equal edges in a line its first edge, its length and its properties."""

    def line(edge: Edge) -> tuple[str, int, int]:
        x, y, side = edge
        return (side, x, y) if side == "E" else (side, y, x)

    def position(edge: Edge) -> tuple[Any, int]:
        side, across, along = line(edge)
        return (side, across, edges[edge]), along

    for run in consecutive(sorted(edges, key=line), position):
        yield run[0], len(run), edges[run[0]]
