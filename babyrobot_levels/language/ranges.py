"""Ranges of numbers: `{min: 18, max: 22}`, or as a text, `18..22`, `18..`, `..22`."""

# As in `base`, annotations are not postponed.
import re
from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import Field, GetJsonSchemaHandler, model_validator
from pydantic_core import CoreSchema

from babyrobot_levels.language.base import Integer, Model, Number, Probability, Size, form, forms
from babyrobot_levels.text.diagnostics import Issue
from babyrobot_levels.text.scalars import resolve

_NUMBER = r"-?[0-9]{1,20}(?:\.[0-9]{1,20})?"
TEXT = rf"^(?:{_NUMBER}\.\.(?:{_NUMBER})?|\.\.{_NUMBER})$"
"""What a range looks like as a text."""

_TEXT = re.compile(TEXT)


def ends(text: str) -> dict[str, Any]:
    """Return the ends of a range that is written as a text; nothing if it is none."""
    if not _TEXT.fullmatch(text):
        return {}
    least, _, most = text.partition("..")
    return {name: resolve(end) for name, end in (("min", least), ("max", most)) if end}


class Range(Model):
    """Numbers from `min` to `max`, both included. It may be given as a text."""

    @model_validator(mode="before")
    @classmethod
    def _of_text(cls, value: Any) -> Any:
        return ends(value) or value if isinstance(value, str) else value

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        schema = handler.resolve_ref_schema(handler(core_schema))
        return {**schema, "type": ["object", "string"], "pattern": TEXT}


class CountRange(Range):
    """Whole numbers from `min` to `max`, both included; without one of them, open there."""

    min: Annotated[Integer, Field(ge=0)] = 0
    """The least."""
    max: Annotated[Integer, Field(ge=0)] | None = None
    """The most."""


class NumberRange(Range):
    """Numbers from `min` to `max`, both included; without one of them, open there."""

    min: Number = 0.0
    """The least."""
    max: Number | None = None
    """The most."""


class PuddleRange(Range):
    """Whole numbers from `min` to `max`, both included."""

    min: Annotated[Integer, Field(ge=0)] = 0
    """The least."""
    max: Annotated[Integer, Field(ge=0)]
    """The most."""


class ShareRange(Range):
    """Shares from `min` to `max`, both included, in steps of a hundredth."""

    min: Probability = 0.0
    """The least."""
    max: Probability
    """The most."""


class SizeRange(Model):
    """Sizes from `min` to `max`: width and height are drawn each for itself."""

    min: Size
    """The smallest width and height."""
    max: Size
    """The largest width and height."""


def _number_or_range(value: Any) -> str:
    is_range = isinstance(value, dict | Model) or (isinstance(value, str) and ends(value))
    return "range" if is_range else "number"


def _size_or_mapping(value: Any) -> str:
    return "mapping" if isinstance(value, dict | Model) else "size"


Counts = Annotated[
    Annotated[Annotated[Integer, Field(ge=0)], form("number")]
    | Annotated[CountRange, form("range")],
    forms("an integer, or a range such as `3..5`", _number_or_range),
]
Numbers = Annotated[
    Annotated[Number, form("number")] | Annotated[NumberRange, form("range")],
    forms("a number, or a range such as `3..5`", _number_or_range),
]
PuddleCounts = Annotated[
    Annotated[Annotated[Integer, Field(ge=0)], form("number")]
    | Annotated[PuddleRange, form("range")],
    forms("an integer, or a range such as `3..5`", _number_or_range),
]
Shares = Annotated[
    Annotated[Probability, form("number")] | Annotated[ShareRange, form("range")],
    forms("a share from 0 to 1, or a range such as `0.2..0.4`", _number_or_range),
]
Sizes = Annotated[
    Annotated[Size, form("size")] | Annotated[SizeRange, form("mapping")],
    forms("`[width, height]`, or a mapping with `min` and `max`", _size_or_mapping),
]


def bounds(value: Any) -> tuple[Any, Any]:
    """Return the least and the most of a number or a range; None where it is open."""
    if isinstance(value, str):
        value = ends(value)
        return value.get("min"), value.get("max")
    is_range = isinstance(value, Model)
    return (value.min, value.max) if is_range else (value, value)


def shown(value: Any) -> str:
    """Return a range in the way of the command line: `20`, `20..30`, `20..`, `..30`."""
    least, most = bounds(value)
    texts = ["" if bound is None else f"{bound:g}" for bound in (least, most)]
    if least == most:
        return texts[0]
    return f"{texts[0] if least or most is None else ''}..{texts[1]}"


def empty_ranges(model: Model) -> Iterator[Issue]:
    """Yield an error for each range of a model whose `min` is above its `max`."""
    for name, value in model:
        if not isinstance(value, Model) or {"min", "max"} != type(value).model_fields.keys():
            continue
        least, most = bounds(value)
        is_pair = isinstance(least, tuple)
        pairs = zip(least, most, strict=True) if is_pair else [(least, most)]
        if any(None not in pair and pair[0] > pair[1] for pair in pairs):
            shown_least, shown_most = (list(least), list(most)) if is_pair else (least, most)
            message = f"`min` ({shown_least}) is above `max` ({shown_most})"
            yield Issue("BR205", (name, "min"), message)
