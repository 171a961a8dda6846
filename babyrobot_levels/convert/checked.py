"""Values of other formats, checked one by one: what is wrong is told by its name there."""

from __future__ import annotations

import math
import re
from typing import Any

from babyrobot_levels.convert.conversion import ConversionError, shown
from babyrobot_levels.language.looks import PATTERN


def integer(value: Any, where: str) -> int:
    """Return a whole number."""
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    if isinstance(value, bool) or not isinstance(value, int):
        raise ConversionError(f"{where} must be a whole number, not {shown(value)}")
    return value


def number(value: Any, where: str) -> float:
    """Return a finite number."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        try:
            if math.isfinite(value):
                return value
        except OverflowError:
            pass
    raise ConversionError(f"{where} must be a number, not {shown(value)}")


def probability(value: Any, where: str) -> float:
    """Return a number from 0 to 1."""
    if not 0 <= number(value, where) <= 1:
        raise ConversionError(f"{where} must be a probability from 0 to 1, not {shown(value)}")
    return number(value, where)


def sequence(value: Any, where: str) -> list[Any]:
    """Return a list."""
    if not isinstance(value, list):
        raise ConversionError(f"{where} must be a list, not {shown(value)}")
    return value


def mapping(value: Any, where: str) -> dict[str, Any]:
    """Return a mapping."""
    if not isinstance(value, dict):
        raise ConversionError(f"{where} must be a mapping, not {shown(value)}")
    return value


def integers(value: Any, where: str, *counts: int) -> list[int]:
    """Return a list of so many whole numbers."""
    found = [integer(each, where) for each in sequence(value, where)]
    if len(found) not in counts:
        wanted = " or ".join(map(str, counts))
        raise ConversionError(f"{where} must be {wanted} whole numbers, not {len(found)}")
    return found


def color(value: Any) -> str | None:
    """Return a colour as the language writes it, or None if the language has no such colour."""
    if not isinstance(value, str):
        return None
    text = value.strip()
    text = text if text.startswith("#") else text.lower()
    return text if len(text) <= 64 and re.fullmatch(PATTERN, text) else None
