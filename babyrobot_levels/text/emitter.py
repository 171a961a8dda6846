"""Canonical YAML: how values are written, and how they are laid out on lines."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from math import isfinite, isnan
from typing import Any

from babyrobot_levels.text.scalars import is_plain_string

_PLAIN = re.compile(r"(?:\.\.)?(?:-(?=[0-9]))?[^\W_](?:[^\n\r\t]*\S)?")
_UNUSUAL = re.compile(r"[^ !#-\[\]-~]")
_ESCAPES = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r"}


def emit(data: dict[str, Any]) -> str:
    """Return a level's fields as YAML, in the order in which they stand in `data`."""
    return "".join(f"{line}\n" for line in lines_of(_container(data)))


def emit_field(name: str, value: Any) -> str:
    """Return one field with its value, as whole lines."""
    return emit({name: value})


def emit_entry(value: Any, indent: int = 0) -> list[str]:
    """Return an entry of a list, as whole lines that are indented by so many blanks."""
    return lines_of(_container([value]), " " * indent)


def flow(value: Any) -> str:
    """Return a value as YAML on one line."""
    # What comes from data has no comments, which alone keep a value from it.
    return on_one_line(_value(value)) or ""


class Figure(float):
    """A number that has a text of its own: `-7.00`."""

    def __new__(cls, text: str) -> Figure:
        """Return the number that a text says."""
        figure = super().__new__(cls, text)
        figure.text = text
        return figure

    text: str


def scalar(value: Any, *, in_flow: bool = False) -> str:
    """Return a scalar as YAML that reads back as the same value."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Figure):
        return value.text
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
    return text if is_plain else f'"{_UNUSUAL.sub(_escaped, text)}"'


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


WIDTH = 88
"""Lists and mappings that fit on a line of this width stand on one line."""

ON_LINES = "expect"
"""The mapping whose entries are read, and found wrong, one by one."""

STEP = "  "
"""What a value inside another one is indented by."""


@dataclass(slots=True)
class Scalar:
    """A text, a number or a word, as YAML."""

    text: str
    """As it stands behind a field's name; of several lines, the first."""
    flow: str | None
    """As it stands inside brackets; None where it cannot."""
    rest: tuple[str, ...] = ()
    """Its further lines, without their indentation."""
    is_number: bool = False


@dataclass(slots=True)
class Container:
    """A mapping, whose entries have keys, or a list, whose entries have none."""

    is_mapping: bool
    entries: list[Entry]
    below: list[str] = field(default_factory=list)
    """Comments behind the last entry, and an empty text for each blank line."""
    properties: str = ""
    """Its anchor or its tag."""


Value = Scalar | Container


@dataclass(slots=True)
class Entry:
    """A field of a mapping, or an entry of a list."""

    value: Value
    key: str | None = None
    """The field's name, as YAML."""
    above: list[str] = field(default_factory=list)
    """Comments above it, and an empty text for each blank line."""
    behind: str = ""
    """The comment behind it."""


def lines_of(container: Container, indent: str = "") -> list[str]:
    """Return a container's entries on lines of their own, without their line ends."""
    lines: list[str] = []
    _put_entries(container, indent, lines)
    return lines


def on_one_line(value: Value) -> str | None:
    """Return a value as it stands inside brackets, or None where it cannot."""
    if isinstance(value, Scalar):
        return value.flow
    if any(value.below):
        return None
    parts = []
    for entry in value.entries:
        has_comments = entry.behind or any(entry.above)
        part = None if has_comments else on_one_line(entry.value)
        if part is None:
            return None
        parts.append(part if entry.key is None else f"{entry.key}: {part}")
    text = ", ".join(parts)
    text = f"{{{text}}}" if value.is_mapping else f"[{text}]"
    return f"{value.properties} {text}" if value.properties else text


def _put_entries(container: Container, indent: str, lines: list[str]) -> None:
    first = len(lines)
    for entry in container.entries:
        _put_comments(entry.above, indent, lines, first)
        _put_entry(entry, indent, lines)
    _put_comments(container.below, indent, lines, first)


def _put_comments(comments: list[str], indent: str, lines: list[str], first: int) -> None:
    """Add comments, and blank lines, but never a blank line at the beginning, nor two in a row."""
    for text in comments:
        if text:
            lines.append(indent + text)
        elif len(lines) > first and lines[-1]:
            lines.append("")


def _put_entry(entry: Entry, indent: str, lines: list[str]) -> None:
    lead = f"{indent}-" if entry.key is None else f"{indent}{entry.key}:"
    behind = f"  {entry.behind}" if entry.behind else ""
    value = entry.value
    if isinstance(value, Scalar):
        first = len(lines)
        lines.append(f"{lead} {value.text}")
        lines += [f"{indent}{STEP}{line}" if line else "" for line in value.rest]
        # Behind the lines of a block there is no room for a comment, but behind its sign there is.
        lines[first if value.text[0] in "|>" else -1] += behind
        return
    short = None if _wants_lines(value, entry) else on_one_line(value)
    fits = short is not None and len(lead) + 1 + len(short) <= WIDTH
    if short is not None and (fits or not value.entries):
        lines.append(f"{lead} {short}{behind}")
        return
    hangs = entry.key is None and not value.properties
    if not hangs:
        lead = f"{lead} {value.properties}" if value.properties else lead
        lines.append(lead + behind)
    elif behind:
        lines.append(indent + entry.behind)
    first = len(lines)
    if short is not None and _holds_numbers(value):
        lines += _filled(value, indent + STEP)
    else:
        _put_entries(value, indent + STEP, lines)
    if hangs:
        # What hangs on a dash begins on the line of the dash.
        lines[first] = lead + lines[first][len(lead) :]


def _wants_lines(value: Container, entry: Entry) -> bool:
    """Tell whether a container is easier to read over several lines, however short it is."""
    if value.is_mapping and entry.key in (None, ON_LINES):
        return entry.key is not None and bool(value.entries)
    return any(isinstance(e.value, Container) and e.value.is_mapping for e in value.entries)


def _holds_numbers(value: Container) -> bool:
    values = (entry.value for entry in value.entries)
    return not value.is_mapping and all(isinstance(v, Scalar) and v.is_number for v in values)


def _filled(numbers: Container, indent: str) -> Iterator[str]:
    """Yield the lines of a long list of numbers, each with as many as fit."""
    line = f"{indent}["
    for number, entry in enumerate(numbers.entries, 1):
        word = f"{on_one_line(entry.value)}{',' if number < len(numbers.entries) else ']'}"
        if number > 1 and len(line) + 1 + len(word) > WIDTH:
            yield line
            line = f"{indent} {word}"
        else:
            line += word if number == 1 else f" {word}"
    yield line
