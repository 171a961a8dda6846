"""JUnit XML, read back by an XML parser."""

from __future__ import annotations

from xml.etree import ElementTree as Xml

from hypothesis import given
from hypothesis import strategies as st
from support.findings import HOSTILE, MADE_UP, REAL, finding

from babyrobot_levels.linter.reporters import render
from babyrobot_levels.text.diagnostics import Diagnostic, Severity, one_line


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
    assert failure.attrib == {
        "message": "BR601: it could be shorter (and 1 more)",
        "type": "error",
    }
    assert failure.text == f"{first}\n\n{second}"
    (alone,) = suite([first], [])[0]
    assert alone.attrib == {"message": "BR601: it could be shorter", "type": "warning"}


def test_findings_in_other_files_are_included() -> None:
    """A level's theme has faults of its own, in another file."""
    inner = suite([finding(file="themes/mine.yaml")], ["one.yaml"])
    assert [case.attrib["name"] for case in inner] == ["one.yaml", "themes/mine.yaml"]


def test_every_file_with_findings_fails() -> None:
    files = list(dict.fromkeys(diagnostic.file for diagnostic in [*REAL, *MADE_UP]))
    inner = suite([*REAL, *MADE_UP], files)
    assert [case.attrib["name"] for case in inner] == [one_line(file) for file in files]
    assert all(len(case) == 1 for case in inner)


@given(st.text() | st.just(HOSTILE))
def test_texts_are_escaped(text: str) -> None:
    inner = suite([finding(message=text, file=text, help=text)], [text])
    assert len(inner) == 1
    assert inner[0][0].attrib["message"] == f"BR601: {one_line(text)}"
