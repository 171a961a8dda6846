"""Findings as JUnit XML, which continuous integration services show as tests, one per file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import PurePath
from xml.sax.saxutils import escape

from babyrobot_levels.text.diagnostics import Diagnostic, Severity, one_line


def render(diagnostics: Iterable[Diagnostic], files: Iterable[str]) -> str:
    """Return the findings as one test suite.

    Args:
        diagnostics: the findings.
        files: the files that were checked. Files without findings are tests that passed.
    """
    found: dict[str, list[Diagnostic]] = {file: [] for file in files}
    for diagnostic in diagnostics:
        found.setdefault(diagnostic.file, []).append(diagnostic)
    failures = sum(map(bool, found.values()))
    counts = f'name="babyrobot" tests="{len(found)}" failures="{failures}" errors="0"'
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f"<testsuites {counts}>",
        f'  <testsuite {counts} skipped="0" time="0">',
        *(_case(file, diagnostics) for file, diagnostics in found.items()),
        "  </testsuite>",
        "</testsuites>",
    ]
    return "\n".join(lines) + "\n"


def _case(file: str, found: Sequence[Diagnostic]) -> str:
    name = PurePath(file).as_posix()
    head = f'    <testcase name="{_attribute(name)}" classname="babyrobot" time="0"'
    if not found:
        return f"{head}/>"
    # One failure for all findings of a file, because many readers show only the first.
    first = f"{found[0].code}: {found[0].message}"
    message = first if len(found) == 1 else f"{first} (and {len(found) - 1} more)"
    severities = {diagnostic.severity for diagnostic in found}
    worst = next(severity for severity in Severity if severity in severities)
    text = "\n\n".join(map(str, found))
    return (
        f'{head}>\n      <failure message="{_attribute(message)}" type="{worst}">'
        f"{escape(text)}</failure>\n    </testcase>"
    )


def _attribute(text: str) -> str:
    # XML can contain one line of printable characters.
    return escape(one_line(text), {'"': "&quot;"})
