"""Pydantic's complaints in the words of people who write levels."""

from __future__ import annotations

from typing import Any

from babyrobot_levels.language.base import FORM_PREFIX, SIDE_NAMES, SIDES, SLUG
from babyrobot_levels.language.color import NAMES, PATTERN
from babyrobot_levels.language.looks import THEME_NAME
from babyrobot_levels.language.pack import VERSION
from babyrobot_levels.text.suggest import did_you_mean
from babyrobot_levels.text.words import shortened

Complaint = tuple[str, str, str | None]
"""Code, message, help."""

TYPES = {
    "int_type": "a whole number",
    "float_type": "a number",
    "string_type": "a text",
    "bool_type": "`true` or `false`",
    "tuple_type": "a list",
    "dict_type": "a mapping",
    "model_type": "a mapping",
    "model_attributes_type": "a mapping",
}


FORMS = {
    "exit": "a cell `[x, y]`, a list of cells, or `none`",
    "start": "a cell `[x, y]`, or a list of cells",
    "seed": "a whole number or `random`",
    "to": "a cell `[x, y]` or `start`",
    "skid": "a number from 0 to 1, or a mapping",
    "theme": "a theme's name or a mapping",
    "side_panel": "`none`, a width, or a mapping",
    "bottom_panel": "`none`, a height, or a mapping",
    "size": "`[width, height]`, or a mapping with `min` and `max`",
    "algorithm": "an algorithm, or a list of them",
    "loops": "a share from 0 to 1, or a mapping with `min` and `max`",
    "puddles": "a whole number, or a mapping with `min` and `max`",
    "path_length": "a whole number, or a mapping with `min` and `max`",
    "dead_ends": "a whole number, or a mapping with `min` and `max`",
    "difficulty": "a number, or a mapping with `min` and `max`",
}
"""What fields can hold that can be written in several ways."""


def complaint(error: Any, fields: list[str], beginning: str | None = None) -> Complaint:
    """Return code, message and help for one of pydantic's error details.

    Args:
        error: the detail.
        fields: the names that the mapping around the fault knows.
        beginning: what a file of its kind needs at least.
    """
    kind, context, value = error["type"], error.get("ctx", {}), error.get("input")
    names = [s for s in error["loc"] if isinstance(s, str) and not s.startswith(FORM_PREFIX)]
    field = names[-1] if names else ""
    is_form = bool(error["loc"]) and str(error["loc"][-1]).startswith(FORM_PREFIX)
    if kind == "extra_forbidden":
        guess = did_you_mean(field, fields)
        return "BR201", f"there is no field `{shortened(field)}` here{guess}", _list(fields)
    if kind == "missing":
        help_text = beginning if field == "version" else None
        return "BR202", f"the field `{field}` is missing", help_text
    if is_form and field in FORMS and (kind in TYPES or kind in ("pair", "literal_error")):
        message = f"must be {FORMS[field]}, not {show(value)}"
        if kind == "literal_error":
            return "BR204", message + did_you_mean(str(value), _choices(context["expected"])), None
        return "BR203", message, _type_help(field, kind, value)
    if kind in TYPES:
        help_text = _type_help(field, kind, value)
        return "BR203", f"must be {TYPES[kind]}, not {show(value)}", help_text
    if kind == "pair":
        return "BR203", f"must be {context['what']}, not {show(value)}", None
    if kind in ("literal_error", "enum"):
        return _choice(field, context["expected"], value)
    if kind in ("greater_than_equal", "greater_than", "less_than_equal", "less_than"):
        return "BR205", f"must be {_bound(kind, context)}, not {show(value)}", None
    if kind == "finite_number":
        return "BR205", f"must be a finite number, not {show(value)}", None
    if kind in ("too_short", "too_long"):
        return _length(kind, context)
    if kind == "string_pattern_mismatch":
        return _pattern(context["pattern"], value)
    if kind == "string_too_long":
        return "BR205", f"must be at most {context['max_length']} characters long", None
    return "BR203", str(error["msg"]), None


def show(value: Any) -> str:
    """Return a value as it would stand in a file, shortened."""
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list | tuple):
        if len(value) <= 3 and all(isinstance(item, int | float | str) for item in value):
            return "`[" + ", ".join(shortened(item) for item in value) + "]`"
        return f"a list of {len(value)}" if value else "an empty list"
    if isinstance(value, str):
        return f"the text `{shortened(value)}`" if value else "an empty text"
    return f"`{shortened(value)}`"


def _named(value: Any) -> str:
    return f"`{shortened(value)}`" if value != "" else "an empty text"


def _list(names: list[str]) -> str | None:
    if not names:
        return None
    return ("known here: " + ", ".join(names)) if len(names) <= 8 else None


def _type_help(field: str, kind: str, value: Any) -> str | None:
    if value is None:
        if field == "exit":
            return "for a level without an exit, write `exit: none`"
        return "give it a value, or leave the field out"
    if field == "version":
        return "write three numbers, as in `version: 1.0.0`"
    is_word = isinstance(value, str) and value.strip().lower() in ("yes", "no", "on", "off")
    if kind == "bool_type" and is_word:
        return "write `true` or `false`"
    is_cell = isinstance(value, list) and len(value) == 2
    if kind.startswith("model_") and is_cell and all(isinstance(v, int) for v in value):
        return f"write `at: [{value[0]}, {value[1]}]`"
    return None


def _choice(field: str, expected: str, value: Any) -> Complaint:
    names = _choices(expected)
    if field == "version":
        return (
            "BR204",
            f"this is version 1 of the language, not {show(value)}",
            "write `version: 1`",
        )
    if names == list(SIDES):
        names += SIDE_NAMES
    guess = did_you_mean(value, names) if isinstance(value, str) else ""
    shown = f"`{names[0]}`" if len(names) == 1 else "one of " + ", ".join(f"`{n}`" for n in names)
    return "BR204", f"must be {shown}, not {show(value)}{guess}", None


def _choices(expected: str) -> list[str]:
    # pydantic lists them as `'a', 'b' or 'c'`.
    return [part.strip().strip("'") for part in expected.replace(" or ", ", ").split(", ")]


def _bound(kind: str, context: dict[str, Any]) -> str:
    words = {
        "greater_than_equal": ("ge", "at least"),
        "greater_than": ("gt", "above"),
        "less_than_equal": ("le", "at most"),
        "less_than": ("lt", "below"),
    }
    key, text = words[kind]
    bound = context[key]
    return f"{text} {int(bound) if float(bound).is_integer() else bound}"


def _length(kind: str, context: dict[str, Any]) -> Complaint:
    if kind == "too_short":
        return "BR203", "must not be an empty list", None
    return "BR205", f"must be a list of at most {context['max_length']}", None


def _pattern(pattern: str, value: Any) -> Complaint:
    if pattern == PATTERN:
        return (
            "BR403",
            f"{_named(value)} is no colour{did_you_mean(str(value), NAMES)}",
            "a CSS name in small letters, `#rrggbb`, `rgb(…)`, `rgba(…)` or `hsl(…)`",
        )
    if pattern == SLUG:
        return (
            "BR207",
            f"must be small letters and digits, joined by `-`, not {show(value)}",
            "for example `first-maze`; a `title` may hold anything",
        )
    if pattern == VERSION:
        return (
            "BR207",
            f"must be three numbers such as `1.0.0`, not {show(value)}",
            "raise the first for other games, the second for more levels, the last for repairs",
        )
    if pattern == THEME_NAME:
        return (
            "BR401",
            f"{_named(value)} is no theme's name",
            "a theme is named, not given as a path",
        )
    return (
        "BR207",
        f"{_named(value)} cannot be a key of the legend",
        "one printable ASCII character that the drawing does not use already (# S E o O + - | :)",
    )
