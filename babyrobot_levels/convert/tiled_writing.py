"""Levels to maps of Tiled, in JSON (`.tmj`), as its editor and its command line write them.

Starts, exits, puddles and blocked cells are tiles, identified by their class; walls between cells
are polylines of an object layer. All other fields are custom properties of the map, written as in a
level file.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from typing import Any

from babyrobot_levels.convert.blocks import Edge, edge_of, edge_runs, is_inner
from babyrobot_levels.convert.conversion import Codec, Conversion, Lost
from babyrobot_levels.convert.tiled_reading import SPATIAL, TEXTS, is_tiled, read_tiled
from babyrobot_levels.convert.tiled_tiles import CLASSES
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.language.walls import sides_of
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.grid import BIT, Grid
from babyrobot_levels.render.colors import rgba
from babyrobot_levels.render.raster import to_png
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.text.emitter import flow

PIXELS = 64
"""How wide and high a tile is."""

_NOT_PROPERTIES = SPATIAL | {"version", "name"}


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
        "data": [numbers[tiles[cell]] if cell in tiles else 0 for cell in cells],
        "height": size[1],
        "id": number,
        "name": name,
        "opacity": 1,
        "type": "tilelayer",
        "visible": True,
        "width": size[0],
        "x": 0,
        "y": 0,
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
        "draworder": "topdown",
        "id": number,
        "name": "walls",
        "objects": objects,
        "opacity": 1,
        "type": "objectgroup",
        "visible": True,
        "x": 0,
        "y": 0,
    }


def _property(name: str, value: Any) -> dict[str, Any]:
    kinds = {bool: "bool", float: "float", str: "string"}
    return {"name": name, "type": kinds[type(value)], "value": value}


def _properties(level: Level) -> Iterable[dict[str, Any]]:
    """Yield the fields that are not drawn on the map, in Tiled's order."""
    given = plain(level.model_dump(by_alias=True, exclude_defaults=True))
    if "theme" in given:
        # A named theme may be a file beside the level's.
        given["theme"] = level.to_dict(whole=True).get("theme", given["theme"])
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


CODEC = Codec(read_tiled, write_tiled, holds=is_tiled)
