"""The JSON schemas, generated from the models: the shape that the loader accepts, for editors.

What a schema cannot say, such as a start that lies on a blocked cell, only the loader checks.
"""

import ast
import inspect
import json
import os
from collections import ChainMap
from collections.abc import Iterable, Iterator
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from babyrobot_levels.language.fields import DRAWN, LevelFields, fields_with
from babyrobot_levels.language.kinds import LEGEND
from babyrobot_levels.language.looks import FORM_PATTERN, NAMES, Theme
from babyrobot_levels.language.play import PlayFields
from babyrobot_levels.language.suite import SuiteFields
from babyrobot_levels.language.suite_list import KINDS, PackFields, SuiteListFields
from babyrobot_levels.language.things import LegendEntry
from babyrobot_levels.text.files import write_new
from babyrobot_levels.text.words import check_choice

# Draft 7 is what the editors know best.
DIALECT = "http://json-schema.org/draft-07/schema#"

_BOUNDS = {"ge": "minimum", "gt": "exclusiveMinimum", "le": "maximum", "lt": "exclusiveMaximum"}


def level_schema() -> dict[str, Any]:
    """Return the JSON schema of level files."""
    schema = _schema(LevelFields, "A level, version 1")
    schema["properties"]["exit"]["default"] = "the bottom-right cell"
    schema["dependencies"] = {
        "legend": {"required": ["map"], "properties": {"map": {"type": "string"}}},
        "map": {
            "if": {"properties": {"map": {"type": "string"}}},
            "then": {"not": {"anyOf": [{"required": [field]} for field in fields_with(DRAWN)]}},
        },
        "exit_one_of": {
            "if": {"properties": {"exit_one_of": {"type": "array"}}},
            "then": {"not": {"required": ["exit"]}},
        },
    }
    definitions = schema["$defs"]
    definitions["Item"]["oneOf"] = [_given("at", ["one_of"]), _given("one_of", ["at"])]
    within = _given("within", ["path"])
    within["properties"]["back"] = {"const": False}
    definitions["Mover"]["oneOf"] = [_given("path", ["within", "start"]), within]
    definitions["LegendEntry"]["oneOf"] = [*_legend_entries()]
    return schema


def _legend_entries() -> Iterator[dict[str, Any]]:
    """Yield the schema of an entry of the legend for each kind that it may stand for."""
    for kind in sorted(LEGEND, key=lambda kind: kind.has_name):
        others = [name for name in LegendEntry.model_fields if name not in kind.legend]
        yield _given(kind.name, others) if kind.has_name else _without(others)


def _given(name: str, without: Iterable[str]) -> dict[str, Any]:
    """Return the schema of a mapping that has a field, and some others not."""
    others = _without(without)["properties"]
    return {"required": [name], "properties": {name: {"not": {"type": "null"}}, **others}}


def _without(names: Iterable[str]) -> dict[str, Any]:
    """Return the schema of a mapping without some fields; null means the same as leaving out."""
    return {"properties": {name: {"type": "null"} for name in names}}


def theme_schema() -> dict[str, Any]:
    """Return the JSON schema of theme files."""
    return _schema(Theme, "A theme")


def suite_schema() -> dict[str, Any]:
    """Return the JSON schema of suite files: those with `levels`, and those that grow mazes."""
    grown = _schema(SuiteFields, "A suite of levels, version 1")
    listed = _schema(SuiteListFields, "")
    entry = listed["$defs"]["SuiteEntry"]
    entry["oneOf"] = [_given(kind, [name for name in KINDS if name != kind]) for kind in KINDS]
    entry["dependencies"] = {name: ["suite"] for name in ("split", "count")}
    definitions = {**grown.pop("$defs"), **listed.pop("$defs")}
    heads = {name: grown.pop(name) for name in ("$schema", "title")}
    for name in heads:
        del listed[name]
    return {
        **heads,
        "if": {"required": ["levels"]},
        "then": listed,
        "else": grown,
        "$defs": dict(sorted(definitions.items())),
    }


def pack_schema() -> dict[str, Any]:
    """Return the JSON schema of the `pack.yaml` of a pack."""
    return _schema(PackFields, "A pack of levels")


def play_schema() -> dict[str, Any]:
    """Return the JSON schema of a line of a `.brlplay` file."""
    schema = _schema(PlayFields, "A play, a line of a .brlplay file, version 1")
    schema["properties"]["checksum"] = {
        "description": "The CRC-32 of the bytes of the line before this field and its comma.",
        "type": "string",
        "pattern": "^[0-9a-f]{8}$",
    }
    schema["required"] += ["format", "format_version", "checksum"]
    return schema


SCHEMAS = {
    "level": level_schema,
    "pack": pack_schema,
    "play": play_schema,
    "suite": suite_schema,
    "theme": theme_schema,
}
"""The schemas by the name under which the command line knows them."""


def schema(
    name: str = "level", path: str | os.PathLike[str] | None = None, *, force: bool = False
) -> dict[str, Any]:
    """Return a JSON schema, as `babyrobot schema` prints it.

    Args:
        name: of which files: `"level"`, `"pack"`, `"play"`, `"suite"` or `"theme"`.
        path: a file to write it to.
        force: whether to replace an existing file.

    Raises:
        ValueError: there is no such schema.
        FileExistsError: there is a file.
    """
    check_choice("name", name, SCHEMAS)
    if path is not None:
        write_new(Path(path), schema_text(name), force=force)
    return SCHEMAS[name]()


def schema_text(name: str) -> str:
    """Return a schema as the text of a file."""
    return json.dumps(SCHEMAS[name](), indent=2, ensure_ascii=False) + "\n"


def _schema(model: type[BaseModel], title: str) -> dict[str, Any]:
    schema = _tidy(model.model_json_schema(by_alias=True))
    definitions = schema.pop("$defs", {})
    if "#/$defs/Color" in str([schema, definitions]):
        definitions["Color"] = _color()
    for name, described in {model.__name__: schema, **definitions}.items():
        for field, text in _descriptions().get(name, {}).items():
            properties = described["properties"]
            properties[field] = {"description": text, **properties[field]}
    return {
        "$schema": DIALECT,
        "title": title,
        **{key: value for key, value in schema.items() if key != "title"},
        **({"$defs": dict(sorted(definitions.items()))} if definitions else {}),
    }


def _tidy(value: Any) -> Any:
    """Translate bounds into JSON Schema, define colours once, and drop what editors do not use."""
    if isinstance(value, list):
        return [_tidy(item) for item in value]
    if not isinstance(value, dict):
        return value
    if value.get("format") == "color":
        texts = {key: value[key] for key in ("description", "default") if key in value}
        return {"allOf": [{"$ref": "#/$defs/Color"}], **texts}
    tidied = {}
    for key, inner in value.items():
        if key == "title" and isinstance(inner, str):
            continue
        if key == "default" and inner is None:
            continue
        is_bound = key in _BOUNDS and isinstance(inner, int | float)
        tidied[_BOUNDS[key] if is_bound else key] = _tidy(inner)
    if "patternProperties" in tidied:
        tidied["additionalProperties"] = False
    return tidied


@cache
def _descriptions() -> dict[str, dict[str, str]]:
    """Return what the texts below the models' fields say, by model and field.

    Pydantic could collect them, but would read the sources anew at every start.
    """
    models = {
        model.name: model
        for path in sorted(Path(__file__).parent.glob("*.py"))
        for model in ast.parse(path.read_text(encoding="utf-8")).body
        if isinstance(model, ast.ClassDef)
    }

    def described(name: str) -> dict[str, str]:
        model = models.get(name)
        if model is None:
            return {}
        bases = [base.id for base in model.bases if isinstance(base, ast.Name)]
        return {**ChainMap(*map(described, bases)), **_field_texts(model)}

    return {name: described(name) for name in models}


def _field_texts(model: ast.ClassDef) -> dict[str, str]:
    texts = {}
    for field, below in pairwise(model.body):
        if not isinstance(field, ast.AnnAssign) or not isinstance(field.target, ast.Name):
            continue
        if isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant):
            texts[field.target.id.rstrip("_")] = inspect.cleandoc(str(below.value.value))
    return texts


def _color() -> dict[str, Any]:
    # The names as an enum, so that editors complete them.
    return {
        "description": "A CSS colour.",
        "anyOf": [{"enum": list(NAMES)}, {"type": "string", "pattern": FORM_PATTERN}],
    }
