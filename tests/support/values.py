"""Values for the fields of the language, found by their types: a new field is drawn unchanged.

Fields that say where something stands, or name something, are left to those who make levels.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from babyrobot_levels.language.kinds import LOOKS

NUMBERS = (-10, -3, -2.5, -1, -0.1, 0, 0.1, 0.25, 1 / 3, 0.5, 0.8, 1, 2, 7)
SKIDS = ({"probability": 0.25}, *({"probability": 0.5, "to": to} for to in ("sides", "others")))
TEXTS = ("red", "#abc", "rgb(1, 2, 3)", "hsl(120, 50%, 50%)", "a: b", "")
PLACES = {"side", "length", "to", "wind"}


def _literals(annotation: Any) -> Iterator[Any]:
    for each in get_args(annotation):
        yield from [each] if isinstance(each, str) else _literals(each)


def _accepts(model: type[BaseModel], name: str, value: Any) -> bool:
    try:
        model.model_validate({name: value})
    except ValidationError as error:
        return all(each["loc"][0] != name for each in error.errors())
    return True


@cache
def _values(model: type[BaseModel], name: str) -> tuple[Any, ...]:
    field = model.model_fields[name]
    pool = [*NUMBERS, True, False, *SKIDS, *_literals(field.annotation)]
    pool += TEXTS if name in LOOKS else ()
    return tuple(value for value in pool if _accepts(model, field.alias or name, value))


@cache
def fields_of(model: type[BaseModel], looks: bool = False) -> Mapping[str, tuple[Any, ...]]:
    """Return values for the fields of a model that only pictures show, or for all others."""
    found = {
        field.alias or name: _values(model, name)
        for name, field in model.model_fields.items()
        if name not in PLACES and (name in LOOKS) == looks
    }
    return {name: values for name, values in found.items() if values}
