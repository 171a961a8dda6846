"""Findings as workflow commands, which GitHub Actions shows as annotations.

One line per finding: `::error file=…,line=…,col=…,endLine=…,endColumn=…,title=…::message`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import PurePath

from babyrobot_levels.text.diagnostics import Diagnostic, Severity, one_line

_COMMANDS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFO: "notice"}


def render(diagnostics: Iterable[Diagnostic], titles: Mapping[str, str]) -> str:
    """Return one workflow command for each finding.

    Args:
        diagnostics: the findings.
        titles: a short description of each code.
    """
    return "".join(_command(diagnostic, titles) for diagnostic in diagnostics)


def _command(diagnostic: Diagnostic, titles: Mapping[str, str]) -> str:
    code, title = diagnostic.code, titles.get(diagnostic.code)
    places: dict[str, object] = {"line": diagnostic.line, "endLine": diagnostic.end.line}
    if diagnostic.end.line == diagnostic.line:
        # GitHub accepts columns only if the span is on one line.
        places |= {"col": diagnostic.column, "endColumn": diagnostic.end.column}
    properties = {
        "file": one_line(PurePath(diagnostic.file).as_posix()),
        **places,
        "title": one_line(f"{code}: {title}" if title else code),
    }
    message = one_line(diagnostic.message)
    if diagnostic.help:
        message += f"\nhelp: {one_line(diagnostic.help)}"
    listed = ",".join(f"{name}={_property(str(value))}" for name, value in properties.items())
    return f"::{_COMMANDS[diagnostic.severity]} {listed}::{_data(message)}\n"


def _data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")
