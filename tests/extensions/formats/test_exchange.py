"""Levels in other formats: nothing is lost without a warning, and they come back as files."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from support.combinations import swept
from support.conversions import SAMPLES, level_of_world, world_of
from support.worlds import World, level_of, worlds

import babyrobot_levels as brl
from babyrobot_levels.extensions.formats import conversion
from babyrobot_levels.extensions.formats.conversion import Conversion, Lost, fields_lost, file_text
from babyrobot_levels.extensions.formats.formats import FORMATS, Format, export
from babyrobot_levels.extensions.formats.reading import guess
from babyrobot_levels.language.fields import Role, fields_with
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.source import SourceFile

WRITTEN = [name for name, each in FORMATS.items() if each.is_written and name != "maz"]
"""The formats that levels of all sizes are written in."""

GALLERY = [info.name for info in brl.levels() if not brl.load(info.name).has_random_maze]

LOOKS = {"title", "description", "author", "license", "source", "tags", "discount", "max_steps"}
LOOKS |= {"theme", "display", "maze"}


def writing(name: str, write: Callable[[Level], Conversion]) -> Format:
    """Return a format with another writer."""
    codec = replace(FORMATS[name].codec, write=write)
    return replace(FORMATS[name], codec=codec)


each_kind_of_format = pytest.mark.parametrize(
    "name", swept(["frozen-lake", "minigrid", "tiled"], WRITTEN)
)
"""A drawing and a table of rewards, a grid of objects, and layers; the others are like these."""


@pytest.mark.slow
@each_kind_of_format
@given(world=worlds(5))
@settings(suppress_health_check=[HealthCheck.too_slow])
def test_the_mdp_comes_back_where_no_warning_says_otherwise(name: str, world: World) -> None:
    level = level_of(world)
    conversion = export(level, name)
    assert name in guess(SourceFile("world", conversion.text))
    again = level_of_world(world_of(conversion.text, name))
    warned = {lost.field.split(".")[0] for lost in conversion.warnings}
    assert again.digest == level.digest or not warned <= LOOKS


KEY: World = {"items": [{"name": "key", "at": [1, 1]}]}
GUARD: World = {"movers": [{"path": [[2, 0], [2, 1]]}]}
WATER: World = {"puddles": [{"at": [1, 1], "size": "small"}]}
SLOPE: World = {"walls": [{"at": [1, 1], "side": "E"}]}
CHANGES: dict[str, tuple[World, World]] = {
    "size": ({}, {"size": [5, 3]}),
    "start": ({}, {"start": [[0, 0], [1, 0]]}),
    "start_weights": ({"start": [[0, 0], [1, 0]]}, {"start_weights": [1, 3]}),
    "heading": ({}, {"heading": "S"}),
    "exit": ({}, {"exit": [[3, 2], [3, 1]]}),
    "exit_one_of": ({"exit": [[3, 2], [3, 1]]}, {"exit": None, "exit_one_of": [[3, 2], [3, 1]]}),
    "exit_weights": ({"exit": None, "exit_one_of": [[3, 2], [3, 1]]}, {"exit_weights": [1, 3]}),
    "boxes": ({}, {"boxes": [{"at": [1, 1]}]}),
    "targets": (
        {"boxes": [{"at": [1, 1]}], "rewards": {"covered": 2}},
        {"targets": [{"at": [2, 1]}]},
    ),
    "exit_needs": (KEY, {"exit_needs": "key"}),
    "maze": ({}, {"maze": {"seed": 1}}),
    "walls": ({}, SLOPE),
    "openings": ({"maze": {"seed": 1}}, {"openings": [{"at": [1, 1], "side": "E"}]}),
    "doors": (KEY, {"doors": [{"at": [2, 1], "side": "E", "needs": ["key"]}]}),
    "items": ({}, KEY),
    "switches": ({}, {"switches": [{"name": "lever", "at": [1, 1]}]}),
    "movers": ({}, GUARD),
    "hit": (GUARD, {"hit": {"reward": -5}}),
    "puddles": ({}, WATER),
    "puddle_types": (WATER, {"puddle_types": {"small": {"reward": -7}}}),
    "areas": ({}, {"areas": [{"at": [0, 2], "reward": -3}, {"at": [1, 1], "ends": True}]}),
    "blocked": ({}, {"blocked": [{"at": [1, 1]}]}),
    "warps": ({}, {"warps": [{"at": [1, 1], "to": [2, 2]}]}),
    "wind": ({}, {"wind": {"north": [0, 1, 0, 0]}}),
    "skid": ({}, {"skid": {"probability": 0.2, "to": "sides"}}),
    "moves": ({}, {"moves": 8}),
    "rewards": ({}, {"rewards": {"step": -2, "bump": -4}}),
}
"""For each field that changes the MDP, a level's other fields, and the field."""

OTHERS: tuple[World, ...] = ({"wind": {"east": [0, 1, 0]}}, {"rewards": {"bump": -4}})
"""What nearly all formats warn of."""


NEEDED = {
    **{"exit_one_of": "exit", "exit_needs": "items", "doors": "items"},
    **{"start_weights": "start", "exit_weights": "exit_one_of"},
    **{"hit": "movers", "puddle_types": "puddles", "targets": "boxes"},
}
"""Fields that mean nothing where another one is lost."""


def test_every_field_of_the_mdp_is_exported_beside_another() -> None:
    names = fields_with(Role.GEOMETRY, Role.DYNAMICS, Role.REWARD)
    # Of several robots, files of games tell nothing: such levels are refused.
    assert {*CHANGES} == {*names} - {"map", "legend", "robots", "team"}


@pytest.mark.parametrize("name", WRITTEN)
def test_several_robots_are_refused(name: str) -> None:
    robots = [{"name": "a", "start": [0, 0]}, {"name": "b", "start": [1, 0]}]
    with pytest.raises(brl.LevelError, match=r"2 robots.*only for levels with one"):
        export({"version": 1, "robots": robots}, name)


@pytest.mark.slow
@pytest.mark.parametrize("name", swept(["tiled"], WRITTEN))
def test_what_is_lost_is_told_whatever_else_is(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    plain = {"version": 1, "size": [4, 3], "start": [0, 0], "exit": [3, 2]}
    write = FORMATS[name].write
    for field, (around, change) in CHANGES.items():
        other = next(other for other in OTHERS if field not in other)
        without = brl.load({**plain, **other}).replace(**around)
        level = without.replace(**change)
        told = [lost.field for lost in export(level, name).warnings]
        again = level_of_world(world_of(export(level, name).text, name))
        assert told or again.digest == level.digest, field
        assert "MDP" not in told, field
        # A format that does not know the field, and says nothing of it.
        with monkeypatch.context() as patches:
            kept = write(without)
            patches.setitem(FORMATS.own, name, writing(name, lambda _, kept=kept: kept))  # type: ignore[misc]
            told = [lost.field.partition(".")[0] for lost in export(level, name).warnings]
        if level.digest != without.digest and {field, NEEDED.get(field)}.isdisjoint(told):
            assert "MDP" in told, field


CAUSES = ["final-maze", "frozen-lake", "glasshouse", "teleport-pads", "blocked-shapes", "areas"]
"""Levels that differ in kind: a maze with puddles, a lake, glass, warps, no rectangle, areas."""


OTHER_LEVELS = [
    pytest.param(name, marks=pytest.mark.sweep)
    for name in sorted({*GALLERY} - {*CAUSES})
    if not brl.load(name).robots
]


@pytest.mark.slow
@pytest.mark.parametrize("level", [*swept(CAUSES[::2], CAUSES), *OTHER_LEVELS])
def test_levels_come_back_as_files(level: str) -> None:
    for name in WRITTEN:
        assert_comes_back_as_a_file(name, brl.load(level))


def assert_comes_back_as_a_file(name: str, level: Level) -> None:
    world = world_of(export(level, name).text, name)
    written = file_text(world, schema="level.schema.json", name=None, title="Imported")
    assert brl.format(written) == written, name
    assert brl.loads(written).digest == level_of_world(world).digest, name
    if not brl.lint(level.to_yaml()):
        codes = {found.code for found in brl.lint(written)}
        # Whether the level itself is a good one is not for the conversion to say.
        assert not {code for code in codes if code.startswith("BR6")} - {"BR607"}, name


FIELDS: dict[str, Any] = {
    "title": "A title",
    "description": "About it",
    "author": "A. Author",
    "license": "CC0",
    "source": "a book",
    "tags": ["wet"],
    "discount": 0.9,
    "max_steps": 7,
    "theme": "green",
    "display": {"coordinates": True},
}
"""Fields that do not change the MDP."""


@pytest.mark.parametrize("field", FIELDS)
def test_each_field_comes_back_or_is_named_as_lost(field: str) -> None:
    for name in WRITTEN:
        base: World = {"version": 1, "rewards": {}}
        if name in ("maze-map", "minigrid"):
            base["rewards"] = {"step": 0, "exit": 1}
        assert export(level_of(base), name).warnings == ()
        level = level_of({**base, field: FIELDS[field]})
        conversion = export(level, name)
        if field not in {each.field for each in conversion.warnings}:
            again = level_of_world(world_of(conversion.text, name))
            assert getattr(again, field) == getattr(level, field), name


@pytest.mark.parametrize(
    ("field", "value"),
    [("label", "gold"), ("color", "red"), ("skid", 0.5), ("reward", 5), ("ends", True)],
)
def test_each_field_of_an_area_comes_back_or_is_named_as_lost(field: str, value: Any) -> None:
    level = level_of({"version": 1, "areas": [{"at": [1, 0], field: value}]})
    for name in WRITTEN:
        conversion = export(level, name)
        if f"areas.{field}" not in {lost.field for lost in conversion.warnings}:
            (area,) = level_of_world(world_of(conversion.text, name)).areas
            assert getattr(area, field) == getattr(level.areas[0], field), name


def test_a_difference_that_no_field_explains_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    sokoban = FORMATS["sokoban"]

    def careless(level: Level) -> Conversion:
        return sokoban.write(level.replace(walls=None))

    monkeypatch.setitem(FORMATS.own, "sokoban", writing("sokoban", careless))
    level = level_of({"version": 1, "walls": [{"at": [0, 0], "side": "E"}]})
    (lost,) = export(level, "sokoban").warnings
    assert lost.field == "MDP"
    assert "at [0, 0], east" in lost.message


def test_lost_fields_are_those_that_differ_from_their_defaults() -> None:
    level = level_of({"version": 1, "title": "T", "tags": [], "discount": 1, "max_steps": 3})
    assert list(fields_lost(level, frozenset(), "a map")) == [
        Lost("title", "a map cannot hold it"),
        Lost("exit", "a map cannot hold it"),
        Lost("max_steps", "a map cannot hold it"),
    ]


LARGE_REWARDS = sorted((SAMPLES / "large-rewards").iterdir())


@pytest.mark.parametrize("path", LARGE_REWARDS, ids=lambda path: path.stem)
def test_levels_with_large_rewards_come_back_as_files(path: Path) -> None:
    level = brl.load(path)
    level = level.with_maze_seed(1) if level.has_random_maze else level
    world = world_of(export(level, "frozen-lake").text, "frozen-lake")
    written = file_text(world, schema="level.schema.json", name=None, title="Imported")
    assert brl.loads(written).digest == level_of_world(world).digest
    assert max(map(len, re.findall(r"\d+", written))) < 40


@pytest.mark.parametrize("digits", [15, 100, 300])
def test_large_integers_of_other_programs_are_numbers_with_exponents(digits: int) -> None:
    text = f'{{"desc": ["SG"], "reward_schedule": [1{"0" * digits}, 0, 0]}}'
    exit_reward = world_of(text, "frozen-lake").fields["rewards"]["exit"]
    assert exit_reward == float(10**digits)
    assert isinstance(exit_reward, float if digits > 15 else int)


def test_a_world_that_is_no_level_is_told_by_its_fields() -> None:
    world = conversion.World({"size": [3, 3], "puddles": [{"at": [7, 7]}]}, "A world.", {}, ())
    with pytest.raises(conversion.ConversionError) as caught:
        file_text(world, schema=None, name=None, title="Imported")
    assert str(caught.value).splitlines()[:2] == [
        "this is not a valid level:",
        "puddles[0].at: error BR301: the puddle [7, 7] is off the grid, which is 3 wide and 3 high",
    ]
