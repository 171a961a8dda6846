"""Levels as users hold them: written, changed, saved, copied, and never altered."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from pydantic import BaseModel, ValidationError
from support.reports import GOOD
from support.worlds import (
    AWKWARD,
    LEGEND,
    World,
    decorated_worlds,
    drawings,
    level_of,
    level_of_text,
    texts,
)

import babyrobot_levels as brl
from babyrobot_levels.language import drawing as d
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.emitter import emit
from babyrobot_levels.text.errors import LevelError, LevelNotFoundError
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile

# -- as text -----------------------------------------------------------------------------------


@given(decorated_worlds())
@settings(max_examples=settings().max_examples // 2)
def test_yaml_and_back(world: World) -> None:
    level = level_of(world)
    text = level.to_yaml()
    again = level_of_text(text)
    assert again.to_dict() == level.to_dict()
    assert again.digest == level.digest
    assert again.to_yaml() == text


@given(drawings(5))
def test_drawn_levels_to_yaml_and_back(drawing: d.Drawing) -> None:
    text = d.compose(drawing)
    level = level_of({"version": 1, "map": text, "legend": LEGEND, "areas": [{"at": [0, 0]}]})
    again = level_of_text(level.to_yaml())
    assert again.to_dict() == level.to_dict()
    assert again.to_dict()["map"] == text
    assert "walls" not in again.to_dict()
    assert again.digest == level.digest
    assert "map: |\n" in level.to_yaml(), "a drawing is written so that one can see it"


@pytest.mark.parametrize("text", AWKWARD, ids=repr)
def test_awkward_texts_survive(text: str) -> None:
    world = {"version": 1, "title": text, "areas": [{"at": [0, 0], "label": text}]}
    level = level_of_text(level_of(world).to_yaml())
    assert level.title == text
    assert level.areas[0].label == text


trees = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**30), 10**30) | st.floats(allow_nan=False) | texts,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(texts, inner, max_size=4),
    max_leaves=20,
)
wrappings = st.sampled_from(["in a list", "before one", "behind one", "in a mapping", "below one"])


def wrapped(value: Any, ways: list[str]) -> Any:
    """Return a value with others around it, of which one is empty at times."""
    for way in ways:
        value = {
            "in a list": [value],
            "before one": [value, {}],
            "behind one": [1, value],
            "in a mapping": {"key": value},
            "below one": {"key": [], "other": value},
        }[way]
    return value


@given(trees, st.integers(0, 50).flatmap(lambda n: st.lists(wrappings, min_size=n, max_size=n)))
@example([], ["in a list"] * 45)
@example({}, ["in a list"] * 45)
@example([], ["in a mapping"] * 45)
@example(float("inf"), [])
def test_what_is_emitted_reads_back_however_deep_it_is(tree: Any, ways: list[str]) -> None:
    data = {"walls": wrapped(tree, ways)}
    document = read(SourceFile("x.yaml", emit(data)))
    assert document.data == data
    assert not document.issues


def test_fields_are_written_in_their_order_and_only_those_that_were_given() -> None:
    text = "size: [4, 2]\nexit: none\nversion: 1\nname: x\n"
    assert level_of_text(text).to_yaml() == "version: 1\nname: x\nsize: [4, 2]\nexit: none\n"
    assert level_of_text("version: 1\n").to_dict() == {"version": 1}


def test_canonical_yaml_is_easy_to_read() -> None:
    world = {
        "version": 1,
        "title": "A level: with walls",
        "description": "Two\nlines\n",
        "walls": [{"at": [0, 0], "side": "north", "length": 2}, {"at": [1, 1], "side": "E"}],
        "skid": {"probability": 0.5, "to": "sides"},
        "theme": {"colors": {"base": "#aabbcc"}},
    }
    assert (
        level_of(world).to_yaml()
        == """\
version: 1
title: "A level: with walls"
description: |
  Two
  lines
walls:
  - {at: [0, 0], side: N, length: 2}
  - {at: [1, 1], side: E}
skid: {probability: 0.5, to: sides}
theme:
  colors: {base: "#aabbcc"}
"""
    )


# -- other levels ------------------------------------------------------------------------------


def test_replace_gives_another_level() -> None:
    level = level_of({"version": 1, "size": [4, 4], "title": "x"})
    other = level.replace(size=(5, 3), title=None, skid={"probability": 0.5})
    assert (other.size, other.title, other.exit) == ((5, 3), None, (4, 2))
    assert (level.size, level.title, level.exit) == ((4, 4), "x", (3, 3))
    assert other.digest != level.digest
    assert other.replace(skid=None, size=[4, 4]).digest == level.digest


def test_replace_of_a_drawing_forgets_what_it_said() -> None:
    level = level_of({"version": 1, "map": "+---+---+\n| S | E |\n+---+---+\n"})
    other = level.replace(map=None)
    assert (other.size, other.walls, other.exit) == ((3, 3), (), (2, 2))
    wider = level.replace(map="+---+---+---+\n| S   o   E |\n+---+---+---+\n")
    assert (wider.size, wider.walls, len(wider.puddles)) == ((3, 1), (), 1)


@pytest.mark.parametrize(
    "fields", [{"size": (0, 3)}, {"start": (2, 2)}, {"sise": 3}, {"map": "x"}, {"version": 2}]
)
def test_replace_refuses_what_is_not_valid(fields: dict[str, Any]) -> None:
    with pytest.raises(LevelError):
        level_of({"version": 1}).replace(**fields)


def test_random_mazes_need_a_seed() -> None:
    level = level_of({"version": 1, "size": [6, 6], "maze": {"seed": "random", "loops": 0.5}})
    assert level.has_random_maze
    for use in (level.grid, level.compile, level.draw, lambda: level.digest):
        with pytest.raises(LevelError, match="with_maze_seed"):
            use()
    grown = level.with_maze_seed(7)
    assert not grown.has_random_maze
    assert level.has_random_maze
    written = {"seed": 7, "loops": 0.5}
    assert grown.to_dict()["maze"] == written
    assert grown.digest == level_of({"version": 1, "size": [6, 6], "maze": written}).digest
    assert grown.with_maze_seed(8).digest != grown.digest


def test_a_level_that_was_compiled_can_have_another_seed() -> None:
    level = level_of({"version": 1, "size": [6, 6], "maze": {"seed": 1}})
    tables, digest = level.compile(), level.digest
    assert level.with_maze_seed(2).digest != digest
    assert level.with_maze_seed(2).compile() is not tables
    assert level.compile() is tables
    assert level.with_maze_seed(1).digest == digest


def test_only_a_maze_has_a_seed() -> None:
    with pytest.raises(LevelError, match="no maze"):
        level_of({"version": 1}).with_maze_seed(1)


@pytest.mark.parametrize("seed", [1.5, "x", None, True])
def test_a_seed_is_a_whole_number(seed: Any) -> None:
    with pytest.raises(LevelError):
        level_of({"version": 1, "maze": {"seed": 1}}).with_maze_seed(seed)


def test_mappings_tell_what_is_wrong_with_them() -> None:
    with pytest.raises(LevelError) as caught:
        Level.from_fields({"version": 1, "walls": [{"at": [0, 0]}, {"at": [9, 9], "side": "E"}]})
    first, second = caught.value.diagnostics
    assert (first.code, first.message) == ("BR202", "missing field `side`")
    assert second.message.startswith("the cell [9, 9] is off the grid")
    # They name the field, and point into it as a file would hold it.
    assert str(first).splitlines() == [
        "walls[0]: error BR202: missing field `side`",
        "   |",
        "   |   - {at: [0, 0]}",
        "   |     ^^^^^^^^^^^^",
        "  help: add `side: N`",
    ]
    assert str(second).startswith("walls[1].at: error BR301: the cell [9, 9] is off the grid")
    assert "- {at: [9, 9], side: E}" in str(second)


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda: Level.from_fields({"size": [3, 3]}), "error BR202: missing field `version`"),
        (lambda: Level.from_fields({"version": 1, "map": "x"}), "map: error BR312: "),
        (lambda: brl.load("first-key").replace(sizes=1), "sizes: error BR201: unknown field"),
        (lambda: brl.load_suite({"version": 1, "kind": "suite", "count": "x"}), "count: error "),
        (lambda: brl.load({"version": 1, "discount": 10**400}), "discount: error BR111"),
    ],
)
def test_what_is_made_of_arguments_has_no_lines(call: Callable[[], object], told: str) -> None:
    with pytest.raises(LevelError) as caught:
        call()
    assert any(line.startswith(told) for line in str(caught.value).splitlines())
    assert "<" not in str(caught.value)


# -- frozen, copied, pickled -------------------------------------------------------------------


def test_levels_are_frozen() -> None:
    level = level_of(
        {"version": 1, "walls": [{"at": [0, 0], "side": "E"}], "maze": {"seed": 1}, "theme": {}}
    )
    for thing, name in [
        (level, "size"),
        (level, "title"),
        (level.walls[0], "at"),
        (level.maze, "seed"),
        (level.rewards, "step"),
        (level.theme, "colors"),
        (level.display.robot, "speed"),
    ]:
        with pytest.raises(AttributeError, match="levels do not change"):
            setattr(thing, name, 1)
        with pytest.raises(ValidationError, match="frozen"):
            delattr(thing, name)
    assert isinstance(level.walls, tuple)


@pytest.mark.slow
@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.stem)
def test_levels_can_be_pickled_and_copied(path: Path) -> None:
    level = brl.loads(path.read_text(encoding="utf-8"))
    if not level.has_random_maze:
        level.compile()
    for other in (
        pickle.loads(pickle.dumps(level)),
        copy.copy(level),
        copy.deepcopy(level),
        level.model_copy(),
    ):
        assert isinstance(other, Level)
        assert other == level
        assert other.to_dict() == level.to_dict()
        if not level.has_random_maze:
            assert other.digest == level.digest


def test_what_is_compiled_is_not_pickled() -> None:
    level = brl.load("first-key")
    before = len(pickle.dumps(level))
    level.compile()
    assert len(pickle.dumps(level)) == before


def test_errors_can_be_pickled() -> None:
    with pytest.raises(LevelError) as caught:
        brl.loads("version: 1\nsize: 3\n")
    error = pickle.loads(pickle.dumps(caught.value))
    assert isinstance(error, LevelError)
    assert error.diagnostics == caught.value.diagnostics
    assert str(error) == str(caught.value)
    assert "1 error\n" in str(error)
    missing = pickle.loads(pickle.dumps(LevelNotFoundError("maz", ["maze"])))
    assert (missing.name, missing.nearest) == ("maz", ("maze",))
    assert "did you mean 'maze'?" in str(missing)


# -- saved -------------------------------------------------------------------------------------

FILE = """\
# My level, with remarks.

version: 1   # the language

title:   'A  title'  # kept
size: [4,4]    # small
walls:   # some of them
  # the first
  - at: [0, 0]
    side: E      # east
  - {at: [1, 1],   side: S}

# Puddles are wet.
puddles:
- at: [2, 2]
  # a comment inside

rewards: {step: -1}
# The end.
"""


def saved(level: Level, folder: Path) -> str:
    path = folder / "level.yaml"
    level.save(path)
    return path.read_text(encoding="utf-8")


def test_what_was_not_changed_is_saved_as_it_was(tmp_path: Path) -> None:
    assert saved(brl.loads(FILE), tmp_path) == FILE


def test_carriage_returns_are_kept(tmp_path: Path) -> None:
    text = FILE.replace("\n", "\r\n")
    path = tmp_path / "level.yaml"
    brl.loads(text).save(path)
    assert path.read_bytes().decode() == text
    brl.loads(text).replace(size=[5, 5]).save(path)
    assert path.read_bytes().decode() == text.replace("[4,4]", "[5, 5]")


def test_a_file_without_a_last_line_end_can_be_added_to(tmp_path: Path) -> None:
    level = brl.loads("version: 1\nsize: [4, 4]").replace(discount=0.5)
    assert brl.loads(saved(level, tmp_path)).to_dict() == level.to_dict()


def test_a_level_in_flow_style_is_saved_whole(tmp_path: Path) -> None:
    level = brl.loads("{version: 1, size: [4, 4]} # comment\n")
    assert saved(level, tmp_path) == "{version: 1, size: [4, 4]} # comment\n"
    assert saved(level.replace(size=[5, 5]), tmp_path) == "version: 1\nsize: [5, 5]\n"


def test_a_level_without_a_text_is_saved_as_canonical_yaml(tmp_path: Path) -> None:
    level = level_of({"version": 1, "size": [4, 4]})
    assert saved(level, tmp_path) == level.to_yaml()


# -- as a value ------------------------------------------------------------------------------


def test_levels_are_keys_of_dictionaries() -> None:
    names = {brl.load(name): name for name in ("garden", "maze", "random-maze", "four-corners")}
    assert [names[brl.load(name)] for name in ("maze", "garden")] == ["maze", "garden"]
    assert len({brl.load("maze"), brl.load("maze"), brl.loads("version: 1\n")}) == 2


def test_in_a_line() -> None:
    assert (
        repr(brl.load("final-maze")) == str(brl.load("final-maze")) == "<Level 'final-maze': 8x5>"
    )
    assert repr(brl.loads("version: 1\n")) == "<Level: 3x3>"


def test_a_text_is_a_text() -> None:
    with pytest.raises(TypeError, match="text must be a text, not b'version: 1'"):
        brl.loads(b"version: 1")  # type: ignore[arg-type]


# -- what one guesses ------------------------------------------------------------------------


def test_what_one_guesses_is_there() -> None:
    level = brl.load("frozen-lake")
    assert (level.width, level.height) == level.size
    assert level.solve().expected_return == brl.solve(level).expected_return
    assert level.solve(0.9, actions="moves").discount == 0.9
    assert (
        brl.make(level, observation="index").observation_space
        == level.make(observation="index").observation_space
    )


def test_completion_shows_the_level_and_nothing_of_pydantic() -> None:
    level = brl.load("frozen-lake")
    shown = {name for name in dir(level) if not name.startswith("_")}
    assert not {name for name in shown if name in dir(BaseModel)}
    assert not {name for name in shown if name.startswith("model_")}
    assert {*type(level).model_fields} <= shown
    own = {"solve", "show", "play", "preview", "make", "save", "width", "digest", "to_svg", "draw"}
    assert own <= shown


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"size": (4, 4)}, "missing field `version`"),
        ({"version": 1, "siz": (4, 4)}, "unknown field `siz`; did you mean `size`"),
        ({"version": 1, "size": (4, 4), "start": (9, 9)}, r"the start \[9, 9\] is off the grid"),
    ],
)
def test_wrong_fields_are_told_as_of_a_file(fields: dict[str, Any], message: str) -> None:
    with pytest.raises(brl.LevelError, match=message) as caught:
        brl.Level(**fields)
    assert caught.value.diagnostics
    assert caught.value.__context__ is None
    with pytest.raises(ValidationError):
        brl.Level.model_validate(fields)


def test_numpy_has_numbers_too() -> None:
    import numpy as np

    assert brl.Level(version=1, size=np.array([3, 4])).size == (3, 4)
