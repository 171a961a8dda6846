"""Findings in machine-readable formats. The command line has the format for people."""

import hashlib
import json
import os
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal
from urllib.parse import quote
from xml.sax.saxutils import escape

from babyrobot_levels.text.diagnostics import Diagnostic, Fix, Severity, one_line
from babyrobot_levels.text.source import Span

MachineFormat = Literal["json", "github", "sarif", "junit"]
"""The machine-readable formats."""

JSON_VERSION = 1
"""The version of the JSON format; it changes with every incompatible change."""


def render(
    form: MachineFormat,
    diagnostics: Iterable[Diagnostic],
    files: Iterable[str],
    titles: Mapping[str, str],
    version: str,
) -> str:
    """Return findings in a machine-readable format.

    Args:
        form: the format.
        diagnostics: the findings.
        files: the files that were checked, named as in the findings.
        titles: a short description of each code; codes without one are allowed.
        version: the version of this package.
    """
    if form == "json":
        data = {"version": JSON_VERSION, "diagnostics": [each.to_dict() for each in diagnostics]}
        return json.dumps(data, indent=2) + "\n"
    if form == "github":
        return _github(diagnostics, titles)
    if form == "sarif":
        return _sarif(diagnostics, titles, version)
    return _junit(diagnostics, files)


# -- GitHub Actions --------------------------------------------------------------------------


_COMMANDS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFO: "notice"}


def _github(diagnostics: Iterable[Diagnostic], titles: Mapping[str, str]) -> str:
    """Return workflow commands, which GitHub Actions shows as annotations, one for each finding.

    A line is `::error file=…,line=…,col=…,endLine=…,endColumn=…,title=…::message`.
    """
    return "".join(_command(diagnostic, titles) for diagnostic in diagnostics)


def _command(diagnostic: Diagnostic, titles: Mapping[str, str]) -> str:
    code, title = diagnostic.code, titles.get(diagnostic.code)
    places: dict[str, object] = {"line": diagnostic.line, "endLine": diagnostic.end.line}
    if diagnostic.end.line == diagnostic.line:
        # GitHub accepts columns only if the span is on one line.
        places |= {"col": diagnostic.column, "endColumn": diagnostic.end.column}
    properties = {
        "file": one_line(Path(diagnostic.file).as_posix()),
        **places,
        "title": one_line(f"{code}: {title}" if title else code),
    }
    message = one_line(diagnostic.message)
    if diagnostic.help:
        message += f"\nhelp: {one_line(diagnostic.help)}"
    listed = ",".join(f"{name}={_property(str(value))}" for name, value in properties.items())
    return f"::{_COMMANDS[diagnostic.severity]} {listed}::{_escaped(message)}\n"


def _escaped(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _escaped(text).replace(":", "%3A").replace(",", "%2C")


# -- JUnit -----------------------------------------------------------------------------------


def _junit(diagnostics: Iterable[Diagnostic], files: Iterable[str]) -> str:
    """Return JUnit XML, which continuous integration services show as tests, one for each file.

    Files without findings are tests that passed.
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
    name = Path(file).as_posix()
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


# -- SARIF -----------------------------------------------------------------------------------


SCHEMA = (
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
)
FINGERPRINT = "babyrobotFinding/v1"
"""The name of the fingerprint; its number changes when the computation changes."""

_SARIF_LEVELS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFO: "note"}


def _sarif(diagnostics: Iterable[Diagnostic], titles: Mapping[str, str], version: str) -> str:
    """Return SARIF 2.1.0, the format of code scanning services and of many editors, indented."""
    found = list(diagnostics)
    severities = {diagnostic.code: diagnostic.severity for diagnostic in reversed(found)}
    codes = sorted(severities)
    driver = {
        "name": "babyrobot",
        "version": version,
        "rules": [_rule(code, severities[code], titles.get(code)) for code in codes],
    }
    seen: Counter[tuple[str, ...]] = Counter()
    run = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        "newlineSequences": ["\r\n", "\n", "\r"],
        "results": [
            _result(diagnostic, codes.index(diagnostic.code), seen) for diagnostic in found
        ],
    }
    return json.dumps({"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}, indent=2) + "\n"


def _rule(code: str, severity: Severity, title: str | None) -> dict[str, Any]:
    rule: dict[str, Any] = {"id": code, "defaultConfiguration": {"level": _SARIF_LEVELS[severity]}}
    if title:
        rule["shortDescription"] = {"text": title}
    return rule


def _result(diagnostic: Diagnostic, index: int, seen: Counter[tuple[str, ...]]) -> dict[str, Any]:
    text = one_line(diagnostic.message)
    if diagnostic.help:
        text += f"\nhelp: {one_line(diagnostic.help)}"
    location = {"artifactLocation": _artifact(diagnostic.file), "region": _region(diagnostic.span)}
    result = {
        "ruleId": diagnostic.code,
        "ruleIndex": index,
        "level": _SARIF_LEVELS[diagnostic.severity],
        # Brackets before parentheses would become a link, and the text is untrusted.
        "message": {"text": text.replace("](", "] (")},
        "locations": [{"physicalLocation": location}],
        "partialFingerprints": {FINGERPRINT: _fingerprint(diagnostic, seen)},
    }
    if diagnostic.fix is not None:
        result["fixes"] = [_fix(diagnostic.file, diagnostic.fix)]
    return result


def _fix(file: str, fix: Fix) -> dict[str, Any]:
    replacements = [
        {"deletedRegion": _region(edit.span), "insertedContent": {"text": edit.text}}
        for edit in fix.edits
    ]
    return {
        "description": {"text": one_line(fix.message)},
        "artifactChanges": [{"artifactLocation": _artifact(file), "replacements": replacements}],
    }


def _region(span: Span) -> dict[str, int]:
    return {
        "startLine": span.start.line,
        "startColumn": span.start.column,
        "endLine": span.end.line,
        "endColumn": span.end.column,
    }


def _artifact(file: str) -> dict[str, str]:
    path = Path(file)
    if path.is_absolute():
        return {"uri": path.as_uri()}
    return {"uri": quote(os.fsencode(path.as_posix())), "uriBaseId": "%SRCROOT%"}


def _fingerprint(diagnostic: Diagnostic, seen: Counter[tuple[str, ...]]) -> str:
    """Return a hash of file, code and source line, which stays the same when lines move."""
    source = diagnostic.source
    line = source.line(diagnostic.line).strip() if source is not None else ""
    key = (Path(diagnostic.file).as_posix(), diagnostic.code, line)
    seen[key] += 1
    whole = "\0".join([*key, str(seen[key])])
    return hashlib.sha256(whole.encode("utf-8", "surrogatepass")).hexdigest()[:32]
