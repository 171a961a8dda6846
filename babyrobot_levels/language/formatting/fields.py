"""The order in which fields are written, read from the models."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cache
from typing import Any, get_args, get_origin

from pydantic import BaseModel


@dataclass(frozen=True, slots=True)
class Fields:
    """What is known of a mapping, or of each mapping in a list.

    Attributes:
        inner: the fields in their order, each with what is known of its value.
        others: what is known of the values of all other keys.
    """

    inner: dict[str, Fields] = field(default_factory=dict)
    others: Fields | None = None

    def of(self, key: str) -> Fields:
        """Return what is known of a key's value."""
        return self.inner.get(key) or self.others or NOTHING

    def order(self, keys: Iterable[str]) -> list[str]:
        """Return keys in the order of the fields, those that are not known behind the others."""
        given = list(keys)
        known = [key for key in self.inner if key in given]
        return [*known, *(key for key in given if key not in self.inner)]


NOTHING = Fields()


@cache
def fields_of(model: type[BaseModel]) -> Fields:
    """Return the fields of a model, with those of the models in them."""
    inner = {
        info.alias or name: _fields_in(info.annotation) for name, info in model.model_fields.items()
    }
    return Fields(inner)


def _fields_in(annotation: Any) -> Fields:
    """Return the fields of the model that an annotation holds: in a list, a union, a dict."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return fields_of(annotation)
    found = (_fields_in(argument) for argument in get_args(annotation))
    first = next((fields for fields in found if fields is not NOTHING), NOTHING)
    return Fields(others=first) if get_origin(annotation) is dict else first
