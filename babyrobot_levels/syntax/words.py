"""The YAML parser's complaints in the words of people who write levels."""

from __future__ import annotations


def plain_words(problem: str, context: str | None, line: str) -> tuple[str, str | None]:
    """Say a parser's complaint as a person would, with what to do about it."""
    if "\t" in line and ("token" in problem or "indentation" in problem):
        return "a tab cannot indent YAML", "indent with spaces"
    if "mapping values are not allowed" in problem:
        return (
            "a `:` cannot stand here",
            "check the indentation, or put quotes around a text that holds `: `",
        )
    if "could not find expected ':'" in problem:
        return "a field's name must be followed by `:` and a value", None
    if "',' or ']'" in problem:
        return "a `[` is not closed, or a `,` is missing", "close the list with `]`"
    if "',' or '}'" in problem:
        return "a `{` is not closed, or a `,` is missing", "close the mapping with `}`"
    if "block end" in problem or "block mapping" in (context or ""):
        return (
            f"this line does not fit the indentation above it ({problem})",
            "fields of one mapping begin in one column",
        )
    return f"this is not YAML: {problem}" + (f" {context}" if context else ""), None
