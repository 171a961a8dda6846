"""Maps of Tiled to levels."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

from babyrobot_levels.convert.blocks import Edge, edge_of, edge_runs
from babyrobot_levels.convert.conversion import ConversionError, Lost, World, shown
from babyrobot_levels.convert.data import integer, mapping, read_data, sequence
from babyrobot_levels.convert.tiled_tiles import (
    CLASSES,
    FAR,
    MAX_TILES,
    TileLayer,
    Tilesets,
    tile_layer,
)
from babyrobot_levels.language.base import MAX_SIZE
from babyrobot_levels.language.drawing import rectangles
from babyrobot_levels.language.fields import DRAWN, LevelFields, Role, fields_with
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import MAX_BYTES, SourceFile

TEXTS = ("title", "description", "author", "license", "source")
SPATIAL = frozenset(fields_with(Role.GEOMETRY, DRAWN)) - {"exit_one_of"}
MAX_LENGTH = 4_000_000
"""More than the largest grid has sides of cells."""

MAX_THINGS = MAX_BYTES // len("[0, 0]")
"""A level file is too small for more starts, exits, walls and other entries."""

_WALL_PROPERTIES = ("pass", "color", "width", "fit")
_HINT = "give a tile of its tileset the class " + ", ".join(CLASSES[:-1]) + " or blocked"


def read_tiled(source: SourceFile, folder: Path | None = None) -> World:
    """Return the world of a map, which must be orthogonal.

    Args:
        source: the map.
        folder: the folder of the map: tilesets that are files in it, or below it, are read. None
            to read no other file.

    Raises:
        ConversionError: it is not such a map, malformed, or larger than a level may be.
    """
    return _Reader(mapping(read_data(source), "the map"), folder).world()


class _Reader:
    def __init__(self, data: dict[str, Any], folder: Path | None):
        self.data = data
        self.folder = folder
        self.lost: list[Lost] = []
        self.found: dict[str, list[tuple[int, int]]] = {name: [] for name in CLASSES}
        self.walls: dict[Edge, dict[str, Any]] = {}
        self.length = 0

    def world(self) -> World:
        data = self.data
        if data.get("orientation", "orthogonal") != "orthogonal":
            raise ConversionError(
                f"orientation must be orthogonal, not {shown(data['orientation'])}"
            )
        size = None if data.get("infinite") else self._size()
        self.tile = tuple(integer(data.get(n), n) for n in ("tilewidth", "tileheight"))
        if min(self.tile) < 1:
            raise ConversionError("tilewidth and tileheight must be 1 or more")
        tilesets = Tilesets(data.get("tilesets", []), self.folder)
        self.lost += tilesets.lost
        layers = list(self._layers(data.get("layers"), "layers"))
        tiled = {
            index: tile_layer(layer, f"layer {shown(layer.get('name'))}", size)
            for index, layer in enumerate(layers)
            if layer.get("type") == "tilelayer"
        }
        if sum(layer.count for layer in tiled.values()) > MAX_TILES:
            raise ConversionError(f"its layers have more than {MAX_TILES:,} tiles")
        box = (0, 0, *size) if size else _box(tiled.values())
        self.left, self.top, self.width, self.height = box
        for index, layer in enumerate(layers):
            if index in tiled:
                self._tiles(tiled[index], tilesets)
            else:
                self._layer(layer)
        properties = self._properties()
        cells = self._cells()
        if "exit_one_of" in properties and cells["exit"] == "none":
            del cells["exit"]
        if not self.found["start"]:
            self.lost.append(Lost("start", f"not found, so it is the top-left cell; {_HINT}"))
        fields = {"version": 1, "size": [self.width, self.height], **cells, **properties}
        return World(fields, "A map of Tiled.", {}, tuple(self.lost))

    def _size(self) -> tuple[int, int]:
        width, height = (integer(self.data.get(n), n) for n in ("width", "height"))
        if not (1 <= width <= MAX_SIZE and 1 <= height <= MAX_SIZE):
            raise ConversionError(f"a level is at most {MAX_SIZE} cells wide and high")
        return width, height

    def _layers(self, layers: Any, where: str) -> Iterator[dict[str, Any]]:
        for index, entry in enumerate(sequence(layers, where)):
            layer = mapping(entry, f"{where}[{index}]")
            if layer.get("type") == "group":
                yield from self._layers(layer.get("layers"), f"{where}[{index}].layers")
            else:
                yield layer
            if layer.get("offsetx") or layer.get("offsety"):
                self.lost.append(Lost(f"layer {shown(layer.get('name'))}", "its offset is ignored"))

    def _layer(self, layer: dict[str, Any]) -> None:
        name = shown(layer.get("name"))
        if layer.get("type") == "objectgroup":
            for thing in sequence(layer.get("objects"), f"layer {name}"):
                self._object(mapping(thing, f"layer {name}"), f"layer {name}")
        else:
            self.lost.append(Lost(f"layer {name}", "neither a tile layer nor an object layer"))

    def _tiles(self, layer: TileLayer, tilesets: Tilesets) -> None:
        unknown = 0
        for x, y, number in layer.placed():
            name = tilesets.class_of(number)
            if name is None:
                unknown += 1
            else:
                self.found[name].append((x - self.left, y - self.top))
        if unknown:
            message = f"{unknown} tiles without a known class become plain cells; {_HINT}"
            self.lost.append(Lost(layer.where, message))

    def _object(self, thing: dict[str, Any], where: str) -> None:
        label = f"{where}, object {shown(thing.get('id'))}"
        corners = list(self._corners(thing))
        if len(corners) < 2:
            self.lost.append(Lost(label, "only polylines along edges of cells become walls"))
            return
        properties = self._wall_properties(thing, label)
        for start, end in pairwise(corners):
            edges = list(self._edges(start, end))
            self.length += len(edges)
            if self.length > MAX_LENGTH:
                raise ConversionError(f"{where} has walls along more than {MAX_LENGTH:,} cells")
            if not edges:
                self.lost.append(Lost(label, "a part of it is not along edges of cells of the map"))
            self.walls |= dict.fromkeys(edges, properties)

    def _corners(self, thing: dict[str, Any]) -> Iterator[tuple[int, int]]:
        """Yield the corners of a polyline in cells; none if one is not a corner of a cell."""
        line = thing.get("polyline")
        places = []
        for point in line if isinstance(line, list) else []:
            for axis, size, origin in zip("xy", self.tile, (self.left, self.top), strict=True):
                parts = [each.get(axis, 0) for each in (thing, point) if isinstance(each, dict)]
                if not all(isinstance(part, int | float) and abs(part) < 1e6 for part in parts):
                    return
                place = sum(parts) / size
                if abs(place - round(place)) > 0.25:
                    return
                places.append(round(place) - origin)
        yield from zip(places[::2], places[1::2], strict=True)

    def _edges(self, start: tuple[int, int], end: tuple[int, int]) -> Iterator[Edge]:
        (left, top), (right, bottom) = sorted([start, end])
        inside = 0 <= left <= right <= self.width and min(top, bottom) >= 0
        if not inside or max(top, bottom) > self.height:
            return
        if left == right:
            yield from (edge_of(left, y, "W") for y in range(min(top, bottom), max(top, bottom)))
        elif top == bottom:
            yield from (edge_of(x, top, "N") for x in range(left, right))

    def _wall_properties(self, thing: dict[str, Any], where: str) -> dict[str, Any]:
        given = {}
        for entry in sequence(thing.get("properties", []), where):
            found = mapping(entry, where)
            if found.get("name") in _WALL_PROPERTIES:
                given[str(found["name"])] = found.get("value")
            else:
                self.lost.append(Lost(where, f"a wall has no property {shown(found.get('name'))}"))
        return given

    def _properties(self) -> dict[str, Any]:
        """Return the fields in the map's properties, which are written as in a level file."""
        fields: dict[str, Any] = {}
        known = LevelFields.model_fields.keys() - SPATIAL - {"version"}
        for entry in sequence(self.data.get("properties", []), "properties"):
            found = mapping(entry, "properties")
            name, value = found.get("name"), found.get("value")
            if not isinstance(name, str) or name not in known:
                self.lost.append(Lost(f"property {shown(name)}", "a level has no such field"))
            elif isinstance(value, str) and name not in TEXTS:
                try:
                    fields[name] = read(SourceFile(f"property {name}", value)).data
                except LevelError as fault:
                    raise ConversionError(
                        f"property {name}: {fault.diagnostics[0].message}"
                    ) from None
            else:
                fields[name] = value
        return fields

    def _cells(self) -> dict[str, Any]:
        found = {name: list(dict.fromkeys(cells)) for name, cells in self.found.items()}
        fields: dict[str, Any] = {}
        if found["start"]:
            fields["start"] = _one_or_all(found["start"])
        fields["exit"] = _one_or_all(found["exit"]) if found["exit"] else "none"
        walls = []
        for (x, y, side), length, given in edge_runs(self.walls):
            if x < 0 or y < 0:
                x, y, side = (x, 0, "N") if side == "S" else (0, y, "W")
            wall = {"at": [x, y], "side": side}
            walls.append(wall | ({"length": length} if length > 1 else {}) | given)
        puddles = [{"at": [*c], "size": "small"} for c in found["small-puddle"]]
        puddles += [{"at": [*c], "size": "large"} for c in found["large-puddle"]]
        blocked = _rectangles(found["blocked"], self.width, self.height)
        lists = {"walls": walls, "puddles": puddles, "blocked": list(blocked)}
        things = len(found["start"]) + len(found["exit"]) + sum(map(len, lists.values()))
        if things > MAX_THINGS:
            raise ConversionError(
                f"{things:,} starts, exits, walls, puddles and blocked rectangles "
                "are too many for one file"
            )
        return fields | {name: entries for name, entries in lists.items() if entries}


def _box(layers: Iterable[TileLayer]) -> tuple[int, int, int, int]:
    """Return left, top, width and height of the smallest box around all tiles."""
    left, top, right, bottom = FAR * 2, FAR * 2, -FAR * 2, -FAR * 2
    for layer in layers:
        for x, y, _ in layer.placed():
            left, right, top, bottom = min(left, x), max(right, x), min(top, y), max(bottom, y)
    if left > right:
        raise ConversionError("the map is infinite and has no tiles", "clear Infinite in Tiled")
    width, height = right - left + 1, bottom - top + 1
    if max(width, height) > MAX_SIZE:
        raise ConversionError(
            f"the tiles of the infinite map take {width:,} by {height:,} cells; "
            f"a level is at most {MAX_SIZE} cells wide and high"
        )
    return left, top, width, height


def _one_or_all(cells: list[tuple[int, int]]) -> list[Any]:
    return [*cells[0]] if len(cells) == 1 else [[*cell] for cell in cells]


def _rectangles(cells: list[tuple[int, int]], width: int, height: int) -> Iterator[dict[str, Any]]:
    """Yield rectangles that cover the cells, as entries of `blocked`."""
    marks = bytearray(width * height)
    for x, y in cells:
        marks[y * width + x] = True
    for x, y, columns, rows in rectangles(marks, width):
        yield {"at": [x, y]} | ({} if columns == rows == 1 else {"size": [columns, rows]})


def is_tiled(data: Any) -> bool:
    """Return whether data looks like a map of Tiled."""
    return isinstance(data, dict) and "layers" in data and "tilewidth" in data
