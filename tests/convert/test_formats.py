"""What holds for all formats: nothing is lost in silence, and files are told by what is in them."""

from __future__ import annotations

import json
import pickle
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.conversions import level_of_world, sample, world_of
from support.worlds import World, level_of, worlds

import babyrobot_levels as brl
from babyrobot_levels.cli.convert import ExportFormat, WorldFormat
from babyrobot_levels.convert.conversion import Conversion, ConversionError, Lost, fields_lost
from babyrobot_levels.convert.file_text import file_text
from babyrobot_levels.convert.formats import FORMATS, export, guess
from babyrobot_levels.language.formatting.formatter import format_text
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.source import SourceFile

each_format = pytest.mark.parametrize("name", FORMATS)

GALLERY = [info.name for info in brl.levels() if not brl.load(info.name).has_random_maze]

LOOKS = {"title", "description", "author", "license", "source", "tags", "discount", "max_steps"}
LOOKS |= {"theme", "display", "maze"}


def test_the_command_line_knows_all_formats() -> None:
    assert list(WorldFormat) == list(FORMATS)
    assert list(ExportFormat) == [*FORMATS, "png", "svg"]


@each_format
@given(world=worlds(5))
@settings(max_examples=40, suppress_health_check=[HealthCheck.too_slow], deadline=None)
def test_where_nothing_of_the_game_is_lost_it_comes_back(name: str, world: World) -> None:
    level = level_of(world)
    conversion = export(level, name)
    told = {lost.field.split(".")[0] for lost in conversion.warnings}
    if told <= LOOKS:
        assert level_of_world(world_of(conversion.text, name)).digest == level.digest


@each_format
@given(world=worlds(4))
@settings(max_examples=40, suppress_health_check=[HealthCheck.too_slow], deadline=None)
def test_whatever_is_exported_is_known_by_its_look_and_is_a_level(name: str, world: World) -> None:
    text = export(level_of(world), name).text
    assert name in guess(SourceFile("world", text))
    assert level_of_world(world_of(text, name)).digest


@each_format
@pytest.mark.parametrize("level", GALLERY)
def test_the_gallery_gets_there_and_back_as_a_file(name: str, level: str) -> None:
    text = export(brl.load(level), name).text
    world = world_of(text, name)
    written = file_text(world, schema="level.schema.json", name=None, title="Imported")
    assert format_text(written) == written
    assert brl.loads(written).digest == level_of_world(world).digest
    if brl.check(text_of_clean(level), lint=True) == []:
        codes = {found.code for found in brl.check(written, lint=True)}
        # What the world itself has become is for its owner: ways that lead nowhere, for one.
        assert not {code for code in codes if code.startswith("BR6")} - {"BR607"}


def text_of_clean(level: str) -> str:
    return brl.load(level).to_yaml()


FIELDS: dict[str, Any] = {
    "title": "A title",
    "description": "About it",
    "author": "A. Author",
    "license": "CC0",
    "source": "a book",
    "tags": ["wet"],
    "puddles": [{"at": [1, 1]}],
    "puddle_types": {"large": {"reward": -9}},
    "areas": [{"at": [1, 0], "reward": 5, "label": "gold"}],
    "warps": [{"at": [1, 1], "to": [0, 0]}],
    "wind": {"north": [0, 1, 0]},
    "skid": {"probability": 0.3, "to": "others"},
    "rewards": {"bump": -3, "closer": 1},
    "discount": 0.9,
    "max_steps": 7,
    "theme": "green",
    "display": {"coordinates": True},
    "maze": {"seed": 4, "algorithm": "wilson"},
    "blocked": [{"at": [2, 0]}],
    "walls": [{"at": [0, 0], "side": "E", "pass": 0.5}],
    "start": [[0, 0], [1, 0]],
    "exit": [[0, 2], [2, 2]],
}


@each_format
@pytest.mark.parametrize("field", FIELDS)
def test_each_field_comes_back_or_is_told_by_its_name(name: str, field: str) -> None:
    base: World = {"version": 1, "rewards": {"exit": -1} if name == "babyrobot" else {}}
    if name in ("maze-map", "minigrid"):
        base["rewards"] = {"step": 0, "exit": 1}
    plain = level_of(base)
    assert export(plain, name).warnings == ()
    level = level_of({**base, field: FIELDS[field]})
    conversion = export(level, name)
    told = {lost.field.split(".")[0].split("[")[0] for lost in conversion.warnings}
    if field in told or (field == "maze" and "walls" in told):
        return
    again = level_of_world(world_of(conversion.text, name))
    if field == "maze":
        assert again.digest == level.digest
    else:
        assert getattr(again, field) == getattr(level, field)


@each_format
@pytest.mark.parametrize(
    ("field", "value"),
    [("label", "gold"), ("color", "red"), ("skid", 0.5), ("reward", 5), ("ends", True)],
)
def test_each_field_of_an_area_comes_back_or_is_told(name: str, field: str, value: Any) -> None:
    level = level_of({"version": 1, "areas": [{"at": [1, 0], field: value}]})
    conversion = export(level, name)
    if f"areas.{field}" not in {lost.field for lost in conversion.warnings}:
        (area,) = level_of_world(world_of(conversion.text, name)).areas
        assert getattr(area, field) == getattr(level.areas[0], field)


def test_a_difference_that_no_field_explains_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    sokoban = FORMATS["sokoban"]

    def careless(level: Level) -> Conversion:
        return sokoban.write(level.replace(walls=None))

    monkeypatch.setitem(FORMATS, "sokoban", replace(sokoban, write=careless))
    level = level_of({"version": 1, "walls": [{"at": [0, 0], "side": "E"}]})
    (lost,) = export(level, "sokoban").warnings
    assert lost.field == "game"
    assert "at [0, 0], east" in lost.message


def test_lost_fields_are_those_that_say_something() -> None:
    level = level_of({"version": 1, "title": "T", "tags": [], "discount": 1, "max_steps": 3})
    assert list(fields_lost(level, frozenset(), "a map")) == [
        Lost("title", "a map has no place for it"),
        Lost("exit", "a map has no place for it"),
        Lost("max_steps", "a map has no place for it"),
    ]


# -- which format is it? ---------------------------------------------------------------------

GUESSES = {
    "SFFF\nFHFH\nFFFH\nHFFG\n": ["frozen-lake"],
    '["SF", "HG"]': ["frozen-lake"],
    "[['S', 'F'], ['H', 'G']]": ["frozen-lake"],
    '{"desc": ["SG"], "is_slippery": false}': ["frozen-lake"],
    "[[1, 1, 1], [1, 'r', 1], [1, 1, 1]]": ["maze-map"],
    "{'width': 4}": ["babyrobot"],
    "{}": ["babyrobot"],
    "setup = {'width': 4}": ["babyrobot"],
    '{"is_slippery": false}': ["frozen-lake"],
    "[[b'S', b'G']]": ["frozen-lake"],
    '"SFF", "FFG"': ["frozen-lake"],
    '{"unheard": 1}': [],
    '{"layers": [], "tilewidth": 8, "tileheight": 8}': ["tiled"],
    "#####\n#@ .#\n#####": ["sokoban"],
    "#####\n#S E#\n#####": ["maze-dataset", "sokoban"],
    "#####\n#SXE#\n#####": ["maze-dataset"],
    "####\n#SE#\n####": ["sokoban"],
    "WGWGWG\nWG>>WG\nWGWGWG": ["minigrid"],
    "version: 1\n": [],
    "hello": [],
    "42": [],
    "[]": [],
    "[[2]]": [],
}


@pytest.mark.parametrize("text", GUESSES)
def test_a_format_is_known_by_its_look(text: str) -> None:
    assert guess(SourceFile("world", text)) == GUESSES[text]


@pytest.mark.parametrize(("name", "form"), [("b.TMJ", "tiled"), ("b.xsb", "sokoban")])
def test_a_format_is_known_by_its_suffix(name: str, form: str) -> None:
    assert guess(SourceFile(f"a/{name}", "anything")) == [form]


@pytest.mark.parametrize("text", ["", "\n\n", "  \n"])
def test_nothing_is_no_world(text: str) -> None:
    with pytest.raises(ConversionError, match="nothing in it"):
        guess(SourceFile("world", text))


@pytest.mark.parametrize("name", ["maze-dataset", "mazelib", "minigrid"])
def test_real_texts_are_known(name: str) -> None:
    for text in sample(name).values():
        assert set(guess(SourceFile("world", text))) & {"maze-dataset", "minigrid"}


def test_real_maps_are_known() -> None:
    for rows in sample("gymnasium-robotics").values():
        assert guess(SourceFile("world", json.dumps(rows))) == ["maze-map"]


# -- hostile texts ---------------------------------------------------------------------------

HOSTILE = {
    "deep": "[" * 100_000,
    "deep mapping": "{'a':" * 100_000,
    "unary": "[" + "-" * 200_000 + "1]",
    "sum": "[" + "1+" * 50_000 + "1]",
    "digits": "[" + "1" * 100_000 + "]",
    "infinity": "[[Infinity]]",
    "large": "{'width': 1e999}",
    "nul": "[\0]",
    "walls": "{'width': 1024, 'height': 1024, 'walls': [" + "((1, 1, 1000), 'S')," * 5000 + "]}",
    "blocked": "{'width': 1024, 'height': 1024, 'base_areas': ["
    + "(0, 0, 999, 999)," * 5000
    + "]}",
    "wide": "#" * 5000,
    "tall": "S\n" * 5000,
    "bytes": "".join(map(chr, range(256))),
}


@each_format
@pytest.mark.parametrize("text", HOSTILE.values(), ids=HOSTILE)
def test_hostile_texts_are_refused_with_a_message(name: str, text: str) -> None:
    with pytest.raises(brl.LevelError) as caught:
        file_text(world_of(text, name), schema="s.json", name=None, title="T")
    assert all(c.isprintable() or c == "\n" for c in str(caught.value))
    assert len(str(caught.value)) < 2000


@each_format
@given(text=st.text(alphabet="#SEX@.$WGFH> \n[]{}()',:01rgc\"=", max_size=60))
@settings(max_examples=150)
def test_any_text_is_a_level_or_an_error(name: str, text: str) -> None:
    try:
        level_of_world(world_of(text, name))
        guess(SourceFile("world", text))
    except brl.LevelError:
        return


def test_errors_travel_between_processes() -> None:
    with pytest.raises(ConversionError) as caught:
        world_of("{'width': 'x'}", "babyrobot")
    again = pickle.loads(pickle.dumps(caught.value))
    assert isinstance(again, brl.LevelError)
    assert str(again) == str(caught.value)
