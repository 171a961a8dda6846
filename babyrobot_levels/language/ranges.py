"""Ranges: a number, or everything between two of them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import Field

from babyrobot_levels.language.base import Integer, Model, Number, Probability, Size, form, forms
from babyrobot_levels.text.diagnostics import Issue


class CountRange(Model):
    """Whole numbers from `min` to `max`, both included; without one of them, open there."""

    min: Annotated[Integer, Field(ge=0)] = 0
    """The least."""
    max: Annotated[Integer, Field(ge=0)] | None = None
    """The most."""


class NumberRange(Model):
    """Numbers from `min` to `max`, both included; without one of them, open there."""

    min: Number = 0.0
    """The least."""
    max: Number | None = None
    """The most."""


class PuddleRange(Model):
    """Whole numbers from `min` to `max`, both included."""

    min: Annotated[Integer, Field(ge=0)] = 0
    """The least."""
    max: Annotated[Integer, Field(ge=0)]
    """The most."""


class ShareRange(Model):
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


def _number_or_mapping(value: Any) -> str:
    return "mapping" if isinstance(value, dict | Model) else "number"


def _size_or_mapping(value: Any) -> str:
    return "mapping" if isinstance(value, dict | Model) else "size"


Counts = Annotated[
    Annotated[Annotated[Integer, Field(ge=0)], form("number")]
    | Annotated[CountRange, form("mapping")],
    forms(_number_or_mapping),
]
Numbers = Annotated[
    Annotated[Number, form("number")] | Annotated[NumberRange, form("mapping")],
    forms(_number_or_mapping),
]
PuddleCounts = Annotated[
    Annotated[Annotated[Integer, Field(ge=0)], form("number")]
    | Annotated[PuddleRange, form("mapping")],
    forms(_number_or_mapping),
]
Shares = Annotated[
    Annotated[Probability, form("number")] | Annotated[ShareRange, form("mapping")],
    forms(_number_or_mapping),
]
Sizes = Annotated[
    Annotated[Size, form("size")] | Annotated[SizeRange, form("mapping")],
    forms(_size_or_mapping),
]


def bounds(value: Any) -> tuple[Any, Any]:
    """Return the least and the most of a range; None for a most that is open."""
    is_range = isinstance(value, Model)
    return (value.min, value.max) if is_range else (value, value)


def shown(value: Any) -> str:
    """Return a range in the way of the command line: `20`, `20..30`, `20..`, `..30`."""
    least, most = bounds(value)
    texts = ["" if bound is None else f"{bound:g}" for bound in (least, most)]
    if least == most:
        return texts[0]
    return f"{texts[0] if least or most is None else ''}..{texts[1]}"


def empty_ranges(model: Model, names: tuple[str, ...]) -> Iterator[Issue]:
    """Yield an error for each range of a model whose `min` is above its `max`."""
    for name in names:
        value = getattr(model, name)
        if value is None:
            continue
        least, most = bounds(value)
        is_pair = isinstance(least, tuple)
        pairs = zip(least, most, strict=True) if is_pair else [(least, most)]
        if any(high is not None and low > high for low, high in pairs):
            shown_least, shown_most = (list(least), list(most)) if is_pair else (least, most)
            message = f"`min` ({shown_least}) is above `max` ({shown_most})"
            yield Issue("BR205", (name, "min"), message)
