"""Maps of Tiled, in JSON (`.tmj`) or XML (`.tmx`), as its editor and its command line write them.

Starts, exits, puddles and blocked cells are tiles, identified by their class; walls between cells
are polylines of an object layer. All other fields are custom properties of the map, written as in a
level file.
"""

import cmath
import json
import math
import re
from collections.abc import Iterable, Iterator
from itertools import chain, pairwise
from pathlib import Path
from typing import Any

from babyrobot_levels.extensions.formats.blocks import (
    Edge,
    edge_of,
    edge_runs,
    filled,
    is_inner,
    one_or_all,
    side_entry,
)
from babyrobot_levels.extensions.formats.conversion import (
    Codec,
    Conversion,
    ConversionError,
    Lost,
    World,
    integer,
    mapping,
    read_data,
    sequence,
    shown,
)
from babyrobot_levels.extensions.formats.places import Places, Route
from babyrobot_levels.extensions.formats.tiled_tiles import (
    CLASSES,
    FAR,
    MAX_TILES,
    Beside,
    TileLayer,
    Tilesets,
    tile_layer,
)
from babyrobot_levels.extensions.formats.tmx import data_of, places_of
from babyrobot_levels.language.base import MAX_SIZE
from babyrobot_levels.language.cells import sides_of
from babyrobot_levels.language.fields import DRAWN, LevelFields, Role, fields_with
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.grid import BIT, Grid
from babyrobot_levels.render.colors import rgba
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.text.emitter import flow
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import MAX_BYTES, SourceFile
from babyrobot_levels.text.words import did_you_mean

_ELEMENT = re.compile("<[A-Za-z]+")

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
        folder: the folder of the map: tilesets and templates that are files in it, or below it,
            are read. None to read no other file.

    Raises:
        ConversionError: it is not such a map, malformed, or larger than a level may be.
    """
    data = data_of(source, "map") if _is_tmx(source) else mapping(read_data(source), "the map")
    return _Reader(data, folder).world()


class _Reader:
    def __init__(self, data: dict[str, Any], folder: Path | None):
        self.data = data
        self.beside = Beside(folder)
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
        tilesets = Tilesets(data.get("tilesets", []), self.beside)
        self.lost += tilesets.lost
        layers = list(self._layers(data.get("layers"), ("layers",)))
        tiled = {
            index: tile_layer(layer, f"layer {shown(layer.get('name'))}", size)
            for index, (_, layer) in enumerate(layers)
            if layer.get("type") == "tilelayer"
        }
        if sum(layer.count for layer in tiled.values()) > MAX_TILES:
            raise ConversionError(f"its layers have more than {MAX_TILES:,} tiles")
        box = (0, 0, *size) if size else _box(tiled.values())
        self.left, self.top, self.width, self.height = box
        for index, (route, layer) in enumerate(layers):
            if index in tiled:
                self._tiles(tiled[index], tilesets, route)
            else:
                self._layer(layer, route)
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

    def _layers(self, layers: Any, above: Route) -> Iterator[tuple[Route, dict[str, Any]]]:
        """Yield the layers that count, also those of groups, each with its place."""
        where = ".".join(map(str, above))
        for index, entry in enumerate(sequence(layers, where)):
            layer, route = mapping(entry, f"{where}.{index}"), (*above, index)
            name = f"layer {shown(layer.get('name'))}"
            if self._is_unseen(layer, name, route):
                continue
            if layer.get("type") == "group":
                yield from self._layers(layer.get("layers"), (*route, "layers"))
            else:
                yield route, layer
            if layer.get("offsetx") or layer.get("offsety"):
                self.lost.append(Lost(name, "its offset is ignored", route))

    def _is_unseen(self, part: dict[str, Any], where: str, route: Route) -> bool:
        """Return whether Tiled does not show a layer or an object, which is then left out."""
        why = "hidden" if part.get("visible") is False else "transparent"
        is_unseen = part.get("visible") is False or part.get("opacity") == 0
        if is_unseen:
            self.lost.append(Lost(where, f"left out, because it is {why}", route))
        return is_unseen

    def _layer(self, layer: dict[str, Any], route: Route) -> None:
        name = f"layer {shown(layer.get('name'))}"
        if layer.get("type") == "objectgroup":
            for index, thing in enumerate(sequence(layer.get("objects"), name)):
                self._object(mapping(thing, name), name, (*route, "objects", index))
        else:
            self.lost.append(Lost(name, "neither a tile layer nor an object layer", route))

    def _tiles(self, layer: TileLayer, tilesets: Tilesets, route: Route) -> None:
        unknown = 0
        for x, y, number in layer.placed():
            name = tilesets.class_of(number)
            if name is None:
                unknown += 1
            else:
                self.found[name].append((x - self.left, y - self.top))
        if unknown:
            message = f"{unknown} tiles without a known class become plain cells; {_HINT}"
            self.lost.append(Lost(layer.where, message, route))

    def _object(self, thing: dict[str, Any], where: str, route: Route) -> None:
        label = f"{where}, object {shown(thing.get('id'))}"
        thing = self._with_template(thing, label, route)
        if self._is_unseen(thing, label, route):
            return
        corners = list(self._corners(thing))
        if len(corners) < 2:
            message = "only polylines along edges of cells become walls"
            self.lost.append(Lost(label, message, route))
            return
        properties = self._wall_properties(thing, label, route)
        for start, end in pairwise(corners):
            edges = list(self._edges(start, end))
            self.length += len(edges)
            if self.length > MAX_LENGTH:
                raise ConversionError(f"{where} has walls along more than {MAX_LENGTH:,} cells")
            if not edges:
                message = "a part of it is not along edges of cells of the map"
                self.lost.append(Lost(label, message, route))
            self.walls |= dict.fromkeys(edges, properties)

    def _with_template(self, thing: dict[str, Any], where: str, route: Route) -> dict[str, Any]:
        """Return an object with what its template says of it, if it has one."""
        name = thing.get("template")
        found = {} if name is None else self.beside.data(name, "template")
        if isinstance(found, str):
            self.lost.append(Lost(where, f"its template {shown(name)} {found}", route))
            return thing
        whole = mapping(found.get("object", {}), f"template {shown(name)}")
        properties = (each.get("properties") or [] for each in (whole, thing))
        return whole | thing | {"properties": [*chain.from_iterable(properties)]}

    def _corners(self, thing: dict[str, Any]) -> Iterator[tuple[int, int]]:
        """Yield the corners of a polyline in cells; none if one is not a corner of a cell."""
        line = thing.get("polyline")
        places = []
        for point in line if isinstance(line, list) else []:
            given = [thing.get(name, 0) for name in ("x", "y", "rotation")]
            given += [point.get(axis, 0) if isinstance(point, dict) else None for axis in "xy"]
            if not all(isinstance(each, int | float) and abs(each) < 1e6 for each in given):
                return
            left, top, degrees, across, down = given
            turn = cmath.rect(1, math.radians(degrees)) * complex(across, down)
            for place, size, origin in zip(
                (left + turn.real, top + turn.imag), self.tile, (self.left, self.top), strict=True
            ):
                if abs(place / size - round(place / size)) > 0.25:
                    return
                places.append(round(place / size) - origin)
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

    def _wall_properties(self, thing: dict[str, Any], where: str, route: Route) -> dict[str, Any]:
        given = {}
        for index, entry in enumerate(sequence(thing.get("properties", []), where)):
            found = mapping(entry, where)
            if found.get("name") in _WALL_PROPERTIES:
                given[str(found["name"])] = found.get("value")
            else:
                name = found.get("name")
                guess = did_you_mean(str(name), _WALL_PROPERTIES)
                message = f"a wall has no property {shown(name)}{guess}"
                self.lost.append(Lost(where, message, (*route, "properties", index)))
        return given

    def _properties(self) -> dict[str, Any]:
        """Return the fields in the map's properties, which are written as in a level file."""
        fields: dict[str, Any] = {}
        known = LevelFields.model_fields.keys() - SPATIAL - {"version"}
        for index, entry in enumerate(sequence(self.data.get("properties", []), "properties")):
            found = mapping(entry, "properties")
            name, value = found.get("name"), found.get("value")
            if not isinstance(name, str) or name not in known:
                guess = did_you_mean(str(name), known)
                message = f"a level has no such field{guess}"
                self.lost.append(Lost(f"property {shown(name)}", message, ("properties", index)))
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
            fields["start"] = one_or_all(found["start"])
        fields["exit"] = one_or_all(found["exit"]) if found["exit"] else "none"
        walls = []
        for (x, y, side), length, given in edge_runs(self.walls):
            if x < 0 or y < 0:
                x, y, side = (x, 0, "N") if side == "S" else (0, y, "W")
            walls.append(side_entry(x, y, side, length) | given)
        puddles = [{"at": [*c], "size": "small"} for c in found["small-puddle"]]
        puddles += [{"at": [*c], "size": "large"} for c in found["large-puddle"]]
        blocked = filled(found["blocked"], self.width, self.height)
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


def is_tiled(data: Any) -> bool:
    """Return whether data looks like a map of Tiled."""
    return isinstance(data, dict) and "layers" in data and "tilewidth" in data


def _is_tmx(source: SourceFile, _: object = None) -> bool:
    first = _ELEMENT.search(source.text)
    return source.text.lstrip().startswith("<") and first is not None and first[0] == "<map"


# -- levels to maps -------------------------------------------------------------------------------

PIXELS = 64
"""How wide and high a tile is."""

_NOT_PROPERTIES = SPATIAL | {"version", "name"}
_LAYER = {"opacity": 1, "visible": True, "x": 0, "y": 0}


def write_tiled(level: Level) -> Conversion:
    """Return a level as a map with an embedded tileset, whose picture belongs beside the map."""
    width, height = level.size
    grid = level.grid()
    image = f"{level.name or 'level'}-tiles.png"
    puddles = {puddle.at: f"{puddle.size}-puddle" for puddle in level.puddles}
    ground = {
        (cell % width, cell // width): "blocked"
        for cell, is_blocked in enumerate(grid.blocked_cells)
        if is_blocked
    }
    exits = level.exits if level.exit_one_of is None else ()
    ends = dict.fromkeys(exits, "exit") | dict.fromkeys(level.starts, "start")
    walls = {
        edge: {"pass": glass} if glass else {}
        for edge in _free_edges(grid)
        if (glass := _wall_at(grid, edge)) is not None
    }
    for edge, look in _wall_looks(level).items():
        is_outer = edge not in walls and not is_inner(*edge, *level.size)
        if edge in walls or is_outer:
            walls[edge] = walls.get(edge, {}) | look
    layers = [
        _tile_layer(1, "ground", {**puddles, **ground}, level.size),
        _tile_layer(2, "starts and exits", ends, level.size),
        _wall_layer(3, walls),
    ]
    red, green, blue, _ = rgba(level.resolved_theme.colors.base)
    data = {
        "backgroundcolor": f"#{red:02x}{green:02x}{blue:02x}",
        "compressionlevel": -1,
        "height": height,
        "infinite": False,
        "layers": layers,
        "nextlayerid": len(layers) + 1,
        "nextobjectid": len(layers[-1]["objects"]) + 1,
        "orientation": "orthogonal",
        "properties": list(_properties(level)),
        "renderorder": "right-down",
        "tiledversion": "1.10.2",
        "tileheight": PIXELS,
        "tilesets": [_tileset(image)],
        "tilewidth": PIXELS,
        "type": "map",
        "version": "1.10",
        "width": width,
    }
    lost = () if level.maze is None else (Lost("maze", "it becomes walls"),)
    return Conversion(dumped(data) + "\n", lost, {image: _picture(level)})


def _free_edges(grid: Grid) -> Iterator[Edge]:
    """Yield the edges between two cells of which none is blocked."""
    for cell, blocked in enumerate(grid.blocked_cells):
        y, x = divmod(cell, grid.width)
        for side in ("E", "S"):
            other = grid.neighbour(cell, side)
            if other is not None and not blocked and not grid.blocked_cells[other]:
                yield x, y, side


def _wall_at(grid: Grid, edge: Edge) -> float | None:
    """Return the `pass` probability of the wall at an edge, None if there is no wall."""
    x, y, side = edge
    cell = y * grid.width + x
    return grid.glass.get((cell, side), 0.0) if grid.wall_bits[cell] & BIT[side] else None


def _wall_looks(level: LevelFields) -> dict[Edge, dict[str, Any]]:
    """Return the color, width and fit of the walls that have their own."""
    looks: dict[Edge, dict[str, Any]] = {}
    for wall in level.walls:
        given: dict[str, Any] = {} if wall.color is None else {"color": wall.color}
        given |= {} if wall.width is None else {"width": wall.width}
        given |= {"fit": True} if wall.fit else {}
        for x, y in sides_of(wall) if given else ():
            looks.setdefault(edge_of(x, y, wall.side), {}).update(given)
    return looks


def _tile_layer(
    number: int, name: str, tiles: dict[tuple[int, int], str], size: tuple[int, int]
) -> dict[str, Any]:
    numbers = {name: index for index, name in enumerate(CLASSES, 1)}
    cells = ((x, y) for y in range(size[1]) for x in range(size[0]))
    return {
        **_LAYER,
        "data": [numbers[tiles[cell]] if cell in tiles else 0 for cell in cells],
        "height": size[1],
        "id": number,
        "name": name,
        "type": "tilelayer",
        "width": size[0],
    }


def _wall_layer(number: int, walls: dict[Edge, dict[str, Any]]) -> dict[str, Any]:
    objects: list[dict[str, Any]] = []
    for (x, y, side), length, given in edge_runs(walls):
        down = side == "E"
        left, top = (x + 1, y) if down else (x, y + 1)
        end = (0, length) if down else (length, 0)
        wall: dict[str, Any] = {
            "height": 0,
            "id": len(objects) + 1,
            "name": "",
            "polyline": [{"x": 0, "y": 0}, {"x": end[0] * PIXELS, "y": end[1] * PIXELS}],
            "rotation": 0,
            "type": "wall",
            "visible": True,
            "width": 0,
            "x": left * PIXELS,
            "y": top * PIXELS,
        }
        if given:
            wall["properties"] = [_property(name, given[name]) for name in sorted(given)]
        objects.append(wall)
    return {
        **_LAYER,
        "draworder": "topdown",
        "id": number,
        "name": "walls",
        "objects": objects,
        "type": "objectgroup",
    }


def _property(name: str, value: Any) -> dict[str, Any]:
    kinds = {bool: "bool", float: "float", str: "string"}
    return {"name": name, "type": kinds[type(value)], "value": value}


def _by_rows(weighed: tuple[tuple[int, int], float]) -> tuple[int, int]:
    (x, y), _ = weighed
    return y, x


def _properties(level: Level) -> Iterable[dict[str, Any]]:
    """Yield the fields that are not drawn on the map, in Tiled's order."""
    given = plain(level.model_dump(by_alias=True, exclude_defaults=True))
    if "theme" in given:
        # A named theme may be a file beside the level's.
        given["theme"] = level.to_dict(whole=True).get("theme", given["theme"])
    if level.start_weights:
        # Tiles are read row by row.
        weighed = sorted(zip(level.starts, level.start_weights, strict=True), key=_by_rows)
        given["start_weights"] = [weight for _, weight in weighed]
    for name in sorted(given.keys() - _NOT_PROPERTIES):
        yield _property(name, given[name] if name in TEXTS else flow(given[name]))


def _tileset(image: str) -> dict[str, Any]:
    return {
        "columns": len(CLASSES),
        "firstgid": 1,
        "image": image,
        "imageheight": PIXELS,
        "imagewidth": PIXELS * len(CLASSES),
        "margin": 0,
        "name": "babyrobot",
        "spacing": 0,
        "tilecount": len(CLASSES),
        "tileheight": PIXELS,
        "tiles": [{"id": index, "type": name} for index, name in enumerate(CLASSES)],
        "tilewidth": PIXELS,
    }


def _picture(level: Level) -> bytes:
    """Return the picture of the tiles, drawn as a level with one of each."""
    # It imports Pillow, and maps are read without it.
    from babyrobot_levels.render.raster import to_png

    theme = plain(level.resolved_theme)
    tiles = Level.from_fields(
        {
            "version": 1,
            "size": [len(CLASSES), 1],
            "start": [0, 0],
            "exit": [1, 0],
            "puddles": [{"at": [2, 0], "size": "small"}, {"at": [3, 0], "size": "large"}],
            "blocked": [{"at": [4, 0]}],
            "theme": {**theme, "widths": {**theme.get("widths", {}), "padding": 0, "border": 0}},
        }
    )
    return to_png(build_scene(tiles, robot=False))


def dumped(value: Any, indent: str = "") -> str:
    """Return data as JSON with plain lists on one line, and the keys in order, as Tiled does."""
    inner = f"{indent} "
    if isinstance(value, dict) and value:
        rows = [f"{inner}{json.dumps(key)}:{dumped(value[key], inner)}" for key in sorted(value)]
        return "{\n" + ",\n".join(rows) + f"\n{indent}}}"
    if isinstance(value, list) and value and isinstance(value[0], dict):
        rows = [inner + dumped(each, inner) for each in value]
        return "[\n" + ",\n".join(rows) + f"\n{indent}]"
    return json.dumps(value)


CODEC = Codec(
    read_tiled,
    write_tiled,
    draws=_is_tmx,
    holds=lambda data: isinstance(data, dict) and {"layers", "tilewidth"} <= data.keys(),
    places=lambda source: places_of(source) if _is_tmx(source) else Places(source),
)
