"""Plain data to canonical YAML: one way of writing each level, easy to read and to diff."""

from __future__ import annotations

import re
from math import isfinite, isnan
from typing import Any

from babyrobot_levels.text.layout import Container, Entry, Scalar, Value, lines_of, on_one_line
from babyrobot_levels.text.scalars import is_plain_string

_PLAIN = re.compile(r"[^\W_](?:[^\n\r\t]*\S)?")
_UNUSUAL = re.compile(r"[^ !#-\[\]-~]")
_ESCAPES = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r"}


def emit(data: dict[str, Any]) -> str:
    """Return a level's fields as YAML, in the order in which they stand in `data`."""
    return "".join(f"{line}\n" for line in lines_of(_container(data)))


def emit_field(name: str, value: Any) -> str:
    """Return one field with its value, as whole lines."""
    return emit({name: value})


def flow(value: Any) -> str:
    """Return a value as YAML on one line."""
    # What comes from data has no comments, which alone keep a value from it.
    return on_one_line(_value(value)) or ""


def scalar(value: Any, *, in_flow: bool = False) -> str:
    """Return a scalar as YAML that reads back as the same value."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        if not isfinite(value):
            return ".nan" if isnan(value) else ".inf" if value > 0 else "-.inf"
        if value.is_integer() and abs(value) < 1e15:
            return str(int(value))
        return repr(value).replace("e-0", "e-").replace("e+", "e")
    if isinstance(value, int):
        return str(value)
    text = str(value)
    is_plain = (
        _PLAIN.fullmatch(text) is not None
        and text.isprintable()
        and ": " not in text
        and " #" not in text
        and not text.endswith(":")
        and not (in_flow and any(character in ",[]{}" for character in text))
        and is_plain_string(text)
    )
    return text if is_plain else _quoted(text)


def _value(value: Any) -> Value:
    if isinstance(value, dict | list):
        return _container(value)
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    text, *rest = _text_lines(value) if isinstance(value, str) else [scalar(value)]
    return Scalar(text, scalar(value, in_flow=True), tuple(rest), is_number)


def _container(data: dict[str, Any] | list[Any]) -> Container:
    if isinstance(data, list):
        return Container(False, [Entry(_value(value)) for value in data])
    return Container(True, [Entry(_value(data[key]), scalar(key, in_flow=True)) for key in data])


def _text_lines(text: str) -> list[str]:
    """Return a text as lines: a literal block where it has several that can stand in one."""
    lines = text.split("\n")
    fits_a_block = (
        len(lines) > 1
        and lines[0].strip()
        and lines[0][0] != " "
        and (lines[-1] or lines[-2])
        and all(line.isprintable() for line in lines)
    )
    if not fits_a_block:
        return [scalar(text)]
    return ["|-", *lines] if lines[-1] else ["|", *lines[:-1]]


def _quoted(text: str) -> str:
    return f'"{_UNUSUAL.sub(_escaped, text)}"'


def _escaped(found: re.Match[str]) -> str:
    character = found[0]
    if character in _ESCAPES:
        return _ESCAPES[character]
    if character.isprintable():
        return character
    code = ord(character)
    return (
        f"\\x{code:02x}" if code < 256 else f"\\u{code:04x}" if code < 65536 else f"\\U{code:08x}"
    )
