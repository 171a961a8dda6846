"""YAML and Python as HTML, with what a text consists of in spans of classes.

The classes are the first letters of key, text, number, word (of the language), mark and comment.
What they leave out is punctuation and names. Only the look depends on them: a text that is split
wrongly is still there, character by character.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

from babyrobot_levels.render.svg import escaped
from babyrobot_levels.render.templates import as_html

if TYPE_CHECKING:
    from markupsafe import Markup

_STRINGS = r'"(?:[^"\\\n]|\\.)*"|\'(?:[^\'\n]|\'\')*\''
_NUMBER = r"[-+]?(?:\d[\d_]*(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?(?![\w.-])"

_YAML = re.compile(
    rf"""
    (?P<comment>(?:^|(?<=[ \t]))\#.*)
    | (?P<key>(?:{_STRINGS}|[\w$][\w$.\ -]*?)(?=[ \t]*:(?:[ \t]|$)))
    | (?P<text>{_STRINGS})
    | (?P<mark>[&*!][\w!/.-]+)
    | (?P<number>(?<![\w.-]){_NUMBER})
    | (?P<word>\b(?:true|false|null)\b)
    | [\w.-]+
    """,
    re.VERBOSE,
)

_BLOCK = re.compile(r"(?:^|[:\-])[ \t]*[|>][-+1-9]*[ \t]*(?:#.*)?$")
"""The end of a line after which the text of a block follows."""

_PYTHON = re.compile(
    rf"""
    (?P<comment>\#.*)
    | (?P<text>{_STRINGS})
    | (?P<number>(?<!\w){_NUMBER})
    | (?P<word>\b(?:import|as|from|for|in|while|not|and|or|if|else|True|False|None)\b)
    | \w+
    """,
    re.VERBOSE,
)


def yaml_html(text: str) -> Markup:
    """Return a YAML text as HTML."""
    return as_html("\n".join(_yaml_lines(text)))


def python_html(text: str) -> Markup:
    """Return a Python text, whose strings end on their lines, as HTML."""
    return as_html("\n".join(_line(line, _PYTHON) for line in text.split("\n")))


def _yaml_lines(text: str) -> Iterator[str]:
    """Yield the lines of a YAML text; those of a block are a text, whatever is in them."""
    outside: int | None = None
    for line in text.split("\n"):
        depth = len(line) - len(line.lstrip(" "))
        if outside is not None and (not line.strip() or depth > outside):
            yield _span("text", line) if line.strip() else line
            continue
        outside = depth if _BLOCK.search(line) else None
        yield _line(line, _YAML)


def _line(line: str, tokens: re.Pattern[str]) -> str:
    parts, at = [], 0
    for found in tokens.finditer(line):
        parts.append(escaped(line[at : found.start()]))
        kind, at = found.lastgroup, found.end()
        parts.append(_span(kind, found[0]) if kind else escaped(found[0]))
    return "".join([*parts, escaped(line[at:])])


def _span(kind: str, text: str) -> str:
    return f'<span class="{kind[0]}">{escaped(text)}</span>'
