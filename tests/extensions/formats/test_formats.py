"""The formats: what each of them reads and writes, and which one a text is in."""

from __future__ import annotations

import inspect
import json
import pickle
from typing import Any

import gymnasium
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.conversions import level_of_world, sample, world_of

import babyrobot_levels as brl
from babyrobot_levels.extensions.formats import commands
from babyrobot_levels.extensions.formats.conversion import ConversionError, file_text
from babyrobot_levels.extensions.formats.formats import FORMATS
from babyrobot_levels.extensions.formats.reading import UnknownFormatError, format_of, guess
from babyrobot_levels.text.source import SourceFile

each_format = pytest.mark.parametrize("name", FORMATS)


@each_format
def test_what_the_entry_says_is_what_there_is(name: str) -> None:
    entry = FORMATS[name]
    assert not entry.written_suffixes or entry.is_written
    read = inspect.signature(entry.codec.read).parameters
    assert [*read][1:] == [*entry.keywords]


def test_the_command_line_knows_all_formats() -> None:
    told = " ".join((commands.import_level.__doc__ or "").split())
    assert [each.texts for each in FORMATS.values() if each.texts not in told] == []


def test_what_is_read_and_not_written() -> None:
    read_only = [name for name, each in FORMATS.items() if not each.is_written]
    others = ["gym-maze", "karel", "ldtk", "mettagrid"]
    others += ["minihack", "overcooked", "rware", "vglc"]
    assert read_only == ["arc", "babyrobot", "drawing", *others]
    with pytest.raises(ValueError, match="not written as a keyword setup"):
        FORMATS["babyrobot"].write(brl.load("maze"))


# -- recognising a format ---------------------------------------------------------------------

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
    "[b'SF', b'FG']": ["frozen-lake"],
    '"SFF", "FFG"': ["frozen-lake"],
    '{"unheard": 1}': [],
    '{"layers": [], "tilewidth": 8, "tileheight": 8}': ["tiled"],
    "#####\n#@ .#\n#####": ["sokoban"],
    "#####\n#S E#\n#####": ["maze-dataset", "sokoban"],
    "#####\n#SXE#\n#####": ["maze-dataset"],
    "####\n#SE#\n####": ["sokoban"],
    "WGWGWG\nWG>>WG\nWGWGWG": ["minigrid"],
    "version: 1\n": [],
    "desc=['SFF'], is_slippery=False": ["frozen-lake"],
    "(c) 2020, somebody": [],
    "'Quoted', not data": [],
    "title Box\n========\nOBJECTS\n========\n\nWall\nBROWN\n01010\n": [],
    "+---+---+\n| S   E |\n+---+---+\n\nE  exit: ends the episode, 0\n": ["drawing"],
    "[1, 2]": [],
    "hello": [],
    "42": [],
    "[]": [],
    "[[2]]": [],
}


@pytest.mark.parametrize("text", GUESSES)
def test_a_format_is_recognised_by_its_content(text: str) -> None:
    assert guess(SourceFile("world", text)) == GUESSES[text]


@pytest.mark.parametrize(("name", "form"), [("b.TMJ", "tiled"), ("b.xsb", "sokoban")])
def test_a_format_is_recognised_by_its_suffix(name: str, form: str) -> None:
    assert guess(SourceFile(f"a/{name}", "anything")) == [form]


UNKNOWN = {
    "docker.yaml": ('version: "3.8"\n', "docker.yaml is YAML, but no level", "formats"),
    "compose.yaml": ("version: 1\nservices: {}\n", "compose.yaml is YAML, but no level", "formats"),
    "maze.yaml": ("version: 1\n", "maze.yaml is already a level file", "babyrobot export"),
    "levels.xml": ('<?xml version="1.0"?>\n<Levels/>', "levels.xml is XML", "a text"),
    "game.txt": ("title Box\n====\n0123\n", "the format of game.txt is unknown", "one of"),
    "two.txt": ("#####\n#S E#\n#####", "may be a maze-dataset ASCII or a map of #", "sokoban"),
}


@pytest.mark.parametrize("name", UNKNOWN)
def test_why_a_format_is_unknown_is_true(name: str) -> None:
    text, message, help_text = UNKNOWN[name]
    with pytest.raises(UnknownFormatError) as caught:
        format_of(SourceFile(name, text))
    assert message in str(caught.value)
    assert help_text in str(caught.value.help)


def test_what_is_meant_as_data_is_refused_with_the_place() -> None:
    for text, place in (("setup = {'width': 4,", "1:9"), ('{"desc": [}', "1:11")):
        with pytest.raises(ConversionError, match=f"world:{place}: error: invalid"):
            guess(SourceFile("world", text))


LAKE = ["SFF", "FHG"]


@pytest.mark.parametrize(
    "data",
    [
        LAKE,
        tuple(LAKE),
        {"desc": LAKE},
        np.array([[*row] for row in LAKE], "S1"),
        {"width": np.int64(3), "height": 2, "end": (2, 1)},
        [["r", 0, 0], [0, 1, "g"]],
    ],
    ids=str,
)
def test_what_a_file_would_hold_is_imported_as_well(data: Any) -> None:
    level = brl.import_(data)
    assert (level.size, level.starts, level.exits, level.name) == (
        (3, 2),
        ((0, 0),),
        ((2, 1),),
        None,
    )


@pytest.mark.parametrize("keywords", [{}, {"map_name": "8x8", "is_slippery": False}], ids=str)
def test_a_lake_is_imported_by_its_id_and_as_an_environment(keywords: dict[str, Any]) -> None:
    env = gymnasium.make("FrozenLake-v1", **keywords)
    for level in (
        brl.import_("FrozenLake-v1", kwargs=keywords),
        brl.import_("gymnasium:FrozenLake-v1", kwargs=keywords),
        brl.import_(env),
    ):
        assert brl.compare(level, env).equal
        assert level.max_steps == gymnasium.spec("FrozenLake-v1").max_episode_steps


def test_other_environments_and_data_are_refused() -> None:
    with pytest.raises(ConversionError, match="CartPoleEnv is neither"):
        brl.import_(gymnasium.make("CartPole-v1"))
    for data in (None, 3, {"unheard": 1}):
        with pytest.raises(ConversionError, match="the format of the data is unknown"):
            brl.import_(data)


# -- drawings of the program -------------------------------------------------------------------


@pytest.mark.parametrize("name", ["final-maze", "glass-wall", "blocked-shapes", "walls"])
def test_a_drawing_is_imported_as_it_is_printed(name: str) -> None:
    level = brl.load(name)
    text = f"Some words.\n\n{level.draw()}\nE  exit: ends the episode, 0\n"
    world = world_of(text, "drawing")
    assert level_of_world(world).draw() == level.draw()
    assert world.lost == ()


def test_what_a_drawing_does_not_explain_is_told() -> None:
    world = world_of(brl.load("first-key").draw().replace("S", "k").replace("E", "S"), "drawing")
    assert "`k`: a plain cell: what it means is not drawn" in map(str, world.lost)
    told = [*map(str, world_of("+---+---+\n| S / E |\n+---+---+\n", "drawing").lost)]
    assert told == ["doors: left out: what they need is not drawn"]
    with pytest.raises(ConversionError, match=r"world\.txt:3:8: error: this line has 7 characters"):
        world_of("\n+---+---+\n| S   E\n+---+---+\n", "drawing")


@pytest.mark.parametrize("text", ["", "\n\n", "  \n"])
def test_a_blank_text_is_refused(text: str) -> None:
    with pytest.raises(ConversionError, match="the text is blank"):
        guess(SourceFile("world", text))


@pytest.mark.parametrize("name", ["maze-dataset", "mazelib", "minigrid"])
def test_texts_of_other_packages_are_recognised(name: str) -> None:
    for text in sample(name).values():
        assert set(guess(SourceFile("world", text))) & {"maze-dataset", "minigrid"}


def test_maps_of_other_packages_are_recognised() -> None:
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


HEAVY = ("walls", "blocked")


@pytest.mark.slow
@pytest.mark.parametrize(
    "text",
    [
        pytest.param(text, marks=[pytest.mark.sweep] if name in HEAVY else [], id=name)
        for name, text in HOSTILE.items()
    ],
)
def test_hostile_texts_are_refused_with_a_message(text: str) -> None:
    for name in FORMATS:
        with pytest.raises(brl.LevelError) as caught:
            file_text(world_of(text, name), schema="s.json", name=None, title="T")
        assert all(c.isprintable() or c == "\n" for c in str(caught.value)), name
        assert len(str(caught.value)) < 2000, name


@each_format
@given(text=st.text(alphabet="#SEX@.$WGFH> \n[]{}()',:01rgc\"=", max_size=60))
def test_any_text_is_a_level_or_an_error(name: str, text: str) -> None:
    try:
        level_of_world(world_of(text, name))
        guess(SourceFile("world", text))
    except brl.LevelError:
        return


def test_errors_can_be_pickled() -> None:
    with pytest.raises(ConversionError) as caught:
        world_of("{'width': 'x'}", "babyrobot")
    again = pickle.loads(pickle.dumps(caught.value))
    assert isinstance(again, brl.LevelError)
    assert str(again) == str(caught.value)
