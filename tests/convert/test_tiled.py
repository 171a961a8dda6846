"""Tiled: all that a level says comes back, also from a file that Tiled itself has saved."""

from __future__ import annotations

import io
import json
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from PIL import Image
from support.conversions import SAMPLES, level_of_world, lost_fields, world_of
from support.worlds import World, decorated_worlds, level_of

import babyrobot_levels as brl
from babyrobot_levels.convert.conversion import ConversionError
from babyrobot_levels.convert.formats import export

SAVED = (SAMPLES / "saved-by-tiled.tmj").read_text(encoding="utf-8")

MAP_FIELDS = {
    *("compressionlevel", "height", "infinite", "layers", "nextlayerid", "nextobjectid"),
    *("orientation", "properties", "renderorder", "tiledversion", "tileheight", "tilesets"),
    *("tilewidth", "type", "version", "width", "backgroundcolor"),
}


def map_of(level: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(export(brl.load(level), "tiled").text)
    return found


def test_what_tiled_has_saved_is_the_level_that_was_exported() -> None:
    world = world_of(SAVED, "tiled")
    level = brl.load("glass-wall")
    again = level_of_world(world)
    assert again.digest == level.digest
    assert world.lost == ()
    assert (again.title, again.description) == (level.title, level.description)
    assert again.walls == level.walls


def test_a_map_is_what_tiled_saves_but_for_its_version() -> None:
    ours, theirs = map_of("glass-wall"), json.loads(SAVED)
    for name in ("tiledversion", "version"):
        del ours[name], theirs[name]
    assert ours == theirs


@given(decorated_worlds())
@settings(max_examples=60, suppress_health_check=[HealthCheck.too_slow])
def test_whatever_a_level_says_comes_back(world: World) -> None:
    level = level_of(world)
    conversion = export(level, "tiled")
    assert [lost.field for lost in conversion.warnings] == ["maze"] * (level.maze is not None)
    again = level_of_world(world_of(conversion.text, "tiled"))
    assert again.digest == level.digest
    for field in ("title", "description", "author", "license", "source", "tags", "name"):
        if field != "name":
            assert getattr(again, field) == getattr(level, field)
    for field in ("discount", "max_steps", "rewards", "display", "areas", "warps", "wind", "skid"):
        assert getattr(again, field) == getattr(level, field)
    assert again.colors_and_widths == level.colors_and_widths


@pytest.mark.parametrize("name", ["final-maze", "garden", "frozen-lake", "four-corners"])
def test_the_gallery_is_written_as_the_format_says(name: str) -> None:
    data = map_of(name)
    assert set(data) <= MAP_FIELDS
    size = brl.load(name).size
    assert (data["width"], data["height"], data["infinite"]) == (*size, False)
    ground, ends, walls = data["layers"]
    assert [layer["type"] for layer in data["layers"]] == ["tilelayer"] * 2 + ["objectgroup"]
    for layer in (ground, ends):
        assert len(layer["data"]) == size[0] * size[1]
    assert [layer["id"] for layer in data["layers"]] == [1, 2, 3]
    assert data["nextlayerid"] == 4
    numbers = [thing["id"] for thing in walls["objects"]]
    assert numbers == list(range(1, data["nextobjectid"]))
    (tileset,) = data["tilesets"]
    assert [tile["id"] for tile in tileset["tiles"]] == list(range(tileset["tilecount"]))
    assert max(*ground["data"], *ends["data"]) <= tileset["tilecount"]


def test_the_picture_of_the_tiles_is_as_large_as_the_map_says() -> None:
    conversion = export(brl.load("final-maze"), "tiled")
    (tileset,) = json.loads(conversion.text)["tilesets"]
    assert list(conversion.beside) == [tileset["image"]] == ["final-maze-tiles.png"]
    with Image.open(io.BytesIO(conversion.beside[tileset["image"]])) as picture:
        assert picture.size == (tileset["imagewidth"], tileset["imageheight"])
        colors = {picture.convert("RGB").getpixel((64 * tile + 5, 5)) for tile in range(5)}
    # Start, exit, ground and blocked cells differ; both puddles lie on the ground.
    assert len(colors) == 4


# -- maps of others --------------------------------------------------------------------------


def foreign(**changes: Any) -> str:
    """Return a map as people draw them: groups, flipped tiles, an old name for classes."""
    tiles = {
        "firstgid": 5,
        "name": "mine",
        "tiles": [{"id": 0, "class": "start"}, {"id": 3, "type": "blocked"}],
    }
    layer = {"type": "tilelayer", "name": "a", "data": [5, 8, 0x80000008, 0, 2, 0]}
    other = {"type": "tilelayer", "name": "b", "data": [0, 0, 0, 0, 0, 6]}
    return json.dumps(
        {
            "width": 3,
            "height": 2,
            "tilewidth": 16,
            "tileheight": 8,
            "orientation": "orthogonal",
            "tilesets": [tiles, {"firstgid": 1, "source": "old.tsx"}],
            "layers": [{"type": "group", "name": "g", "layers": [layer, other]}],
            **changes,
        }
    )


def test_tiles_say_what_they_are_by_their_class() -> None:
    world = world_of(foreign(), "tiled")
    level = level_of_world(world)
    assert (level.starts, level.exits) == (((0, 0),), ())
    assert level.grid().blocked.tolist() == [[False, True, True], [False, False, False]]
    assert lost_fields(world) == ["tilesets[1]", "layer 'a'", "layer 'b'"]


def test_a_map_without_a_start_says_so() -> None:
    world = world_of(foreign(layers=[]), "tiled")
    assert level_of_world(world).starts == ((0, 0),)
    assert "start" in lost_fields(world)


def line(x: float, y: float, *points: tuple[float, float], **more: Any) -> dict[str, Any]:
    corners = [{"x": right, "y": down} for right, down in points]
    return {"id": 1, "x": x, "y": y, "polyline": corners, **more}


@pytest.mark.parametrize(
    ("thing", "walls"),
    [
        (line(16, 0, (0, 0), (0, 16)), [{"at": [0, 0], "side": "E", "length": 2}]),
        (line(48, 8, (0, 0), (-32, 0)), [{"at": [1, 0], "side": "S", "length": 2}]),
        (line(16.9, 0.4, (0, 0), (0, 7)), [{"at": [0, 0], "side": "E"}]),
        (
            line(0, 8, (0, 0), (16, 0), (16, 8)),
            [{"at": [0, 1], "side": "E"}, {"at": [0, 0], "side": "S"}],
        ),
        (
            line(0, 0, (0, 0), (16, 0), properties=[{"name": "color", "value": "red"}]),
            [{"at": [0, 0], "side": "N", "color": "red"}],
        ),
        (line(0, 0, (0, 0), (16, 8)), None),
        (line(5, 0, (0, 0), (0, 8)), None),
        (line(0, 0, (0, 0), (0, 800)), None),
        ({"id": 2, "x": 0, "y": 0, "width": 16, "height": 16}, None),
        (line(0, 0, (0, 0), ("x", 2)), None),  # type: ignore[arg-type]
    ],
)
def test_polylines_along_the_sides_of_cells_are_walls(
    thing: dict[str, Any], walls: list[Any] | None
) -> None:
    layer = {"type": "objectgroup", "name": "w", "objects": [thing]}
    world = world_of(foreign(layers=[layer]), "tiled")
    assert world.fields.get("walls") == walls
    told = [field for field in lost_fields(world) if field.startswith("layer")]
    assert bool(told) == (walls is None)


def test_properties_are_fields_as_in_a_level_file() -> None:
    properties = [
        {"name": "title", "type": "string", "value": "Rooms: a maze"},
        {"name": "rewards", "type": "string", "value": "{step: -0.5, exit: 3}"},
        {"name": "max_steps", "type": "int", "value": 30},
        {"name": "theme", "type": "string", "value": "green"},
        {"name": "music", "type": "string", "value": "slow.ogg"},
        {"name": "start", "type": "string", "value": "[1, 1]"},
    ]
    world = world_of(foreign(properties=properties), "tiled")
    level = level_of_world(world)
    assert (level.title, level.theme, level.max_steps) == ("Rooms: a maze", "green", 30)
    assert (level.rewards.step, level.rewards.exit) == (-0.5, 3)
    assert lost_fields(world)[-2:] == ["property 'music'", "property 'start'"]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"orientation": "isometric"}, "orthogonal, not 'isometric'"),
        ({"infinite": True}, "infinite"),
        ({"width": 5000}, "at most 1024"),
        ({"width": None}, "width must be a whole number"),
        ({"tilewidth": 0}, "tilewidth"),
        ({"layers": None}, "layers must be a list"),
        ({"layers": [{"type": "tilelayer", "data": "eJw="}]}, "packed"),
        ({"layers": [{"type": "tilelayer", "data": [1]}]}, "has 1 tiles, not 6"),
        ({"layers": [{"type": "tilelayer", "data": ["x"] * 6}]}, "whole number, not 'x'"),
        ({"tilesets": [{}]}, "firstgid"),
        ({"tilesets": [{"firstgid": 1, "tiles": [{"type": "exit"}]}]}, "tiles.id"),
        ({"properties": [{"name": "skid", "value": "{a: [}"}]}, "property skid"),
    ],
)
def test_other_maps_are_refused_with_a_reason(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ConversionError, match=message):
        world_of(foreign(**changes), "tiled")
