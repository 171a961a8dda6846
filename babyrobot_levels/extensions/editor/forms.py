"""The fields that an inspector shows of a place or of the level, from the JSON schema of levels.

A field is a mapping that JSON can hold:

- `route`: where it stands, from its entry or from the level, such as `["skid", "probability"]`;
- `name`: the same as a text, `skid.probability`;
- `type`: number, integer, text, choice, flag, color, cell, size (`[width, height]`), names (of
  things: one, or a list) or texts (a list);
- `description`: what it means;
- `choices`: of a choice, the values; of a text, known ones; of others, words that may stand in
  their place;
- `minimum`, `maximum`: of a number, or of a cell's or a size's numbers;
- `default`: what it is where it is left out;
- `required`: true if it cannot be left out;
- `short`: true if it is the field that stands for its mapping where the file writes that in short;
- `with`: the field that an entry must have so that this one makes sense: a guard has a `path`, and
  `back` only with it;
- `group`: of the level's own fields, what they are for (`language.fields.Role`).

What has no value, such as `minimum` of a text, is left out. Lists of cells are drawn, and are no
fields here.
"""

from collections.abc import Iterator
from functools import cache
from typing import Any

from babyrobot_levels.language.base import SIDE_NAMES
from babyrobot_levels.language.fields import LevelFields, Role, fields_with
from babyrobot_levels.language.json_schema import level_schema
from babyrobot_levels.language.kinds import KINDS, LISTED
from babyrobot_levels.language.looks import BUILTIN_THEMES

LEVEL = "level"
"""The kind of the level's own fields, beside the kinds of places."""

_NOT_SHOWN = frozenset({"map", "legend", *fields_with(Role.EXPECTATION)}).union(
    *(kind.fields for kind in KINDS if kind.where != "line")
)

Form = list[dict[str, Any]]
Schema = dict[str, Any]


@cache
def forms() -> dict[str, Form]:
    """Return the fields of each kind of place, and of the level."""
    schema = _schema()
    entries = {kind.name: _resolved(schema["properties"][kind.field]["items"]) for kind in LISTED}
    groups = {
        name: role.name.lower()
        for name, info in LevelFields.model_fields.items()
        for role in info.metadata
        if isinstance(role, Role)
    }
    own = {**schema, "properties": own_fields(schema["properties"])}
    level = [{**each, "group": groups[each["route"][0]]} for each in _form(own)]
    for each in level:
        if each["name"] == "theme":
            each["choices"] = [*BUILTIN_THEMES]
    return {
        "start": [],
        "exit": [],
        **{name: list(_form(inner)) for name, inner in entries.items()},
        LEVEL: level,
    }


def own_fields(data: dict[str, Any]) -> dict[str, Any]:
    """Return the fields of the level itself, without what stands in cells or at sides.

    What the level states of itself is seen in the text, with what is true beside it.
    """
    return {name: value for name, value in data.items() if name not in _NOT_SHOWN}


def expanded(data: Any) -> Any:
    """Return an entry, or fields of a level, with mappings where a short form stands for one.

    `skid: 0.4`, for example, stands for `skid: {probability: 0.4}`.
    """
    if not isinstance(data, dict):
        return data
    short = short_forms()
    return {
        name: {short[name]: value}
        if name in short and not isinstance(value, dict)
        else expanded(value)
        for name, value in data.items()
    }


@cache
def short_forms() -> dict[str, str]:
    """Return the fields that can be written in short, with the field that then stands for all."""
    fields = [each["route"] for form in forms().values() for each in form if "short" in each]
    return {route[-2]: route[-1] for route in fields}


@cache
def _schema() -> Schema:
    return level_schema()


def _form(model: Schema, route: tuple[str, ...] = ()) -> Iterator[dict[str, Any]]:
    """Yield the fields of a model, those of its mappings included."""
    required, owners = model.get("required", ()), _owners(model)
    for name, schema in model["properties"].items():
        for each in _fields((*route, name), schema):
            is_own = each["name"] == ".".join((*route, name))
            if is_own and (name in required or owners.get(name) == name):
                each["required"] = True
            if name in owners:
                each["with"] = owners[name]
            yield each


def _fields(route: tuple[str, ...], schema: Schema) -> Iterator[dict[str, Any]]:
    """Yield the field that a schema describes: several for a mapping."""
    variants = [*_variants(schema)]
    models = [each for each in variants if "properties" in each]
    simple = [each for each in variants if "properties" not in each]
    inner = [field for model in models for field in _form(model, route)]
    given = {key: schema[key] for key in ("default",) if key in schema}
    if models and simple and inner and len(inner[0]["route"]) == len(route) + 1:
        # The mapping in short: its first field. Words may stand for it too.
        words = [each["const"] for each in simple if "const" in each]
        choices = {"choices": words} if words else {}
        inner[0] = {**inner[0], **choices, **given, "short": True}
        # Without it, there is no mapping.
        inner[0].pop("required", None)
    elif kind := _type(simple):
        about = {"route": [*route], "name": ".".join(route), "description": schema["description"]}
        yield {**about, **kind, **given}
    yield from inner


def _variants(schema: Schema) -> Iterator[Schema]:
    """Yield the forms in which a value can be given, null left out."""
    if schema.get("$ref", "").endswith("/Color"):
        yield {"type": "color"}
    elif "$ref" in schema:
        yield from _variants(_resolved(schema))
    elif parts := [each for key in ("anyOf", "oneOf", "allOf") for each in schema.get(key, ())]:
        # Those of a model are conditions.
        if "properties" in schema:
            yield schema
        else:
            for each in parts:
                yield from _variants(each)
    elif schema.get("type") != "null":
        yield schema


def _resolved(schema: Schema) -> Schema:
    definition: Schema = _schema()["$defs"][schema["$ref"].rpartition("/")[2]]
    return definition


def _type(variants: list[Schema]) -> dict[str, Any]:
    """Return the type of a value and what limits it; nothing if it is none of a field."""
    words = [each["const"] for each in variants if "const" in each]
    choices = {"choices": words} if words else {}
    match [each for each in variants if "const" not in each]:
        case [{"enum": values}]:
            return {
                "type": "choice",
                "choices": [each for each in values if each not in SIDE_NAMES],
            }
        case [{"type": "integer" | "number" as kind} as schema]:
            return {"type": kind, **_bounds(schema), **choices}
        case [{"type": "array", "maxItems": 2, "items": {"type": "integer"} as schema}]:
            kind = "cell" if schema["minimum"] == 0 else "size"
            return {"type": kind, **_bounds(schema), **choices}
        case [{"type": "array", "items": {"type": "string"}}]:
            return {"type": "texts"}
        case [{"type": "string"}, {"type": "array"}]:
            return {"type": "names"}
        case [{"type": "boolean"}]:
            return {"type": "flag"}
        case [{"type": "string"}]:
            return {"type": "text"}
        case [{"type": "color"}]:
            return {"type": "color"}
        case _:
            return {}


def _bounds(schema: Schema) -> dict[str, Any]:
    bounds: dict[str, Any] = {key: schema[key] for key in ("minimum", "maximum") if key in schema}
    if "exclusiveMinimum" in schema:
        bounds["minimum"] = schema["exclusiveMinimum"]
    if "exclusiveMaximum" in schema:
        bounds["maximum"] = schema["exclusiveMaximum"] - 1
    return bounds


def _owners(model: Schema) -> dict[str, str]:
    """Return, for the fields that only make sense beside another one, or are it, that one."""
    conditions = model.get("oneOf", ())
    owners = {}
    for name in model["properties"]:
        with_it = [
            each["required"][0]
            for each in conditions
            if each["properties"].get(name, {}) in ({}, {"not": {"type": "null"}})
        ]
        if len(with_it) == 1:
            owners[name] = with_it[0]
    return owners
