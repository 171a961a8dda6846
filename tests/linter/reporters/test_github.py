"""Workflow commands, read as GitHub's runner reads them: split first, then unescaped."""

from __future__ import annotations

import re
from dataclasses import dataclass

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from support.findings import HOSTILE, MADE_UP, REAL, TITLES, finding

from babyrobot_levels.linter.reporters import render
from babyrobot_levels.text.diagnostics import Severity, one_line
from babyrobot_levels.text.source import printable

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
    told = commands(render("github", [*REAL, *MADE_UP], [], TITLES, ""))
    assert len(told) == len(REAL) + len(MADE_UP)
    for command, diagnostic in zip(told, [*REAL, *MADE_UP], strict=True):
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
