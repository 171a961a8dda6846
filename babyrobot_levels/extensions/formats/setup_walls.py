"""Walls that a setup toggles: an entry removes the wall of an edge, or adds one."""

from dataclasses import dataclass, field
from itertools import groupby
from typing import Any

from babyrobot_levels.extensions.formats.blocks import (
    Edge,
    edge_of,
    edge_runs,
    is_inner,
    side_entry,
)
from babyrobot_levels.extensions.formats.conversion import (
    ConversionError,
    Lost,
    color,
    integers,
    mapping,
    number,
    probability,
    sequence,
    shown,
)
from babyrobot_levels.mdp.grid import BIT
from babyrobot_levels.mdp.mazes import carve

Place = tuple[int, int, str, Edge]
"""A cell, the side of it, and the edge that this is."""

_PLAIN: dict[str, Any] = {}

ALMOST_NEVER = 1e-9
"""The `pass` of glass that is never passed: a robot does not bounce off a wall of `pass: 0`."""

MAX_TOGGLES = 2_200_000
"""More than the largest grid has edges."""


@dataclass
class Toggles:
    """The result of toggling.

    Attributes:
        walls: entries of the field `walls`.
        openings: entries of the field `openings`.
        lost: what is not kept.
    """

    walls: list[dict[str, Any]] = field(default_factory=list)
    openings: list[dict[str, Any]] = field(default_factory=list)
    lost: list[Lost] = field(default_factory=list)


def maze_edges(width: int, height: int, start: tuple[int, int], seed: int) -> set[Edge]:
    """Return where the package's maze of a seed has walls; it ignores blocked cells."""
    first = start[1] * width + start[0]
    is_open = carve(width, height, bytes(width * height), first, seed, "depth-first", 0.0)
    return {
        (x, y, side)
        for y in range(height)
        for x in range(width)
        for side in ("E", "S")
        if is_inner(x, y, side, width, height) and not is_open[y * width + x] & BIT[side]
    }


def toggle(
    entries: list[Any], size: tuple[int, int], maze: set[Edge], *, write_maze: bool
) -> Toggles:
    """Return the walls and openings after all entries of a setup's `walls`, in order.

    Args:
        entries: the setup's `walls`.
        size: width and height of the grid.
        maze: where the maze has walls.
        write_maze: whether to return the walls of the maze as well.
    """
    result = Toggles()
    present: dict[Edge, dict[str, Any]] = {edge: {} for edge in maze}
    last: dict[Edge, int] = {}
    reached: list[list[Place]] = []
    count = 0
    for index, entry in enumerate(entries):
        places, properties = _entry(entry, f"walls[{index}]", size, result.lost)
        reached.append(places)
        count += len(places)
        if count > MAX_TOGGLES:
            raise ConversionError(f"walls toggle more than {MAX_TOGGLES:,} sides of cells")
        for *_, edge in places:
            last[edge] = index
            if edge in present:
                del present[edge]
            else:
                present[edge] = properties
    if write_maze:
        maze = {edge for edge in maze if present.get(edge) == {}}
        runs = edge_runs(dict.fromkeys(maze, _PLAIN))
        result.walls += (side_entry(*edge, length) for edge, length, _ in runs)
    for index, places in enumerate(reached):
        mine = [place for place in places if last[place[3]] == index]
        for (kind, _), run in groupby(enumerate(mine), lambda place: _kind(place, present, maze)):
            (_, (x, y, side, edge)), *more = run
            entry = side_entry(x, y, side, 1 + len(more))
            if kind == "wall":
                result.walls.append(entry | present[edge])
            elif kind == "opening":
                result.openings.append(entry)
    return result


def _kind(
    numbered: tuple[int, Place], present: dict[Edge, dict[str, Any]], maze: set[Edge]
) -> tuple[str | None, int]:
    """Return the kind of entry that a place needs, and a number that all places of a run share."""
    index, (x, y, _, edge) = numbered
    row = x + y - index
    if edge in present and (edge not in maze or present[edge]):
        return "wall", row
    return ("opening" if edge in maze and edge not in present else None), row


def _entry(
    entry: Any, where: str, size: tuple[int, int], lost: list[Lost]
) -> tuple[list[Place], dict[str, Any]]:
    """Return the places of an entry, each with its edge, and its properties in a level's terms."""
    parts = sequence(entry, where)
    if len(parts) not in (2, 3):
        raise ConversionError(
            f"{where} must be ((x, y), side) or ((x, y, length), side, properties)"
        )
    x, y, *rest = integers(parts[0], where, 2, 3)
    side, length = parts[1], rest[0] if rest else 1
    if side not in ("N", "E", "S", "W"):
        raise ConversionError(f"{where}: side must be N, E, S or W, not {shown(side)}")
    if x < 0 or y < 0:
        raise ConversionError(f"{where}: cell ({x}, {y}) is off the grid")
    properties = _properties(parts[2] if len(parts) == 3 else {}, where, lost)
    places = []
    for _ in range(min(length, max(size) + 1)):
        if x >= size[0] or y >= size[1]:
            lost.append(Lost(where, "edges off the grid have no effect"))
            break
        edge = edge_of(x, y, side)
        if not is_inner(*edge, *size):
            lost.append(Lost(where, f"the outer wall at ({x}, {y}) cannot be removed"))
            break
        places.append((x, y, side, edge))
        x, y = (x + 1, y) if side in "NS" else (x, y + 1)
    return places, properties


def _properties(value: Any, where: str, lost: list[Lost]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, given in mapping(value, where).items():
        place = f"{where} {name}"
        if name == "prob":
            found["pass"] = probability(given, place) or ALMOST_NEVER
            if not given:
                message = f"a wall of `pass: 0` is solid, so it becomes {ALMOST_NEVER:g}"
                lost.append(Lost(place, message))
        elif name == "color" and (known := color(given)) is not None:
            found["color"] = known
        elif name == "width" and 0 <= number(given, place) <= 100:
            found["width"] = given
        elif name == "fit":
            # The package ignores the value.
            found["fit"] = True
        else:
            lost.append(Lost(place, f"{shown(given)} is not supported for a wall"))
    return found
