"""Levels of LDtk: the cells of an IntGrid layer, and entities by their names."""

import json
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from babyrobot_levels.extensions.formats.blocks import drawn, replaced, without_ring
from babyrobot_levels.extensions.formats.conversion import (
    Codec,
    ConversionError,
    Lost,
    Part,
    World,
    integer,
    mapping,
    read_data,
    sequence,
    shown,
)
from babyrobot_levels.extensions.formats.letters import with_start
from babyrobot_levels.extensions.formats.places import Route
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.base import MAX_SIZE
from babyrobot_levels.text.source import SourceFile

_BLOCKING = re.compile("wall|solid|dirt|stone|rock|ground|block|brick|collision", re.IGNORECASE)
_STARTS = re.compile("player|start|spawn", re.IGNORECASE)
_EXITS = re.compile("exit|goal|finish", re.IGNORECASE)


def ldtk_parts(source: SourceFile) -> list[Part]:
    """Return the levels of a project, each with the names of the values of its layers.

    Raises:
        ConversionError: it is no project, or its levels are files of their own.
    """
    data = mapping(read_data(source), "the project")
    if data.get("externalLevels"):
        help_text = "in LDtk, turn off Save levels to separate files, and save it again"
        raise ConversionError("the levels of this project are files of their own", help_text)
    names: dict[str, Any] = {}
    for layer in sequence(mapping(data.get("defs"), "defs").get("layers"), "defs.layers"):
        values = mapping(layer, "defs.layers").get("intGridValues") or []
        names[str(layer.get("uid"))] = {
            str(mapping(each, "intGridValues").get("value")): each.get("identifier")
            for each in sequence(values, "intGridValues")
        }
    return [
        Part(json.dumps({"names": names, "level": level}), route=route)
        for route, level in _levels(data)
    ]


def _levels(data: dict[str, Any], above: Route = ()) -> Iterator[tuple[Route, Any]]:
    """Yield the levels of a project or of a world of it, each with its place."""
    for index, world in enumerate(sequence(data.get("worlds", []), "worlds")):
        yield from _levels(mapping(world, "worlds"), ("worlds", index))
    for index, level in enumerate(sequence(data.get("levels", []), "levels")):
        yield (*above, "levels", index), level


def read_ldtk(source: SourceFile) -> World:
    """Return the world of a level: named values of its first IntGrid layer, and its entities."""
    data = read_data(source)
    level, names = mapping(data["level"], "the level"), data["names"]
    layers = [
        mapping(each, "layerInstances")
        for each in sequence(level.get("layerInstances"), "layerInstances")
    ]
    grids = [number for number, layer in enumerate(layers) if layer.get("intGridCsv")]
    if not grids:
        raise ConversionError("the level has no IntGrid layer, which says where walls are")
    lost = [
        Lost(
            f"layer {shown(layers[number].get('__identifier'))}",
            "left out; the first IntGrid layer counts",
            ("layerInstances", number),
        )
        for number in grids[1:]
    ]
    grid, in_grid = layers[grids[0]], ("layerInstances", grids[0], "intGridCsv")
    told: list[Lost] = []
    cells, size = _cells(grid, names.get(str(grid.get("layerDefUid")), {}), told)
    left_out: Counter[str] = Counter()
    first: dict[str, Route] = {}
    for number, layer in enumerate(layers):
        entities = sequence(layer.get("entityInstances", []), "entityInstances")
        for index, entry in enumerate(entities):
            entity = mapping(entry, "entityInstances")
            name, mark = str(entity.get("__identifier")), None
            if _STARTS.search(name) or _EXITS.search(name):
                mark = d.START if _STARTS.search(name) else d.EXIT
            place = _place(entity, layer, grid)
            if mark is None or not all(
                0 <= at < most for at, most in zip(place, size, strict=True)
            ):
                left_out[name] += 1
                first.setdefault(name, ("layerInstances", number, "entityInstances", index))
            else:
                cells = replaced(cells, [place], mark)
    lost += (
        Lost(f"entity {shown(name)}", f"{n} left out", first[name]) for name, n in left_out.items()
    )
    title = {"title": str(level["identifier"])} if level.get("identifier") else {}
    fields = {"version": 1, **title, **drawn(without_ring(with_start(cells, told)))}
    lost = [replace(each, at=in_grid) for each in told] + lost
    return World(fields, "A level of LDtk.", {}, tuple(lost))


def _cells(
    layer: dict[str, Any], names: dict[str, Any], lost: list[Lost]
) -> tuple[tuple[str, ...], tuple[int, int]]:
    """Return the cells of a layer, and how many columns and rows they are."""
    width, height = (integer(layer.get(name), name) for name in ("__cWid", "__cHei"))
    values = sequence(layer.get("intGridCsv"), "intGridCsv")
    if not (1 <= width <= MAX_SIZE and 1 <= height <= MAX_SIZE) or len(values) != width * height:
        raise ConversionError(f"the layer is {width} by {height}, and has {len(values)} cells")
    meanings = {0: d.PLAIN}
    for value, count in Counter(integer(each, "intGridCsv") for each in values).items():
        name = names.get(str(value))
        meanings.setdefault(value, d.BLOCKED if name is None or _BLOCKING.search(name) else d.PLAIN)
        if meanings[value] == d.PLAIN and value:
            lost.append(Lost(f"value {shown(name)}", f"{count} cells of it become plain cells"))
    text = "".join(meanings[integer(each, "intGridCsv")] for each in values)
    return tuple(text[at : at + width] for at in range(0, len(text), width)), (width, height)


def _place(entity: dict[str, Any], layer: dict[str, Any], grid: dict[str, Any]) -> tuple[int, int]:
    """Return the cell of an entity, whose layer may have cells of another size."""
    x, y = (integer(each, "__grid") for each in sequence(entity.get("__grid"), "__grid"))
    own, other = (
        integer(layer.get("__gridSize"), "__gridSize"),
        integer(grid.get("__gridSize"), "__gridSize"),
    )
    return x * own // max(other, 1), y * own // max(other, 1)


CODEC = Codec(
    read_ldtk,
    holds=lambda data: isinstance(data, dict) and {"defs", "levels", "jsonVersion"} <= data.keys(),
    parts=ldtk_parts,
)
