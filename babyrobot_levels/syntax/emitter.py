"""Plain data to canonical YAML: one way of writing each level, easy to read and to diff."""

from __future__ import annotations

import re
from typing import Any

from babyrobot_levels.syntax.scalars import is_plain_string

WIDTH = 88
"""Mappings that fit on a line of this width stand on one line."""

_PLAIN = re.compile(r"[^\W_](?:[^\n\r\t]*\S)?")
_ESCAPES = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r"}


def emit(data: dict[str, Any]) -> str:
    """Return a level's fields as YAML, in the order in which they stand in `data`."""
    return "".join(emit_field(name, value) for name, value in data.items())


def emit_field(name: str, value: Any, indent: str = "") -> str:
    """Return one field with its value, as whole lines."""
    key = f"{indent}{scalar(name)}:"
    if isinstance(value, str):
        return f"{key} {_text(value, indent)}\n"
    if isinstance(value, dict):
        flow = _flow(value)
        if len(key) + 1 + len(flow) <= WIDTH and not _holds_mappings(value):
            return f"{key} {flow}\n"
        return f"{key}\n" + "".join(emit_field(k, v, indent + "  ") for k, v in value.items())
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return f"{key}\n" + "".join(f"{indent}  - {_flow(item)}\n" for item in value)
    return f"{key} {_flow(value)}\n"


def scalar(value: Any, *, in_flow: bool = False) -> str:
    """Return a scalar as YAML that reads back as the same value."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return str(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)
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


def _flow(value: Any) -> str:
    if isinstance(value, dict):
        pairs = (f"{scalar(k, in_flow=True)}: {_flow(v)}" for k, v in value.items())
        return "{" + ", ".join(pairs) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_flow, value)) + "]"
    return scalar(value, in_flow=True)


def _holds_mappings(value: dict[str, Any]) -> bool:
    return any(isinstance(inner, dict) for inner in value.values())


def _text(text: str, indent: str) -> str:
    lines = text.split("\n")
    fits_a_block = (
        len(lines) > 1
        and lines[0].strip()
        and lines[0][0] != " "
        and (lines[-1] or lines[-2])
        and all(line.isprintable() for line in lines)
    )
    if not fits_a_block:
        return scalar(text)
    chomp = "-" if lines[-1] else ""
    body = lines if lines[-1] else lines[:-1]
    return f"|{chomp}\n" + "\n".join(f"{indent}  {line}" if line else "" for line in body)


def _quoted(text: str) -> str:
    return '"' + "".join(map(_escaped, text)) + '"'


def _escaped(character: str) -> str:
    if character in _ESCAPES:
        return _ESCAPES[character]
    if character.isprintable():
        return character
    code = ord(character)
    return (
        f"\\x{code:02x}" if code < 256 else f"\\u{code:04x}" if code < 65536 else f"\\U{code:08x}"
    )
