"""The JSON schemas, generated from the models: the shape that the loader accepts, for editors.

What a schema cannot say, such as a start that lies on a blocked cell, only the loader checks.
"""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from babyrobot_levels.spec.color import FORM_PATTERN, NAMES, PATTERN
from babyrobot_levels.spec.level import LevelFields
from babyrobot_levels.spec.looks import Theme
from babyrobot_levels.spec.map import DRAWN_FIELDS

# Draft 7 is what the editors know best.
DIALECT = "http://json-schema.org/draft-07/schema#"

_BOUNDS = {
    "ge": "minimum",
    "gt": "exclusiveMinimum",
    "le": "maximum",
    "lt": "exclusiveMaximum",
}


def level_schema() -> dict[str, Any]:
    """Return the JSON schema of level files."""
    schema = _schema(LevelFields, "A level, version 1")
    schema["properties"]["exit"]["default"] = "the bottom-right cell"
    schema["dependencies"] = {
        "legend": {"required": ["map"], "properties": {"map": {"type": "string"}}},
        "map": {
            "if": {"properties": {"map": {"type": "string"}}},
            "then": {"not": {"anyOf": [{"required": [field]} for field in DRAWN_FIELDS]}},
        },
    }
    return schema


def theme_schema() -> dict[str, Any]:
    """Return the JSON schema of theme files."""
    return _schema(Theme, "A theme")


SCHEMAS = {"level": level_schema, "theme": theme_schema}
"""The schemas by the name under which the command line knows them."""


def _schema(model: type[BaseModel], title: str) -> dict[str, Any]:
    schema = _tidy(model.model_json_schema(by_alias=True))
    definitions = {**schema.pop("$defs", {}), "Color": _color()}
    return {
        "$schema": DIALECT,
        "title": title,
        **{key: value for key, value in schema.items() if key != "title"},
        "$defs": dict(sorted(definitions.items())),
    }


def _tidy(value: Any) -> Any:
    """Say bounds in JSON Schema's words, colours once, and leave out what helps nobody."""
    if isinstance(value, list):
        return [_tidy(item) for item in value]
    if not isinstance(value, dict):
        return value
    if value.get("pattern") == PATTERN:
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


def _color() -> dict[str, Any]:
    # The names as an enum, so that editors complete them.
    return {
        "description": "A CSS colour.",
        "anyOf": [{"enum": list(NAMES)}, {"type": "string", "pattern": FORM_PATTERN}],
    }
