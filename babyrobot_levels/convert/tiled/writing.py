"""Levels to maps of Tiled."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

from babyrobot_levels.convert.conversion import Conversion, Lost
from babyrobot_levels.convert.edges import Edge, edge_runs, free_edges, wall_at, wall_looks
from babyrobot_levels.convert.tiled.reading import SPATIAL, TEXTS
from babyrobot_levels.convert.tiled.tiles import CLASSES
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.library.level import Level
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
        for edge in free_edges(grid)
        if (glass := wall_at(grid, edge)) is not None
    }
    for edge, look in wall_looks(level).items():
        is_outer = edge not in walls and _is_outer(edge, level.size)
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


def _is_outer(edge: Edge, size: tuple[int, int]) -> bool:
    x, y, side = edge
    return x < 0 or y < 0 or (x == size[0] - 1 if side == "E" else y == size[1] - 1)


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
