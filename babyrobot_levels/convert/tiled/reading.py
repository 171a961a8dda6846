"""Maps of Tiled to levels."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby, pairwise
from typing import Any

from babyrobot_levels.convert.checked import integer, mapping, sequence
from babyrobot_levels.convert.conversion import ConversionError, Lost, World, shown
from babyrobot_levels.convert.data import read_data
from babyrobot_levels.convert.edges import Edge, edge_of, in_rows
from babyrobot_levels.source import SourceFile
from babyrobot_levels.spec.base import MAX_SIZE
from babyrobot_levels.spec.level import LevelFields
from babyrobot_levels.syntax.document import YamlFault
from babyrobot_levels.syntax.reader import read

CLASSES = ("start", "exit", "small-puddle", "large-puddle", "blocked")
"""The classes by which tiles say what they are, in the order of the tileset."""

TEXTS = ("title", "description", "author", "license", "source")
SPATIAL = frozenset(
    {"size", "start", "exit", "walls", "openings", "maze", "puddles", "blocked", "map", "legend"}
)
FLIPS = 0x0FFFFFFF
"""The bits of a tile's number that are left when those for flipping are gone."""

MAX_LENGTH = 4_000_000
"""More than the largest grid has sides of cells."""

_WALL_PROPERTIES = ("pass", "color", "width", "fit")
_HINT = "give a tile of an embedded tileset the class " + ", ".join(CLASSES[:-1]) + " or blocked"


def read_tiled(source: SourceFile) -> World:
    """Return the world of a map: orthogonal, finite, with its layers written as lists."""
    return _Reader(mapping(read_data(source), "the map")).world()


class _Reader:
    def __init__(self, data: dict[str, Any]):
        self.data = data
        self.lost: list[Lost] = []
        self.found: dict[str, list[tuple[int, int]]] = {name: [] for name in CLASSES}
        self.walls: dict[Edge, dict[str, Any]] = {}
        self.length = 0

    def world(self) -> World:
        data = self.data
        if data.get("orientation", "orthogonal") != "orthogonal":
            raise ConversionError(f"a level is orthogonal, not {shown(data['orientation'])}")
        if data.get("infinite"):
            raise ConversionError("the map is infinite", "untick Infinite in its properties")
        self.width, self.height = (integer(data.get(n), n) for n in ("width", "height"))
        if not (1 <= self.width <= MAX_SIZE and 1 <= self.height <= MAX_SIZE):
            raise ConversionError(f"a level is at most {MAX_SIZE} cells wide and high")
        self.tile = tuple(integer(data.get(n), n) for n in ("tilewidth", "tileheight"))
        if min(self.tile) < 1:
            raise ConversionError("tilewidth and tileheight must be 1 or more")
        self.tilesets = list(self._tilesets())
        for layer in self._layers(data.get("layers"), "layers"):
            self._layer(layer)
        properties = self._properties()
        if not self.found["start"]:
            self.lost.append(Lost("start", f"no tile is one, so it is the top-left cell; {_HINT}"))
        fields = {"version": 1, "size": [self.width, self.height], **self._cells(), **properties}
        return World(fields, "A map of Tiled.", {}, tuple(self.lost))

    def _tilesets(self) -> Iterator[tuple[int, dict[int, str]]]:
        """Yield the first number of each tileset, and the classes of its tiles."""
        for index, entry in enumerate(sequence(self.data.get("tilesets", []), "tilesets")):
            where = f"tilesets[{index}]"
            tileset = mapping(entry, where)
            if "source" in tileset:
                told = f"{shown(tileset['source'])} is a file of its own; embed the tileset"
                self.lost.append(Lost(where, told))
            classes = {}
            for tile in sequence(tileset.get("tiles", []), f"{where}.tiles"):
                given = mapping(tile, f"{where}.tiles")
                name = given.get("class") or given.get("type")
                if name in CLASSES:
                    classes[integer(given.get("id"), f"{where}.tiles.id")] = str(name)
            yield integer(tileset.get("firstgid"), f"{where}.firstgid"), classes

    def _layers(self, layers: Any, where: str) -> Iterator[dict[str, Any]]:
        for index, entry in enumerate(sequence(layers, where)):
            layer = mapping(entry, f"{where}[{index}]")
            if layer.get("type") == "group":
                yield from self._layers(layer.get("layers"), f"{where}[{index}].layers")
            else:
                yield layer

    def _layer(self, layer: dict[str, Any]) -> None:
        name, kind = shown(layer.get("name")), layer.get("type")
        if kind == "tilelayer":
            self._tiles(layer.get("data"), f"layer {name}")
        elif kind == "objectgroup":
            for thing in sequence(layer.get("objects"), f"layer {name}"):
                self._thing(mapping(thing, f"layer {name}"), f"layer {name}")
        else:
            self.lost.append(Lost(f"layer {name}", "it is no layer of tiles or of objects"))

    def _tiles(self, data: Any, where: str) -> None:
        if isinstance(data, str):
            raise ConversionError(
                f"{where} is packed", "set the map's Tile Layer Format to CSV, and save it again"
            )
        numbers = sequence(data, where)
        if len(numbers) != self.width * self.height:
            raise ConversionError(
                f"{where} has {len(numbers)} tiles, not {self.width * self.height}"
            )
        unknown = 0
        for place, number in enumerate(numbers):
            gid = integer(number, where) & FLIPS
            name = self._class(gid) if gid else None
            if name is not None:
                self.found[name].append((place % self.width, place // self.width))
            unknown += bool(gid) and name is None
        if unknown:
            told = f"{unknown} tiles do not say what they are, and are plain cells; {_HINT}"
            self.lost.append(Lost(where, told))

    def _class(self, gid: int) -> str | None:
        own = [entry for entry in self.tilesets if entry[0] <= gid]
        first, classes = max(own, key=lambda entry: entry[0]) if own else (0, {})
        return classes.get(gid - first)

    def _thing(self, thing: dict[str, Any], where: str) -> None:
        label = f"{where}, object {shown(thing.get('id'))}"
        corners = list(self._corners(thing))
        if len(corners) < 2:
            self.lost.append(Lost(label, "only polylines along the sides of cells count, as walls"))
            return
        properties = self._wall_properties(thing, label)
        for start, end in pairwise(corners):
            edges = list(self._edges(start, end))
            self.length += len(edges)
            if self.length > MAX_LENGTH:
                raise ConversionError(f"{where} has walls along more than {MAX_LENGTH:,} cells")
            if not edges:
                self.lost.append(Lost(label, "a part of it is not along sides of cells of the map"))
            self.walls |= dict.fromkeys(edges, properties)

    def _corners(self, thing: dict[str, Any]) -> Iterator[tuple[int, int]]:
        """Yield the corners of a polyline in cells; none if one of them is no corner of cells."""
        line = thing.get("polyline")
        places = []
        for point in line if isinstance(line, list) else []:
            for axis, size in zip("xy", self.tile, strict=True):
                parts = [each.get(axis, 0) for each in (thing, point) if isinstance(each, dict)]
                if not all(isinstance(part, int | float) and abs(part) < 1e6 for part in parts):
                    return
                place = sum(parts) / size
                if abs(place - round(place)) > 0.25:
                    return
                places.append(round(place))
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
            told = mapping(entry, where)
            if told.get("name") in _WALL_PROPERTIES:
                given[str(told["name"])] = told.get("value")
            else:
                self.lost.append(Lost(where, f"a wall has no property {shown(told.get('name'))}"))
        return given

    def _properties(self) -> dict[str, Any]:
        """Return the fields that stand in the map's properties, as in a level file."""
        fields: dict[str, Any] = {}
        known = LevelFields.model_fields.keys() - SPATIAL - {"version"}
        for entry in sequence(self.data.get("properties", []), "properties"):
            told = mapping(entry, "properties")
            name, value = told.get("name"), told.get("value")
            if not isinstance(name, str) or name not in known:
                self.lost.append(Lost(f"property {shown(name)}", "a level has no such field"))
            elif isinstance(value, str) and name not in TEXTS:
                try:
                    fields[name] = read(SourceFile(f"property {name}", value)).data
                except YamlFault as fault:
                    raise ConversionError(f"property {name}: {fault}") from None
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
        for (x, y, side), length, given in in_rows(self.walls):
            if x < 0 or y < 0:
                x, y, side = (x, 0, "N") if side == "S" else (0, y, "W")
            told = {"at": [x, y], "side": side}
            walls.append(told | ({"length": length} if length > 1 else {}) | given)
        puddles = [{"at": [*c], "size": "small"} for c in found["small-puddle"]]
        puddles += [{"at": [*c], "size": "large"} for c in found["large-puddle"]]
        lists = {"walls": walls, "puddles": puddles, "blocked": list(_rows(found["blocked"]))}
        return fields | {name: entries for name, entries in lists.items() if entries}


def _one_or_all(cells: list[tuple[int, int]]) -> list[Any]:
    return [*cells[0]] if len(cells) == 1 else [[*cell] for cell in cells]


def _rows(cells: list[tuple[int, int]]) -> Iterator[dict[str, Any]]:
    """Yield cells as rectangles, one for those side by side."""
    ordered = enumerate(sorted(cells, key=lambda cell: (cell[1], cell[0])))
    for _, run in groupby(ordered, lambda told: (told[1][1], told[1][0] - told[0])):
        (_, (x, y)), *more = run
        yield {"at": [x, y]} | ({"size": [1 + len(more), 1]} if more else {})


def is_tiled(data: Any) -> bool:
    """Tell whether data looks like a map of Tiled."""
    return isinstance(data, dict) and "layers" in data and "tilewidth" in data
