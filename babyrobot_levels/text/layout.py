"""The canonical form: how values are laid out on lines, with the comments that belong to them.

A tree of `Scalar`s and `Container`s says what there is to write; where a line ends is decided
here and nowhere else. What fits on a line of 88 characters stands on one.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

WIDTH = 88
"""Lists and mappings that fit on a line of this width stand on one line."""

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
    if value.is_mapping and entry.key is None:
        return False
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
