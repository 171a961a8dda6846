"""Projects of LDtk."""

from __future__ import annotations

import json
from typing import Any

import pytest
from support.conversions import level_of_world, lost_fields

from babyrobot_levels.extensions.formats.conversion import ConversionError, World
from babyrobot_levels.extensions.formats.formats import FORMATS
from babyrobot_levels.extensions.formats.reading import guess
from babyrobot_levels.text.source import SourceFile

VALUES = [{"value": 1, "identifier": "walls"}, {"value": 2, "identifier": "water"}]


def entity(name: str, x: int, y: int) -> dict[str, Any]:
    return {"__identifier": name, "__grid": [x, y]}


def project(**changed: Any) -> dict[str, Any]:
    grid = {
        "__identifier": "Collisions",
        "__type": "IntGrid",
        "__cWid": 4,
        "__cHei": 2,
        "__gridSize": 8,
        "layerDefUid": 7,
        "intGridCsv": [0, 0, 2, 0, 1, 3, 0, 0],
        "entityInstances": [],
    }
    entities = {
        "__identifier": "Entities",
        "__gridSize": 16,
        "layerDefUid": 8,
        "intGridCsv": [],
        "entityInstances": [entity("PlayerStart", 0, 0), entity("Exit", 1, 0), entity("Mob", 1, 0)],
    }
    level = {"identifier": "One", "layerInstances": [entities, grid]}
    layers = [{"uid": 7, "intGridValues": VALUES}, {"uid": 8, "intGridValues": []}]
    return {
        "jsonVersion": "1.5.3",
        "externalLevels": False,
        "defs": {"layers": layers},
        "levels": [level],
        **changed,
    }


def read(data: dict[str, Any]) -> World:
    return FORMATS["ldtk"].read(SourceFile("p.ldtk", json.dumps(data)))


def test_a_level_has_the_walls_of_its_grid_and_the_ends_of_its_entities() -> None:
    assert guess(SourceFile("p.json", json.dumps(project()))) == ["ldtk"]
    world = read(project())
    level = level_of_world(world)
    assert (level.title, level.starts, level.exits) == ("One", ((0, 0),), ((2, 0),))
    # A value without a name blocks as well.
    assert level.grid().blocked.tolist() == [[False] * 4, [True, True, False, False]]
    assert lost_fields(world) == ["value 'water'", "entity 'Mob'"]


def test_each_level_of_a_project_is_a_world() -> None:
    levels = project()["levels"]
    source = SourceFile("p.ldtk", json.dumps(project(worlds=[{"levels": levels * 2}])))
    assert len(FORMATS["ldtk"].parts(source)) == 3


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"externalLevels": True}, "files of their own"),
        ({"levels": []}, "0 worlds"),
        ({"levels": [{"layerInstances": []}]}, "no IntGrid layer"),
        ({"levels": [{"layerInstances": None}]}, "layerInstances must be a list"),
        ({"levels": [3]}, "the level must be a mapping"),
        ({"defs": None}, "defs must be a mapping"),
        ({"defs": {"layers": [{"uid": 7, "intGridValues": [3]}]}}, "must be a mapping"),
    ],
)
def test_what_is_no_level_is_refused(changed: dict[str, Any], message: str) -> None:
    with pytest.raises(ConversionError, match=message):
        read(project(**changed))


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("__cWid", 10**9, "1000000000 by 2"),
        ("__cWid", "4", "__cWid must be a whole number"),
        ("intGridCsv", [1, 2], "has 2 cells"),
        ("intGridCsv", ["x"] * 8, "intGridCsv must be a whole number"),
    ],
)
def test_a_faulty_layer_is_refused(key: str, value: Any, message: str) -> None:
    data = project()
    data["levels"][0]["layerInstances"][1][key] = value
    with pytest.raises(ConversionError, match=message):
        read(data)
