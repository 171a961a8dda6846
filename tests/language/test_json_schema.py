"""The JSON schemas: they are what the code generates, and accept what the loader accepts."""

from __future__ import annotations

import copy
import subprocess
import sys
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn
from pydantic import BaseModel
from support.places import ROOT
from support.sessions import environment, run_here
from support.things import thing_worlds
from support.worlds import decorated_worlds

from babyrobot_levels.language.fields import LevelFields, Role
from babyrobot_levels.language.json_schema import level_schema, schema_text, theme_schema
from babyrobot_levels.language.level import LevelSpec
from babyrobot_levels.language.looks import BUILTIN_THEMES, Theme
from babyrobot_levels.language.validation import validate
from babyrobot_levels.library.search_path import gallery_folder, yaml_files
from babyrobot_levels.text.files import read_source
from babyrobot_levels.text.reader import read

SCHEMAS = ROOT / "schemas"
LEVEL = jsonschema.Draft7Validator(level_schema())
THEME = jsonschema.Draft7Validator(theme_schema())
GALLERY = sorted(path for path in yaml_files(gallery_folder()) if path.parent.name != "suites")


@pytest.mark.parametrize("name", ["level", "pack", "suite", "theme"])
def test_the_files_are_up_to_date(name: str) -> None:
    path = SCHEMAS / f"{name}.schema.json"
    assert path.read_text(encoding="utf-8") == schema_text(name), f"babyrobot schema {name}"


@pytest.mark.parametrize("schema", [level_schema(), theme_schema()])
def test_they_are_schemas_of_draft_7(schema: dict[str, Any]) -> None:
    assert schema["$schema"] == "http://json-schema.org/draft-07/schema#"
    jsonschema.Draft7Validator.check_schema(schema)


def keywords(schema: Any) -> set[str]:
    """Return the keywords that a schema uses, those of its definitions and fields included."""
    found: set[str] = set()
    for key, value in schema.items():
        found.add(key)
        if key in ("properties", "$defs", "patternProperties"):
            for inner in value.values():
                found |= keywords(inner)
        elif key in ("anyOf", "allOf", "oneOf"):
            for inner in value:
                found |= keywords(inner)
        elif key in ("items", "not") and isinstance(value, dict):
            found |= keywords(value)
    return found


@pytest.mark.parametrize("schema", [level_schema(), theme_schema()])
def test_they_use_no_keyword_that_draft_7_does_not_know(schema: dict[str, Any]) -> None:
    known = set(jsonschema.Draft7Validator.META_SCHEMA["properties"]) | {"$defs"}
    assert keywords(schema) <= known


def test_every_field_says_what_it_is_for() -> None:
    for schema in (level_schema(), theme_schema()):
        for part in (schema, *schema["$defs"].values()):
            for name, field in part.get("properties", {}).items():
                # A field whose text would be that of its type leaves it to the type.
                target = schema["$defs"].get(field.get("$ref", "").removeprefix("#/$defs/"), {})
                told = field.get("description") or target.get("description", "")
                assert told.endswith("."), name


@pytest.mark.parametrize("path", GALLERY, ids=lambda path: path.stem)
def test_the_gallery_is_accepted(path: Path) -> None:
    LEVEL.validate(read(read_source(path)).data)


@pytest.mark.parametrize("name", BUILTIN_THEMES)
def test_the_themes_are_accepted(name: str) -> None:
    THEME.validate(BUILTIN_THEMES[name].model_dump())
    LEVEL.validate({"version": 1, "theme": name})


def shape_faults(data: dict[str, Any], model: type[BaseModel]) -> list[str]:
    """Return what the loader says against the shape of the data, and not against its meaning."""
    _, problems = validate(data, model)
    return [
        f"{problem.code} {problem.location}: {problem.message}"
        for problem in problems
        if problem.code.startswith("BR2") or problem.code in ("BR401", "BR403")
    ]


def assert_agreed(data: dict[str, Any]) -> None:
    """Check that the schema accepts exactly the shape that the loader accepts."""
    against = shape_faults(data, LevelSpec)
    errors = [f"{list(error.path)}: {error.message}" for error in LEVEL.iter_errors(data)]
    assert bool(against) == bool(errors), f"\n{data}\nloader: {against}\nschema: {errors}"


JUNK = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-2, 4),
    st.sampled_from([0.0, 1.0, 3.0, 0.5, -1.0, 1.5, 1023, 1024, 1024.0, 1025, 10**20, 2**53 + 1]),
    st.sampled_from(
        [
            *("", "none", "random", "start", "N", "n", "north", "small", "open", "enter"),
            *("depth-first", "red", "Red", "#abc", "#abcd1", "rgb(1,2,3)", "rgb(1,2,300)"),
            *("rgba(1, 2, 3, .5)", "hsl(361, 1%, 1%)", "hsl(360, 100%, 0%)", "default"),
            *("a-b", "a_b", "a--b", "A", "1", "o", "x" * 100, "x" * 101),
        ]
    ),
    st.lists(st.integers(0, 3), max_size=3),
    st.lists(st.lists(st.integers(0, 3), min_size=1, max_size=3), max_size=2),
    st.just({}),
    st.sampled_from(
        [
            {"probability": 0.5},
            {"probability": 2},
            {"width": 20},
            {"seed": "random"},
            {"at": [0, 0]},
            {"at": [0, 0], "side": "E"},
            {"at": [0, 0], "to": "start"},
            {"colors": {}},
            {"x": {"reward": 1}},
            {"small": {"skid": 0.1}},
            {"name": "key", "at": [0, 0]},
            {"item": "key"},
            {"path": [[1, 1]]},
        ]
    ),
).map(copy.deepcopy)
"""Values of all shapes, some of which fit somewhere; copies, because they are bent afterwards."""

FIELDS = st.sampled_from(
    [
        *LevelFields.model_fields,
        *("at", "side", "length", "pass", "color", "width", "fit", "reward", "ends", "label"),
        *("colors", "widths", "probability", "to", "loops", "seed", "small", "large", "show"),
        *("speed", "text_color", "nonsense", "pass_", "form:cell"),
        *("name", "one_of", "shape", "once", "on", "path", "back", "within", "needs", "unless"),
    ]
)


@st.composite
def bent(draw: DrawFn, worlds: st.SearchStrategy[dict[str, Any]]) -> dict[str, Any]:
    """Random levels in which a few places hold something else, or more, or nothing."""
    data = copy.deepcopy(draw(worlds))
    for _ in range(draw(st.integers(1, 3))):
        here: Any = data
        for _ in range(draw(st.integers(0, 4))):
            inner = list(here.values()) if isinstance(here, dict) else here
            deeper = [value for value in inner if isinstance(value, dict | list)]
            if not deeper:
                break
            here = draw(st.sampled_from(deeper))
        _bend(draw, here)
    return data


def _bend(draw: DrawFn, here: Any) -> None:
    keys = list(here) if isinstance(here, dict) else list(range(len(here)))
    how = draw(st.sampled_from(["replace", "remove", "add", "whole float", "negate"]))
    if how == "add" or not keys:
        if isinstance(here, dict):
            here[draw(FIELDS)] = draw(JUNK)
        else:
            here.append(draw(JUNK))
        return
    key = draw(st.sampled_from(keys))
    value = here[key]
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if how == "remove":
        del here[key]
    elif how == "whole float" and is_number:
        here[key] = float(value)
    elif how == "negate" and is_number:
        here[key] = -value
    else:
        here[key] = draw(JUNK)


@given(decorated_worlds() | thing_worlds())
def test_good_levels_are_accepted(world: dict[str, Any]) -> None:
    assert shape_faults(world, LevelSpec) == []
    LEVEL.validate(world)


@given(bent(decorated_worlds() | thing_worlds()))
def test_the_schema_accepts_the_shapes_that_the_loader_accepts(data: dict[str, Any]) -> None:
    assert_agreed(data)


@given(st.dictionaries(FIELDS, JUNK, max_size=3))
def test_they_agree_on_single_fields_of_all_shapes(fields: dict[str, Any]) -> None:
    assert_agreed({"version": 1, **fields})


DRAWN = "+---+---+\n| S   E |\n+---+---+\n"


MOVERS: list[dict[str, Any]] = [
    {},
    {"path": [[1, 1]]},
    {"path": []},
    {"path": [[1, 1]], "start": None, "within": None},
    {"path": [[1, 1]], "start": [1, 1]},
    {"path": [[1, 1]], "within": {"at": [1, 1]}},
    {"within": {"at": [1, 1]}, "start": [1, 1], "path": None},
    {"within": {"at": [1, 1]}, "back": False},
    {"within": {"at": [1, 1]}, "back": True},
]
"""Movers, valid ones and others."""


@pytest.mark.parametrize(
    "fields",
    [
        {"map": DRAWN},
        {"map": DRAWN, "legend": {"x": {"reward": 1}}},
        {"map": DRAWN, "legend": {}},
        {"map": DRAWN, "legend": {"S": {}}},
        {"map": DRAWN, "legend": {"xx": {}}},
        {"map": DRAWN, "legend": {"": {}}},
        {"map": DRAWN, "legend": {"x": None}},
        {"map": DRAWN, "legend": {"x": {"at": [0, 0]}}},
        {"map": DRAWN, "walls": []},
        {"map": DRAWN, "areas": [{"at": [0, 0]}]},
        {"map": DRAWN, "maze": {"seed": 1}},
        *({"map": DRAWN, field: []} for field in ("puddles", "blocked")),
        {"map": DRAWN, "size": [2, 1]},
        {"map": DRAWN, "start": [0, 0]},
        {"map": DRAWN, "exit": "none"},
        {"legend": {}},
        {"legend": {"x": {}}},
        {"map": 3},
        {"version": 1.0},
        {"version": True},
        {"version": 2},
        {"size": [1024, 1024]},
        {"size": [1025, 1]},
        {"start": [1023, 0]},
        {"start": [1024, 0]},
        {"start": [-1, 0]},
        {"openings": [{"at": [0, 0], "side": "south", "length": 1024}]},
        {"openings": [{"at": [0, 0], "side": "S", "length": 1025}]},
        {"start": []},
        {"start": [[0, 0], 1]},
        {"exit": "None"},
        {"tags": ["a", "a"]},
        {"wind": {"north": [0.0, 1.0, 2.0]}},
        {"max_steps": 0},
        {"discount": 0},
        {"exit_one_of": [[0, 1], [1, 1]]},
        {"exit_one_of": [[0, 1], [1, 1]], "exit": [2, 2]},
        {"exit_one_of": [[0, 1], [1, 1]], "exit": "none"},
        {"exit_one_of": [[0, 1]]},
        {"exit_needs": []},
        {"heading": "south"},
        {"hit": {"reward": 1, "ends": False}},
        {"hit": {"ends": None}},
        *(
            {"items": [{"name": "key", **place}]}
            for place in (
                {},
                {"at": [1, 1]},
                {"at": None},
                {"one_of": [[1, 1], [0, 1]]},
                {"one_of": [[1, 1]]},
                {"one_of": [[1, 1], [0, 1]], "at": None},
                {"one_of": [[1, 1], [0, 1]], "at": [1, 2]},
                {"one_of": None, "at": [1, 2], "shape": "gem"},
                {"at": [1, 2], "shape": "rock"},
            )
        ),
        {"items": [{"at": [1, 1]}]},
        {"doors": [{"at": [1, 1], "side": "E", "needs": [], "width": 100}]},
        {"doors": [{"at": [1, 1], "side": "E", "width": 101}]},
        {"switches": [{"name": "lever", "at": [1, 1], "once": True, "on": False}]},
        {"switches": [{"name": "lever"}]},
        *({"movers": [mover]} for mover in MOVERS),
        *(
            {"map": DRAWN, "legend": {"x": entry}}
            for entry in (
                {"item": "key"},
                {"item": "key", "reward": 1, "shape": "key", "color": "red", "label": ""},
                {"item": "key", "skid": 0.5},
                {"item": "key", "ends": False},
                {"item": "key", "once": False},
                {"item": "key", "switch": "lever"},
                {"item": None, "reward": 1},
                {"switch": "lever", "once": True, "on": True, "color": "red", "label": ""},
                {"switch": "lever", "reward": 1},
                {"switch": "lever", "shape": "key"},
                {"reward": 1, "shape": "key"},
                {"on": True},
            )
        ),
    ],
    ids=str,
)
def test_they_agree_on_corners(fields: dict[str, Any]) -> None:
    assert_agreed({"version": 1, **fields})


@pytest.mark.parametrize("fields", [{"map": None}, {"map": None, "size": [2, 2]}], ids=str)
def test_they_agree_on_a_drawing_that_is_not_there(fields: dict[str, Any]) -> None:
    assert_agreed({"version": 1, **fields})
    assert shape_faults({"version": 1, **fields}, LevelSpec) == []


@given(
    st.fixed_dictionaries(
        {},
        optional={
            "colors": st.dictionaries(st.sampled_from(["base", "walls", "no"]), JUNK, max_size=2)
            | JUNK,
            "widths": st.dictionaries(st.sampled_from(["padding", "walls", "no"]), JUNK, max_size=2)
            | JUNK,
            "nonsense": st.nothing(),
        },
    )
)
def test_they_agree_on_themes(data: dict[str, Any]) -> None:
    against = shape_faults(data, Theme)
    assert bool(against) == (not THEME.is_valid(data)), f"{data}\n{against}"


@pytest.mark.sweep
def test_other_checkers_accept_a_new_level(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = run_here(["new-level", "mine", "--puddles", "2"], environment(tmp_path))
    assert result.status == 0
    path = tmp_path / "levels" / "mine.yaml"
    schema = str(SCHEMAS / "level.schema.json")

    def checked() -> int:
        return subprocess.run(
            [sys.executable, "-m", "check_jsonschema", "--schemafile", schema, str(path)],
            capture_output=True,
            timeout=60,
            check=False,
        ).returncode

    assert checked() == 0
    path.write_text(path.read_text(encoding="utf-8") + "colour: red\n", encoding="utf-8")
    assert checked() == 1


def test_every_field_has_one_role() -> None:
    for name, info in LevelFields.model_fields.items():
        assert sum(isinstance(mark, Role) for mark in info.metadata) == 1, name
