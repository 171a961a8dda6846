"""Tiled: all fields come back, also from a file that Tiled has saved."""

from __future__ import annotations

import base64
import gzip
import io
import json
import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from PIL import Image
from support.conversions import SAMPLES, level_of_world, lost_fields, world_of
from support.worlds import World, decorated_worlds, level_of

import babyrobot_levels as brl
from babyrobot_levels.extensions.formats import conversion, tiled
from babyrobot_levels.extensions.formats.conversion import ConversionError
from babyrobot_levels.extensions.formats.formats import export
from babyrobot_levels.extensions.formats.reading import guess
from babyrobot_levels.extensions.formats.tiled import read_tiled
from babyrobot_levels.text.source import SourceFile

SAVED = (SAMPLES / "saved-by-tiled.tmj").read_text(encoding="utf-8")

MAP_FIELDS = {
    *("compressionlevel", "height", "infinite", "layers", "nextlayerid", "nextobjectid"),
    *("orientation", "properties", "renderorder", "tiledversion", "tileheight", "tilesets"),
    *("tilewidth", "type", "version", "width", "backgroundcolor"),
}


def map_of(level: str) -> dict[str, Any]:
    # The map that Tiled saved was exported without a time limit, and without facts.
    unlimited = brl.load(level).replace(max_steps=None, expect=None)
    found: dict[str, Any] = json.loads(export(unlimited, "tiled").text)
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


@pytest.mark.slow
@given(decorated_worlds())
@settings(suppress_health_check=[HealthCheck.too_slow])
def test_all_fields_come_back(world: World) -> None:
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
    assert again.resolved_theme == level.resolved_theme


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


def test_weights_of_starts_follow_the_order_of_tiles() -> None:
    level = brl.loads("version: 1\nstart: [[0, 1], [1, 0]]\nstart_weights: [3, 1]\n")
    again = level_of_world(world_of(export(level, "tiled").text, "tiled"))
    assert again.digest == level.digest


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


def test_tiles_are_identified_by_their_class() -> None:
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
        # A turn is clockwise, around the first point.
        (line(32, 8, (0, 0), (8, 0), rotation=90), [{"at": [1, 1], "side": "E"}]),
        (line(32, 8, (0, 0), (8, 0), rotation=-90), [{"at": [1, 0], "side": "E"}]),
        (line(32, 8, (0, 0), (16, 0), rotation=180.0), [{"at": [1, 0], "side": "S"}]),
        (line(32, 8, (0, 8), (8, 8), rotation=90), None),
        (line(32, 8, (0, 0), (16, 0), rotation=45), None),
        (line(0, 8, (0, 0), (16, 0), rotation="90"), None),
        (line(16, 0, (0, 0), (0, 16), visible=False), None),
        (line(16, 0, (0, 0), (0, 16), opacity=0), None),
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


@pytest.mark.parametrize("most", [4, 5])
def test_the_length_of_all_walls_is_bounded(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tiled, "MAX_LENGTH", most)
    corner = line(0, 8, (0, 0), (32, 0), (32, 8))
    layer = {"type": "objectgroup", "name": "w", "objects": [corner, line(16, 0, (0, 0), (0, 16))]}
    if most == 5:
        walls = world_of(foreign(layers=[layer]), "tiled").fields["walls"]
        assert sum(wall.get("length", 1) for wall in walls) == 5
    else:
        with pytest.raises(ConversionError, match="walls along more than 4 cells"):
            world_of(foreign(layers=[layer]), "tiled")


def test_blocked_tiles_side_by_side_are_rectangles() -> None:
    layer = {"type": "tilelayer", "name": "a", "data": [5, 8, 8, 8, 8, 8]}
    world = world_of(foreign(layers=[layer]), "tiled")
    assert world.fields["blocked"] == [
        {"at": [1, 0], "size": [2, 1]},
        {"at": [0, 1], "size": [3, 1]},
    ]
    layer = {"type": "tilelayer", "name": "a", "data": [5, 8, 8, 0, 8, 8]}
    world = world_of(foreign(layers=[layer]), "tiled")
    assert world.fields["blocked"] == [{"at": [1, 0], "size": [2, 2]}]


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
        ({"infinite": True}, "layer 'a', chunks must be a list"),
        ({"infinite": True, "layers": []}, "has no tiles"),
        ({"width": 5000}, "at most 1024"),
        ({"width": None}, "width must be a whole number"),
        ({"tilewidth": 0}, "tilewidth"),
        ({"layers": None}, "layers must be a list"),
        ({"layers": [{"type": "tilelayer", "data": "eJw="}]}, "fewer than 6 tiles"),
        ({"layers": [{"type": "tilelayer", "data": "?"}]}, "not with base64"),
        ({"layers": [{"type": "tilelayer", "data": [1]}]}, "has 1 tiles, not 6"),
        ({"layers": [{"type": "tilelayer", "data": ["x"] * 6}]}, "whole number, not 'x'"),
        ({"tilesets": [{}]}, "firstgid"),
        ({"tilesets": [{"firstgid": 1, "tiles": [{"type": "exit"}]}]}, "id must be a whole number"),
        ({"properties": [{"name": "skid", "value": "{a: [}"}]}, "property skid"),
    ],
)
def test_other_maps_are_refused_with_a_reason(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ConversionError, match=message):
        world_of(foreign(**changes), "tiled")


# -- packed layers ---------------------------------------------------------------------------

PACKERS: dict[str, Callable[[bytes], bytes]] = {
    "": bytes,
    "zlib": zlib.compress,
    "gzip": gzip.compress,
}


def packed(numbers: list[int], compression: str) -> str:
    data = struct.pack(f"<{len(numbers)}I", *numbers)
    return base64.b64encode(PACKERS[compression](data)).decode("ascii")


def packed_layer(data: str, compression: str, **more: Any) -> dict[str, Any]:
    how = {"encoding": "base64", "compression": compression}
    return {"type": "tilelayer", "name": "a", "data": data, **how, **more}


def packed_map(layer: dict[str, Any], **changes: Any) -> str:
    group = {"type": "group", "name": "g", "layers": [layer]}
    return foreign(layers=[{"type": "group", "name": "h", "layers": [group]}], **changes)


@pytest.mark.parametrize("compression", PACKERS)
def test_packed_layers_are_those_that_are_written_as_lists(compression: str) -> None:
    numbers = [5, 8, 0xA0000008, 0, 2, 0]
    plain = {"type": "tilelayer", "name": "a", "data": numbers}
    layer = packed_layer(packed(numbers, compression), compression)
    assert world_of(packed_map(layer), "tiled") == world_of(packed_map(plain), "tiled")


@pytest.mark.parametrize(
    ("data", "compression", "message"),
    [
        (packed([1] * 6, "zlib"), "zstd", "packed with 'zstd', not CSV"),
        (packed([1] * 6, "zlib"), ["zlib"], "packed with"),
        (packed([1] * 6, "zlib"), "gzip", "not with gzip"),
        (packed([1] * 6, "zlib")[:-8], "zlib", "cut off"),
        (packed([1] * 5, "zlib"), "zlib", "fewer than 6 tiles"),
        (packed([1] * 7, "zlib"), "zlib", "more than 6 tiles"),
        (packed([1] * 7, ""), "", "more than 6 tiles"),
    ],
)
def test_badly_packed_layers_are_refused(data: str, compression: Any, message: str) -> None:
    with pytest.raises(ConversionError, match=message):
        world_of(packed_map(packed_layer(data, compression)), "tiled")


@pytest.mark.parametrize(("compression", "bits"), [("zlib", 15), ("gzip", 31)])
def test_no_more_of_a_layer_is_unpacked_than_its_tiles_take(
    compression: str, bits: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    sizes: list[int] = []

    class Counting:
        def __init__(self, window: int):
            self._packed = decompressobj(window)

        def decompress(self, data: bytes, most: int = 0) -> bytes:
            found = self._packed.decompress(data, most)
            sizes.append(len(found))
            return found

        @property
        def eof(self) -> bool:
            return self._packed.eof

    decompressobj = zlib.decompressobj
    monkeypatch.setattr(zlib, "decompressobj", Counting)
    packer = zlib.compressobj(1, zlib.DEFLATED, bits)
    text = base64.b64encode(packer.compress(bytes(1 << 20)) + packer.flush()).decode("ascii")
    with pytest.raises(ConversionError, match="more than 6 tiles"):
        world_of(packed_map(packed_layer(text, compression)), "tiled")
    assert sizes == [6 * 4 + 1]


def test_many_large_layers_are_refused_before_any_is_unpacked() -> None:
    # The damaged data is never unpacked, so it is not reported.
    layer = packed_layer("", "zlib")
    with pytest.raises(ConversionError, match="more than 4,194,304 tiles"):
        world_of(foreign(width=1024, height=1024, layers=[layer] * 5), "tiled")


def test_more_entries_than_a_file_can_hold_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    layer = {"type": "tilelayer", "name": "a", "data": [5, 5, 5, 0, 0, 0]}
    monkeypatch.setattr(tiled, "MAX_THINGS", 3)
    world_of(foreign(layers=[layer]), "tiled")
    monkeypatch.setattr(tiled, "MAX_THINGS", 2)
    with pytest.raises(ConversionError, match="3 starts, exits, walls"):
        world_of(foreign(layers=[layer]), "tiled")


@pytest.mark.slow
def test_the_largest_layer_of_starts_is_refused() -> None:
    layer = packed_layer(packed([5] * 1024**2, "zlib"), "zlib")
    with pytest.raises(ConversionError, match=r"1,048,576 starts, .* too many for one file"):
        world_of(foreign(width=1024, height=1024, layers=[layer]), "tiled")


# -- infinite maps ---------------------------------------------------------------------------


def chunk(x: int, y: int, width: int, data: Any, height: int = 1) -> dict[str, Any]:
    return {"x": x, "y": y, "width": width, "height": height, "data": data}


def infinite(*chunks: dict[str, Any], layers: tuple[Any, ...] = (), **more: Any) -> str:
    layer = {"type": "tilelayer", "name": "a", "chunks": [*chunks], **more}
    # An infinite map's own size means nothing.
    return foreign(infinite=True, width=5000, height=-1, layers=[layer, *layers])


@pytest.mark.parametrize("compression", ["", "zlib"])
def test_an_infinite_map_is_the_box_around_its_tiles(compression: str) -> None:
    numbers = [[0, 0, 5, 0], [8, 0, 1, 0]]
    data: list[Any] = [*numbers]
    if compression:
        data = [packed(each, compression) for each in numbers]
    wall = {"type": "objectgroup", "name": "w", "objects": [line(-16, -8, (0, 0), (0, 8))]}
    text = infinite(
        chunk(-4, -1, 4, data[0]), chunk(0, -1, 4, data[1]), layers=(wall,), compression=compression
    )
    world = world_of(text, "tiled")
    level = level_of_world(world)
    assert (level.size, level.starts) == ((5, 1), ((0, 0),))
    assert level.grid().blocked.tolist() == [[False, False, True, False, False]]
    assert world.fields["walls"] == [{"at": [0, 0], "side": "E"}]


@pytest.mark.parametrize(
    ("chunks", "message"),
    [
        ([chunk(0, 0, 1, [5]), chunk(1024, 0, 1, [5])], "1,025 by 1 cells"),
        ([chunk(0, 0, 2000, [5])], "1 to 1024 cells"),
        ([chunk(0, 0, 0, [])], "1 to 1024 cells"),
        ([chunk(10**7, 0, 1, [5])], "cells away"),
        ([chunk(0, 0, 2, [5])], "has 1 tiles, not 2"),
        ([chunk(0, 0, 1024, [5], height=1024)] * 5, "more than 4,194,304 tiles"),
        ([[]], "chunk 0 must be a mapping"),
        ([{"x": 0}], "chunk 0, y must be a whole number"),
    ],
)
def test_other_infinite_maps_are_refused(chunks: list[Any], message: str) -> None:
    with pytest.raises(ConversionError, match=message):
        world_of(infinite(*chunks), "tiled")


# -- tilesets in files -----------------------------------------------------------------------

TILESET_JSON = json.dumps({"name": "t", "tiles": [{"id": 0, "type": "start"}]})
TILESET_XML = """<?xml version="1.0" encoding="UTF-8"?>
<tileset version="1.10" name="t" tilewidth="16" tileheight="8" tilecount="2">
 <image source="t.png" width="32" height="8"/>
 <tile id="0" type="start"/>
 <tile id="1" class="blocked"><properties><property name="tile" value="x"/></properties></tile>
 <wangsets><tile id="0" type="exit"/></wangsets>
</tileset>
"""


def with_tileset(name: str, folder: Path | None) -> Any:
    tilesets = [{"firstgid": 1, "source": name}]
    layer = {"type": "tilelayer", "name": "a", "data": [0, 1, 0, 0, 0, 0]}
    return read_tiled(SourceFile("map.tmj", foreign(tilesets=tilesets, layers=[layer])), folder)


@pytest.mark.parametrize(
    ("name", "text"), [("t.tsj", TILESET_JSON), ("t.json", TILESET_JSON), ("t.tsx", TILESET_XML)]
)
@pytest.mark.parametrize("below", ["", "tiles/", "tiles/../"])
def test_tilesets_beside_the_map_are_read(name: str, text: str, below: str, tmp_path: Path) -> None:
    (tmp_path / "tiles").mkdir()
    (tmp_path / below / name).write_text(text, encoding="utf-8")
    world = with_tileset(below + name, tmp_path)
    assert (world.fields["start"], world.lost) == ([1, 0], ())


def test_tilesets_elsewhere_are_not_read(tmp_path: Path) -> None:
    (tmp_path / "maps").mkdir()
    (tmp_path / "t.tsj").write_text(TILESET_JSON, encoding="utf-8")
    (tmp_path / "maps" / "linked.tsj").symlink_to(tmp_path / "t.tsj")
    for name in ("../t.tsj", str(tmp_path / "t.tsj"), "linked.tsj", "x/../../t.tsj"):
        world = with_tileset(name, tmp_path / "maps")
        assert "start" not in world.fields
        (told, *_) = world.lost
        assert told.field == "tilesets[0]"
        assert "outside the map's folder" in told.message
        assert "--embed-tilesets" in told.message


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("none.tsx", "no such file"),
        (".", "has none of the suffixes"),
        ("folder.tsj", "this is a directory"),
        ("map.tmj", "has none of the suffixes"),
        ("a\0.tsj", "is not a valid file name"),
        ("\ud800.tsj", "is not a valid file name"),
        ("x" * 5000 + ".tsj", "not"),
        (["t.tsj"], "is a file of its own"),
    ],
)
def test_tilesets_that_are_not_read_are_reported(name: Any, message: str, tmp_path: Path) -> None:
    (tmp_path / "folder.tsj").mkdir()
    world = with_tileset(name, tmp_path)
    assert message in str(world.lost[0])
    assert "--embed-tilesets" in str(world.lost[0])


def test_no_file_is_read_unless_a_folder_is_given(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "t.tsj").write_text(TILESET_JSON, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert "start" not in with_tileset("t.tsj", None).fields


ENTITIES = "".join(f'<!ENTITY a{n} "{f"&a{n - 1};" * 10}">' for n in range(1, 10))
BAD_XML = {
    "bomb": f"<!DOCTYPE tileset [<!ENTITY a0 'a'>{ENTITIES}]><tileset name='&a9;'/>",
    "external": "<!DOCTYPE tileset [<!ENTITY a SYSTEM 'file:///etc/passwd'>]><tileset>&a;</tileset>",
    "cut": TILESET_XML[:200],
    "other": "<map><tileset><tile id='0' type='start'/></tileset></map>",
    "deep": "<tileset>" + "<a>" * 100_000,
    "id": "<tileset><tile id='-1' type='start'/></tileset>",
    "large id": f"<tileset><tile id='{'9' * 5000}' type='start'/></tileset>",
    "empty": "",
}


@pytest.mark.parametrize("name", BAD_XML)
def test_bad_xml_is_refused_with_a_reason(name: str, tmp_path: Path) -> None:
    (tmp_path / "t.tsx").write_text(BAD_XML[name], encoding="utf-8")
    words = "entities|nested deeper|invalid XML|not a tileset of Tiled|id must be a whole number"
    with pytest.raises(ConversionError, match=rf"t\.tsx.*({words})"):
        with_tileset("t.tsx", tmp_path)


def test_a_document_type_of_tiled_is_no_harm(tmp_path: Path) -> None:
    kind = "<!DOCTYPE tileset SYSTEM 'http://mapeditor.org/dtd/1.0/map.dtd'>"
    (tmp_path / "t.tsx").write_text(kind + TILESET_XML.partition("?>")[2], encoding="utf-8")
    assert "start" in with_tileset("t.tsx", tmp_path).fields


# -- XML -------------------------------------------------------------------------------------

TMX = """<?xml version="1.0" encoding="UTF-8"?>
<map version="1.10" orientation="orthogonal" width="3" height="2" tilewidth="16" tileheight="16"
 infinite="0">
 <properties><property name="title" value="Of Tiled"/>
  <property name="max_steps" type="int" value="9"/></properties>
 <tileset firstgid="1" name="t" tilewidth="16" tileheight="16" tilecount="2" columns="2">
  <tile id="0" class="start"/><tile id="1" type="exit"/>
 </tileset>
 <layer id="1" name="ground" width="3" height="2"><data encoding="csv">
1,0,0,
0,0,2
</data></layer>
 <layer id="2" name="old" width="3" height="2" visible="0"><data encoding="csv">2,2</data></layer>
 <objectgroup id="3" name="walls"><object id="1" x="16" y="0"><polyline points="0,0 0,16"/></object>
 </objectgroup>
</map>
"""


def test_a_map_in_xml_is_that_in_json() -> None:
    world = read_tiled(SourceFile("map.tmx", TMX))
    assert guess(SourceFile("map.xml", TMX)) == ["tiled"]
    assert world.fields == {
        "version": 1,
        "size": [3, 2],
        "start": [0, 0],
        "exit": [2, 1],
        "walls": [{"at": [0, 0], "side": "E"}],
        "title": "Of Tiled",
        "max_steps": 9,
    }
    assert [lost.field for lost in world.lost] == ["layer 'old'"]


@pytest.mark.parametrize("text", ["<!--" * 50_000, "<?xml " + "<!-- -->" * 50_000 + "<a>"])
def test_what_is_no_map_is_told_at_once(text: str) -> None:
    assert guess(SourceFile("map.xml", text)) == []


@pytest.mark.parametrize(
    ("encoding", "content"),
    [
        ("", '<tile gid="1"/><tile/><tile/><tile/><tile/><tile gid="2"/>'),
        (' encoding="base64"', "AQAAAAAAAAAAAAAAAAAAAAAAAAACAAAA"),
    ],
)
def test_tiles_in_xml_may_be_packed(encoding: str, content: str) -> None:
    before, _, after = TMX.partition('<data encoding="csv">\n1,0,0,\n0,0,2\n')
    world = read_tiled(SourceFile("map.tmx", f"{before}<data{encoding}>{content}{after}"))
    assert (world.fields["start"], world.fields["exit"]) == ([0, 0], [2, 1])


def test_chunks_in_xml_make_a_map_as_large_as_its_tiles() -> None:
    chunk = '<chunk x="-16" y="0" width="2" height="1">1,2</chunk>'
    infinite = TMX.replace('infinite="0"', 'infinite="1"').replace("\n1,0,0,\n0,0,2\n", chunk)
    world = read_tiled(SourceFile("map.tmx", infinite))
    assert (world.fields["size"], world.fields["exit"]) == ([2, 1], [1, 0])


def test_files_of_tilesets_are_bounded(tmp_path: Path) -> None:
    for n in range(20):
        (tmp_path / f"{n}.tsj").write_text(TILESET_JSON, encoding="utf-8")
    tilesets = [{"firstgid": 1 + n, "source": f"{n}.tsj"} for n in range(20)]
    world = read_tiled(SourceFile("map.tmj", foreign(tilesets=tilesets)), tmp_path)
    told = [str(lost) for lost in world.lost if lost.field.startswith("tilesets")]
    assert len(told) == 4
    assert all("more than 16 files" in each for each in told)


@pytest.mark.parametrize(
    ("look", "why"), [({"visible": False}, "hidden"), ({"opacity": 0.0}, "transparent")]
)
@pytest.mark.parametrize("kind", ["layer", "group"])
def test_what_is_not_shown_is_left_out_and_told(look: Any, why: str, kind: str) -> None:
    layer = {"type": "tilelayer", "name": "a", "data": [0, 8, 0, 0, 0, 0]}
    if kind == "layer":
        layers = [{**layer, **look}]
    else:
        layers = [{"type": "group", "name": "a", "layers": [layer], **look}]
    world = world_of(foreign(layers=layers), "tiled")
    assert "blocked" not in world.fields
    assert f"layer 'a': left out, because it is {why}" in map(str, world.lost)


def test_misspelt_properties_are_told_with_what_is_meant() -> None:
    wall = line(16, 0, (0, 0), (0, 16), properties=[{"name": "colour", "value": "red"}])
    layer = {"type": "objectgroup", "name": "w", "objects": [wall]}
    given = [{"name": "reward", "value": "{step: -2}"}, {"name": 3, "value": 1}]
    world = world_of(foreign(layers=[layer], properties=given), "tiled")
    told = " ".join(map(str, world.lost))
    assert "a wall has no property 'colour'; did you mean `color`?" in told
    assert "property 'reward': a level has no such field; did you mean `rewards`?" in told
    assert "property 3: a level has no such field" in told


def test_an_offset_of_a_layer_is_reported() -> None:
    layer = {"type": "objectgroup", "name": "w", "objects": [], "offsetx": 4}
    assert "layer 'w'" in lost_fields(world_of(foreign(layers=[layer]), "tiled"))


# -- templates -------------------------------------------------------------------------------

TEMPLATE = """<template>
 <object type="wall">
  <properties>
   <property name="pass" type="float" value="0.5"/>
   <property name="width" type="int" value="3"/>
  </properties>
  <polyline points="0,0 16,0"/>
 </object>
</template>"""


def with_template(name: str, folder: Path | None, **thing: Any) -> conversion.World:
    """Return the world of a map with objects that have a template."""
    things = [{"id": 1, "x": 0, "y": 8, "template": name, **thing}] * 2
    layer = {"type": "objectgroup", "name": "o", "objects": things}
    return read_tiled(SourceFile("map.tmj", foreign(layers=[layer], tilesets=[])), folder)


@pytest.mark.parametrize("kind", ["tx", "tj"])
def test_an_object_has_what_its_template_says_unless_it_says_more(
    kind: str, tmp_path: Path
) -> None:
    data = {
        "polyline": [{"x": 0, "y": 0}, {"x": 16, "y": 0}],
        "properties": [{"name": "pass", "value": 0.5}, {"name": "width", "value": 3}],
    }
    text = TEMPLATE if kind == "tx" else json.dumps({"type": "template", "object": data})
    (tmp_path / f"t.{kind}").write_text(text, encoding="utf-8")
    own = [{"name": "width", "value": 2}]
    world = with_template(f"t.{kind}", tmp_path, properties=own)
    assert world.fields["walls"] == [{"at": [0, 0], "side": "S", "pass": 0.5, "width": 2}]


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("../t.tx", TEMPLATE, "is outside the map's folder"),
        ("none.tx", TEMPLATE, "no such file"),
        ("t.png", TEMPLATE, "has none of the suffixes .tx, .tj and .json"),
        # It would be its own template.
        ("t.tx", '<template><object template="t.tx"/></template>', "only polylines"),
        ("t.tx", "<template/>", "only polylines"),
    ],
)
def test_templates_that_help_nothing_are_told(
    name: str, text: str, message: str, tmp_path: Path
) -> None:
    (tmp_path / "t.tx").write_text(text, encoding="utf-8")
    assert message in str(with_template(name, tmp_path).lost[0])
    assert "is a file of its own" in str(with_template(name, None).lost[0])
