"""Data from anywhere as a file could hold it: texts, numbers, lists and mappings, within bounds."""

from collections.abc import Mapping
from math import inf, isfinite, isnan, log10, prod
from typing import Any

from pydantic import BaseModel

from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.reader import MAX_DEPTH
from babyrobot_levels.text.words import shortened

MAX_BITS = 2000
"""Whole numbers of more bits are not written down: Python refuses to, as it takes so long."""

MAX_VALUES = 6_000_000
"""What is given as data may hold so many values: a maze of 1024 by 1024 cells has fewer, with all
its walls listed one by one."""


def plain(data: Any, *, most: float = inf) -> Any:
    """Return data as a file holds it: lists, no models, no NumPy, no classes of one's own.

    Args:
        data: texts, numbers, booleans, None, lists, tuples, mappings, models, NumPy's numbers and
            arrays.
        most: how many values it may hold, those counted again that it holds several times.

    Raises:
        LevelError: it holds something else, or more; it is nested deeper than a file may be, as
            what contains itself is; a number is too large to be written down, or a text has
            characters that no file can hold.
    """
    return _Copy(most).of(data)


class _Copy:
    def __init__(self, most: float):
        self.most = self.left = most
        self.route: list[str | int] = []
        """The keys that lead to what is being copied."""

    def of(self, value: Any) -> Any:
        kind = type(value)
        if kind is str:
            return self._text(value)
        if kind is int:
            return self._whole_number(value)
        if kind is float or kind is bool or value is None:
            return value
        if kind is list:
            return self._list(value)
        if kind is dict:
            return self._mapping(value)
        return self._of_another_class(value)

    def _of_another_class(self, value: Any) -> Any:
        if isinstance(value, BaseModel):
            return self.of(value.model_dump(by_alias=True, exclude_unset=True))
        if hasattr(type(value), "tolist"):
            self._count(prod(getattr(value, "shape", ())))
            value = value.tolist()
        if isinstance(value, Mapping):
            return self._mapping(value)
        if isinstance(value, list | tuple):
            return self._list(value)
        # The representation of a subclass is not used: only its value counts.
        if isinstance(value, str):
            return self._text(str.__str__(value))
        if isinstance(value, bool) or value is None:
            return value
        if isinstance(value, int):
            return self._whole_number(int.__int__(value))
        if isinstance(value, float):
            return float.__float__(value)
        name = shortened(type(value).__name__)
        raise self._error(f"a `{name}` is nothing that a level can hold")

    def _mapping(self, value: Mapping[Any, Any]) -> dict[str, Any]:
        self._begin(len(value))
        copy: dict[str, Any] = {}
        for key, inner in value.items():
            name = self._text(key if type(key) is str else str(self.of(key)))
            if name in copy:
                raise self._error(f"`{shortened(name)}` stands there twice, as a text and as none")
            self.route.append(name)
            copy[name] = self.of(inner)
            self.route.pop()
        return copy

    def _list(self, value: list[Any] | tuple[Any, ...]) -> list[Any]:
        self._begin(len(value))
        copy = []
        for number, inner in enumerate(value):
            self.route.append(number)
            copy.append(self.of(inner))
            self.route.pop()
        return copy

    def _begin(self, values: int) -> None:
        """Begin with a list or a mapping of so many values."""
        if len(self.route) >= MAX_DEPTH:
            message = f"lists and mappings are nested more than {MAX_DEPTH} deep"
            raise LevelError(message=f"{message}, or contain themselves")
        self._count(values)

    def _count(self, values: int) -> None:
        self.left -= values
        if self.left < 0:
            raise LevelError(message=f"there are more than {self.most:,} values, too many to read")

    def _whole_number(self, value: int) -> int:
        if value.bit_length() > MAX_BITS:
            digits = int(value.bit_length() * log10(2))
            raise self._error(f"an integer of about {digits:,} digits is too large")
        return value

    def _text(self, value: str) -> str:
        if not value.isascii():
            try:
                value.encode("utf-8")
            except UnicodeEncodeError as error:
                code = ord(value[error.start])
                raise self._error(f"no file can hold the character U+{code:04X}") from None
        return value

    def _error(self, message: str) -> LevelError:
        keys = (f"[{key}]" if isinstance(key, int) else f".{shortened(key)}" for key in self.route)
        place = "".join(keys).lstrip(".")
        return LevelError(message=f"`{place}`: {message}" if place else message)


def json_mapping(data: dict[str, Any]) -> dict[str, Any]:
    """Return a mapping with None for nan, and texts for infinities."""
    return {name: json_value(value) for name, value in data.items()}


def json_value(value: Any) -> Any:
    """Return a value as `json_mapping` does."""
    if isinstance(value, dict):
        return json_mapping(value)
    if isinstance(value, list | tuple):
        return [json_value(each) for each in value]
    if not isinstance(value, float) or isfinite(value):
        return value
    return None if isnan(value) else "inf" if value > 0 else "-inf"
