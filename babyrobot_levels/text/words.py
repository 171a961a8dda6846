"""The YAML parser's complaints in the words of people who write levels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

SHORT = 40
"""How many characters of a text from a file a message repeats."""


@dataclass(frozen=True, slots=True)
class Words:
    """What to say of a fault, what to do, and whether it is shown where the part begins.

    The parser notices some faults only at the end of the text or a line later; what is not closed
    is better shown where it opens.
    """

    message: str
    help: str | None = None
    at_beginning: bool = False


def plain_words(problem: str, context: str, line: str, column: int) -> Words:
    """Say a parser's complaint as a person would.

    Args:
        problem: what the parser says is wrong.
        context: what it was doing.
        line: the line on which it noticed.
        column: the place in the line, from 1.
    """
    here, before = line[column - 1 : column], line[: column - 1].strip()
    if here == "\t" or ("\t" in line[: column - 1] and not before):
        return Words("a tab cannot indent YAML", "indent with spaces")
    if "mapping values are not allowed" in problem:
        return Words(
            "a `:` cannot stand here",
            "check the indentation, or put quotes around a text that holds `: `",
        )
    if "could not find expected ':'" in problem:
        return Words("a field's name must be followed by `: ` and a value", None, True)
    if "',' or ']'" in problem:
        return Words("this `[` is not closed, or a `,` is missing", "close the list with `]`", True)
    if "',' or '}'" in problem:
        return Words(
            "this `{` is not closed, or a `,` is missing", "close the mapping with `}`", True
        )
    if "unexpected end of stream" in problem and "quoted" in context:
        return Words("this quote is not closed", "end the text with the same quote", True)
    if "unknown escape" in problem:
        return Words(
            f"`\\{line[column : column + 1]}` means nothing between double quotes",
            "write `\\\\` for a backslash, or use single quotes",
        )
    if "cannot start any token" in problem:
        return Words(f"a text cannot begin with `{here}`", "put quotes around it")
    if "document start" in problem:
        return Words("a level file holds one document, and this one has ended above")
    if "expected key" in problem or "'-' indicator" in problem:
        if before and before != "-":
            return Words("the value is complete before this", "put quotes around the whole text")
        return Words(
            "this line does not fit the indentation above it",
            "fields of one mapping, and entries of one list, begin in one column",
        )
    return Words(f"this is not YAML: {problem}" + (f" {context}" if context else ""))


def shortened(value: Any) -> str:
    """Return a text or a number as a message repeats it: on one line, and not too long."""
    text = str(value).replace("\n", " ")
    return text if len(text) <= SHORT else text[: SHORT - 3] + "…"
