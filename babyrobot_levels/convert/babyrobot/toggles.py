"""Walls that a setup toggles: one that stands is taken away, where none stands one is put."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import groupby
from typing import Any

from babyrobot_levels.convert.conversion import ConversionError, Lost, shown
from babyrobot_levels.convert.data import color, integers, mapping, number, probability, sequence
from babyrobot_levels.convert.edges import Edge, edge_of, in_rows, is_inner
from babyrobot_levels.mdp.grid import BIT
from babyrobot_levels.mdp.mazes import carve

Place = tuple[int, int, str, Edge]
"""A cell, the side of it, and the edge that this is."""

_PLAIN: dict[str, Any] = {}

ALMOST_NEVER = 1e-9
"""The `pass` of glass that lets nobody through: nobody would bounce off a wall of `pass: 0`."""

MAX_TOGGLES = 2_200_000
"""More than the largest grid has edges."""


@dataclass
class Toggles:
    """What toggling comes to.

    Attributes:
        walls: entries of the field `walls`.
        openings: entries of the field `openings`.
        lost: what could not come along.
    """

    walls: list[dict[str, Any]] = field(default_factory=list)
    openings: list[dict[str, Any]] = field(default_factory=list)
    lost: list[Lost] = field(default_factory=list)


def maze_edges(width: int, height: int, start: tuple[int, int], seed: int) -> set[Edge]:
    """Return where the package's maze of a seed has walls: it does not know of blocked cells."""
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
    """Return what is left when all entries of a setup's `walls` have been toggled in turn.

    Args:
        entries: the setup's `walls`.
        size: width and height of the grid.
        maze: where the maze has walls.
        write_maze: whether the walls of the maze are among those to be told.
    """
    result = Toggles()
    stands: dict[Edge, dict[str, Any]] = {edge: {} for edge in maze}
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
            if edge in stands:
                del stands[edge]
            else:
                stands[edge] = properties
    if write_maze:
        maze = {edge for edge in maze if stands.get(edge) == {}}
        for (x, y, side), length, _ in in_rows(dict.fromkeys(maze, _PLAIN)):
            result.walls.append({"at": [x, y], "side": side} | _length(length))
    for index, places in enumerate(reached):
        mine = [place for place in places if last[place[3]] == index]
        for (kind, _), run in groupby(enumerate(mine), lambda told: _kind(told, stands, maze)):
            (_, (x, y, side, edge)), *more = run
            told = {"at": [x, y], "side": side} | _length(1 + len(more))
            if kind == "wall":
                result.walls.append(told | stands[edge])
            elif kind == "opening":
                result.openings.append(told)
    return result


def _length(count: int) -> dict[str, int]:
    return {"length": count} if count > 1 else {}


def _kind(
    numbered: tuple[int, Place], stands: dict[Edge, dict[str, Any]], maze: set[Edge]
) -> tuple[str | None, int]:
    """Return what is to be told of a place, and a number that those in a row have in common."""
    index, (x, y, _, edge) = numbered
    row = x + y - index
    if edge in stands and (edge not in maze or stands[edge]):
        return "wall", row
    return ("opening" if edge in maze and edge not in stands else None), row


def _entry(
    entry: Any, where: str, size: tuple[int, int], lost: list[Lost]
) -> tuple[list[Place], dict[str, Any]]:
    """Return the places of an entry, each with its edge, and its properties in our words."""
    parts = sequence(entry, where)
    if len(parts) not in (2, 3):
        raise ConversionError(
            f"{where} must be ((x, y), side) or ((x, y, length), side, properties)"
        )
    x, y, *rest = integers(parts[0], where, 2, 3)
    side, length = parts[1], rest[0] if rest else 1
    if side not in ("N", "E", "S", "W"):
        raise ConversionError(f"{where}: the side is N, E, S or W, not {shown(side)}")
    if x < 0 or y < 0:
        raise ConversionError(f"{where}: there is no cell ({x}, {y})")
    properties = _properties(parts[2] if len(parts) == 3 else {}, where, lost)
    places = []
    for _ in range(min(length, max(size) + 1)):
        if x >= size[0] or y >= size[1]:
            lost.append(Lost(where, "what is off the grid does nothing"))
            break
        edge = edge_of(x, y, side)
        if not is_inner(*edge, *size):
            lost.append(Lost(where, f"the outer wall at ({x}, {y}) stays: no way is off the grid"))
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
                message = f"with `pass: 0` the wall would be solid, so it is {ALMOST_NEVER:g}"
                lost.append(Lost(place, message))
        elif name == "color" and (known := color(given)) is not None:
            found["color"] = known
        elif name == "width" and 0 <= number(given, place) <= 100:
            found["width"] = given
        elif name == "fit":
            # The package looks whether it is there, not what it says.
            found["fit"] = True
        else:
            lost.append(Lost(place, f"a wall cannot have {shown(given)} for it"))
    return found
