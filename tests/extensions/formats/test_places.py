"""Whatever a conversion does not keep is told with the line and the column in the file it is in."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.sessions import babyrobot

from babyrobot_levels.extensions.formats.formats import FORMATS
from babyrobot_levels.extensions.formats.places import Places
from babyrobot_levels.text.source import Position, SourceFile

TMX = """<map orientation="orthogonal" width="1" height="1" tilewidth="8" tileheight="8">
 <properties>
  <property name="titel" value="x"/>
 </properties>
 <group name="g">
  <objectgroup name="o">
   <object id="1" x="0" y="0"/>
  </objectgroup>
 </group>
 <imagelayer name="i"/>
</map>
"""
TMJ = json.dumps(
    {
        "width": 2,
        "height": 1,
        "tilewidth": 8,
        "tileheight": 8,
        "tilesets": [{"firstgid": 1, "source": "none.tsx"}],
        "layers": [
            {"type": "tilelayer", "name": "a", "data": [9, 0]},
            {
                "type": "objectgroup",
                "name": "b",
                "objects": [
                    {
                        "polyline": [{"x": 0, "y": 0}, {"x": 8, "y": 0}],
                        "properties": [{"name": "colour"}],
                    }
                ],
            },
        ],
    },
    indent=1,
)
LDTK = json.dumps(
    {
        "jsonVersion": "1",
        "defs": {"layers": []},
        "levels": [],
        "worlds": [
            {
                "levels": [
                    {
                        "layerInstances": [
                            {"intGridCsv": [0, 0], "__cWid": 2, "__cHei": 1, "__gridSize": 8},
                            {
                                "__gridSize": 8,
                                "entityInstances": [{"__identifier": "Mob", "__grid": [0, 0]}],
                            },
                        ]
                    }
                ]
            }
        ],
    },
    indent=1,
)
METTA = (
    "name: x\nmap_data: |\n  #c@\n  ###\nchar_to_map_name: {'#': wall, '@': agent.agent, c: chest}"
)
DES = (
    "MAZE: \"x\",' '\nMAP\n...\nENDMAP\nOBJECT:('%',\"apple\"),random\nBRANCH:(0,0,0,0),(1,1,1,1)\n"
)
DES += "STAIR:(2,0),down\n"
SETUP = "{\n 'width': 2,\n 'walls': [((0, 0), 'E'),\n  ((1, 0), 'E', {'prob': 0})],\n 'widht': 3}"
SLC = """<SokobanLevels>
 <LevelCollection>
  <Level Id="1"><L>####</L>
   <L>#+.#</L><L>####</L></Level>
 </LevelCollection>
</SokobanLevels>
"""
NONE_DRAWN = "row 0, column 0 is used, the first free cell"

ARC = '{"train": [],\n "test": [{"input": [[0, 3],\n  [3, 0]]}]}'

LOST = {
    "arc": (ARC, ["2:12 task", "2:22 start"]),
    "babyrobot": (SETUP, ["4:3 walls[1]", "4:3 walls[1] prob", "5:2 widht"]),
    "drawing": (
        "as printed\n  +---+---+\n  | S   c |\n  +   +-/-+\n  | E     |\n  +---+---+\n",
        ["3:9 `c`", "4:9 doors"],
    ),
    "frozen-lake": ('{"desc": ["SFG"],\n "render_mode": null}', ["2:2 render_mode"]),
    "maze-map": ('[["c", 0],\n [0, 1, ],\n ["g", "g"]]', ["1:3 c", "3:8 g"]),
    "maze-dataset": ("\n#####\n#SXE#\n# ###\n#S  #\n#####\n", ["3:3 X", "5:2 start"]),
    "minigrid": (
        "WGWGWGWGWG\nWG>>  FGWG\nWG  KR>>WG\nWGWGWGWGWG\n",
        ["3:5 objects", "2:7 floor", "3:7 agents", "1:1 goal"],
    ),
    "karel": (
        "Dimension: (2, 1)\nKarel: (1, 1); east\nBeeperBag: 3\nColor: (2, 1); red\n"
        "Beeper: (2, 1); 2\n",
        ["1:1 task", "3:1 beeperbag", "4:1 color", "5:1 beepers", "5:1 beepers"],
    ),
    "ldtk": (LDTK, ["13:8 start", "24:9 entity 'Mob'"]),
    "mettagrid": (METTA, ["3:4 `c`", "3:3 objects"]),
    "micromouse": (
        "A maze\no---o---o\n| S   S  \no   o   o\n|     G |\no---o---o\n",
        ["3:9 the outer wall", "3:7 start"],
    ),
    "minihack": (DES, ["5:1 OBJECT"]),
    "movingai": (
        "type octile\nheight 2\nwidth 3\nmap\n..W\n...\n",
        ["5:1 diagonal moves", "5:1 start", "5:3 `W`"],
    ),
    "overcooked": ('{"grid": """XPX\n   1 2""", "x": 1}', ["1:13 orders"]),
    "rware": (".x\ngg\n", ["1:2 `x`", "1:1 agents", "1:1 start"]),
    "vglc": ("WWFWW\nWDMSW\nWW--W\n", ["2:2 `D`", "2:3 `M`", "1:3 start"]),
    "sokoban": ("Title: a@b\n######\n#@. @#\n######\n", ["3:5 start"]),
    "tiled": (TMX, ["3:3 property 'titel'", "7:4 layer 'o'", "10:2 layer 'i'", "1:1 start"]),
}
"""For each format, a text, and what is lost of it, each with line and column."""

MORE = {
    "tiled": (TMJ, ["7:3 tilesets[0]", "13:3 layer 'a'", "37:7 layer 'b'", "1:1 start"]),
    "sokoban": (SLC, ["4:8 +"]),
    "frozen-lake": ("desc=['SG'],\nrender_mode=None", ["2:1 render_mode"]),
}
"""The same of other kinds of files of these formats."""

CASES = [(name, *case) for cases in (LOST, MORE) for name, case in cases.items()]


@pytest.mark.parametrize(("name", "text", "expected"), CASES, ids=lambda value: str(value)[:12])
def test_what_is_lost_has_its_place(name: str, text: str, expected: list[str]) -> None:
    world = FORMATS[name].read(SourceFile("world", text))
    told = []
    for lost in world.lost:
        assert isinstance(lost.at, Position)
        told.append(f"{lost.at.line}:{lost.at.column} {lost.field.partition(',')[0]}")
    assert sorted(told) == sorted(expected)


def test_all_formats_are_there() -> None:
    # A maze of gym-maze loses nothing, and one of 256 bytes has no places.
    assert {*LOST, "gym-maze", "maz"} == {*FORMATS.own}


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("name", LOST)
def test_a_strict_import_refuses_it_there(name: str) -> None:
    text, expected = LOST[name]
    Path("world.txt").write_text(text, encoding="utf-8")
    result = babyrobot("import", "world.txt", "--from", name, "--strict")
    assert (result.status, result.out) == (1, "")
    told = [line.partition(": error: ")[0] for line in result.err.splitlines()]
    assert sorted(told) == sorted(f"world.txt:{each.partition(' ')[0]}" for each in expected)


def test_a_level_of_a_collection_has_the_places_of_the_whole_text() -> None:
    maps = SourceFile("set.txt", "; 1\n4#|#@.#|4#\n\n; 2\n4#|#+.#|4#\n")
    (lost,) = FORMATS["sokoban"].read(maps, number=2).lost
    assert lost.place("set.txt") == "set.txt:5:5: "


@pytest.mark.parametrize(
    ("text", "route", "expected"),
    [
        ('{"a": [1, {"b": "é", "c": 2}]}', ("a", 1, "c"), (1, 22)),
        ("\n  [[true, null],\n   [3]]", (1,), (3, 4)),
        ("setup = {'é': 1, 'a': (2, 'b')}", ("a", 1), (1, 27)),
        ("a=1,\nb={'c': 2}", ("b", "c"), (2, 4)),
        ("[1, 2, 3]", (2,), (1, 1)),
        ('{"a": 1}', ("b", 3), (1, 1)),
        ("{", ("a",), (1, 1)),
    ],
)
def test_values_of_data_have_places(
    text: str, route: tuple[str | int, ...], expected: tuple[int, int]
) -> None:
    assert Places(SourceFile("data", text))(route) == expected
