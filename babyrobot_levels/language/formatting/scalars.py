"""Single values as they are written: no needless quotes, numbers and words in one way."""

from __future__ import annotations

import re

from babyrobot_levels.text.document import Node
from babyrobot_levels.text.emitter import Scalar, scalar

BRACKETS = ",[]{}"
"""What a text without quotes cannot hold inside brackets."""

_NUMBER = re.compile(r"([-+]?)0*([0-9]*)(?:\.([0-9]*))?(?:[eE]([-+]?[0-9]+))?")
_LINE_END = re.compile(r"\r\n|\r|\n")
# Other readers take these for booleans, dates, times or numbers of their own.
_BETTER_QUOTED = re.compile(r"[0-9].*|yes|no|on|off", re.IGNORECASE | re.DOTALL)


class KeptAsIs(Exception):
    """A text is written in a way that the formatter leaves alone; the message says which."""


def canonical(node: Node) -> Scalar:
    """Return a value as it is to be written.

    Raises:
        KeptAsIs: it is written in a way that is left alone.
    """
    raw, data = node.source.text[node.first : node.last], node.data
    sign = raw[:1]
    if sign and sign in "&!*":
        # An anchor, a tag or an alias: the author's own text.
        if _LINE_END.search(raw):
            raise KeptAsIs("a value with an anchor or a tag goes over several lines")
        return Scalar(raw, None if any(mark in raw for mark in BRACKETS) else raw)
    if sign and sign in "|>":
        return _block(raw, str(data))
    lines = _LINE_END.split(raw)
    if len(lines) > 1:
        return _folded(lines)
    if not isinstance(data, str):
        is_number = isinstance(data, int | float) and not isinstance(data, bool)
        text = _number(raw, data) if is_number else scalar(data)
        return Scalar(text, text, is_number=is_number)
    return Scalar(_text(raw, data), _text(raw, data, in_flow=True))


def canonical_key(node: Node) -> str:
    """Return a field's name as it is to be written.

    Raises:
        KeptAsIs: it is not written as a name usually is.
    """
    raw = node.source.text[node.first : node.last]
    if not raw or raw[0] in "&!*|>" or _LINE_END.search(raw):
        raise KeptAsIs("a field's name is written in an unusual way")
    if node.data == "on":
        # The field of a switch, which levels write without quotes: YAML 1.2 reads it as a text.
        return "on"
    return _text(raw, str(node.data), in_flow=True) if raw[0] in "'\"" else raw


def _text(raw: str, data: str, *, in_flow: bool = False) -> str:
    if raw[0] not in "'\"":
        has_brackets = in_flow and any(mark in raw for mark in BRACKETS)
        return scalar(data, in_flow=True) if has_brackets else raw
    if raw[0] == "'" or raw[1:-1] == data:
        plain = scalar(data, in_flow=in_flow)
        if plain[0] != '"' and not _BETTER_QUOTED.fullmatch(data):
            return plain
    if raw[0] == "'" and '"' not in data and "\\" not in data:
        return f'"{data}"'
    return raw


def _number(raw: str, data: float) -> str:
    match = _NUMBER.fullmatch(raw)
    if match is None:
        return raw
    if isinstance(data, int):
        return str(data)
    sign, whole, fraction, exponent = match.groups()
    fraction = (fraction or "").rstrip("0")
    text = ("-" if sign == "-" else "") + (whole or "0")
    if fraction or exponent is None:
        text += f".{fraction or '0'}"
    return text if exponent is None else f"{text}e{int(exponent)}"


def _folded(lines: list[str]) -> Scalar:
    """Return a text that goes over several lines, with quotes or without."""
    # A backslash at the end of a line would escape what follows it.
    first, *rest = (line if line.rstrip().endswith("\\") else line.rstrip() for line in lines[:-1])
    rest = [line.lstrip() for line in (*rest, lines[-1])]
    return Scalar(first, None, tuple(rest))


def _block(raw: str, data: str) -> Scalar:
    """Return a literal (`|`) or folded (`>`) block."""
    if not data.strip("\n"):
        return Scalar(scalar(data), scalar(data))
    body = data.removesuffix("\n")
    chomp = "-" if body == data else "+" if body.endswith("\n") else ""
    if raw[0] == "|":
        lines = body.split("\n")
        begin = next(line for line in lines if line)
        # Where the first line is indented itself, YAML needs the indentation stated.
        step = "2" if begin[0] in " \t" else ""
        return Scalar(f"|{step}{chomp}", None, tuple(lines))
    header, *lines = _LINE_END.split(raw)
    if re.match(r">[-+]?[0-9]", header):
        raise KeptAsIs("a folded text states its indentation")
    if chomp == "+":
        # The last line end is that of the last line.
        lines = lines[:-1] if not lines[-1] else lines
    else:
        while not lines[-1].strip(" "):
            lines.pop()
    begin = next(line for line in lines if line.strip(" "))
    depth = len(begin) - len(begin.lstrip(" "))
    return Scalar(f">{chomp}", None, tuple(line[depth:] for line in lines))
