"""Diagnostics as SARIF 2.1.0, the format of code scanning services and of many editors."""

from __future__ import annotations

import hashlib
import json
import os
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import PurePath
from typing import Any
from urllib.parse import quote

from babyrobot_levels.text.diagnostics import Diagnostic, Fix, Severity, one_line
from babyrobot_levels.text.source import Span

SCHEMA = (
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
)
FINGERPRINT = "babyrobotFinding/v1"
"""The name of the fingerprint; its number changes when the computation changes."""

_LEVELS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFO: "note"}


def render(diagnostics: Iterable[Diagnostic], titles: Mapping[str, str], version: str) -> str:
    """Return the findings as one run, indented.

    Args:
        diagnostics: the findings.
        titles: a short description of each code.
        version: the version of this package.
    """
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
    rule: dict[str, Any] = {"id": code, "defaultConfiguration": {"level": _LEVELS[severity]}}
    if title:
        rule["shortDescription"] = {"text": title}
    return rule


def _result(diagnostic: Diagnostic, index: int, seen: Counter[tuple[str, ...]]) -> dict[str, Any]:
    text = one_line(diagnostic.message)
    if diagnostic.help:
        text += f"\nhelp: {one_line(diagnostic.help)}"
    location = {
        "artifactLocation": _artifact(diagnostic.file),
        "region": _region(diagnostic.span),
    }
    result = {
        "ruleId": diagnostic.code,
        "ruleIndex": index,
        "level": _LEVELS[diagnostic.severity],
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
    path = PurePath(file)
    if path.is_absolute():
        return {"uri": path.as_uri()}
    return {"uri": quote(os.fsencode(path.as_posix())), "uriBaseId": "%SRCROOT%"}


def _fingerprint(diagnostic: Diagnostic, seen: Counter[tuple[str, ...]]) -> str:
    """Return a hash of file, code and source line, which stays the same when lines move."""
    source = diagnostic.source
    line = source.line(diagnostic.line).strip() if source is not None else ""
    key = (PurePath(diagnostic.file).as_posix(), diagnostic.code, line)
    seen[key] += 1
    whole = "\0".join([*key, str(seen[key])])
    return hashlib.sha256(whole.encode("utf-8", "surrogatepass")).hexdigest()[:32]
