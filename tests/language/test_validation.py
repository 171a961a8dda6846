"""Texts to levels or to diagnostics: every code, every place, and nothing else ever."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel
from support.each import for_each
from support.reading import read_level
from support.reports import BAD, GOOD, read, report
from support.work import counted_calls

from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.kinds import LISTED
from babyrobot_levels.language.suite import SuiteFields
from babyrobot_levels.language.suite_list import PackFields, SuiteListFields
from babyrobot_levels.language.validation import parse, validate
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp import configurations
from babyrobot_levels.mdp.compiler import layers
from babyrobot_levels.text.diagnostics import Diagnostic, Severity
from babyrobot_levels.text.source import SourceFile

IN_TEXTS = {
    *(f"BR1{number:02}" for number in (2, 4, 5, 6, 7, 8, 9, 10, 11)),
    *(f"BR2{number:02}" for number in range(1, 10)),
    *(f"BR3{number:02}" for number in range(1, 28)),
    *("BR329", "BR330", "BR401", "BR403", "BR404", "BR405"),
}
"""The codes that what a file holds can have."""


def diagnose(text: str) -> list[Diagnostic]:
    return parse(SourceFile("x.yaml", text), Level)[1]


def told(text: str) -> list[tuple[str, int, int]]:
    """Return code, line and column of all that is said about the fields below a `version: 1`."""
    return [(d.code, d.line, d.column) for d in diagnose(f"version: 1\n{text}\n")]


# -- folders of files --------------------------------------------------------------------------


@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.stem)
def test_good_files_load(path: Path) -> None:
    level, diagnostics = read(path)
    assert level is not None, "\n".join(map(str, diagnostics))
    assert not diagnostics


@pytest.mark.parametrize("path", BAD, ids=lambda path: path.stem)
def test_bad_files_are_reported_as_expected(path: Path) -> None:
    """`scripts/renew.py` writes the expectations anew."""
    assert report(path) == path.with_suffix(".txt").read_text(encoding="utf-8")


def test_there_is_a_bad_file_for_every_code() -> None:
    assert len(GOOD) >= 12
    found = {diagnostic.code for path in BAD for diagnostic in read(path)[1]}
    assert found == IN_TEXTS


def test_every_report_belongs_to_a_file() -> None:
    folder = BAD[0].parent
    assert {path.stem for path in folder.glob("*.txt")} == {path.stem for path in BAD}


@for_each("path", BAD)
def test_every_place_is_in_the_file(path: Path) -> None:
    for found in read(path)[1]:
        assert found.severity is Severity.ERROR
        assert found.file == path.name
        assert (found.line, found.column) < found.end or found.end == (found.line, found.column)
        if found.source is not None:
            lines = found.source.lines
            assert 1 <= found.line <= len(lines)
            assert 1 <= found.column <= len(lines[found.line - 1]) + 1
            assert found.end.line <= len(lines)
            if found.source.text.strip():
                assert found.excerpt() is not None, "the fault is shown where there is a text"


@for_each("path", BAD)
def test_messages_are_plain_sentences(path: Path) -> None:
    for found in read(path)[1]:
        assert not re.search(r"form:|\[key\]|pydantic|tuple|dict|str_|Input should", str(found))
        assert not found.message.endswith(".")
        assert found.message.strip() == found.message
        assert "\n" not in found.message


# -- places ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        # An unknown field is shown at its key, a wrong value at the value.
        ("sise: [3, 3]", [("BR201", 2, 1)]),
        ("walls: [{at: [0, 0], side: E, pas: 1}]", [("BR201", 2, 31)]),
        ("legend: {x: {rewrad: 1}}\nmap: |\n  +---+\n  | S |\n  +---+", [("BR201", 2, 14)]),
        ("size: [3, x]", [("BR203", 2, 11)]),
        ("walls:\n- at: [0, 0]\n  side: Q", [("BR204", 4, 9)]),
        ("skid: {probability: 2}", [("BR205", 2, 21)]),
        ("areas: [{at: [0, 0], skid: {probability: 0.5, to: up}}]", [("BR204", 2, 51)]),
        ("theme: {colors: {base: rde}}", [("BR403", 2, 24)]),
        ("display: {side_panel: {width: wide}}", [("BR203", 2, 31)]),
        # A missing field at the mapping that lacks it.
        ("walls: [{side: E}]", [("BR202", 2, 9)]),
        ("maze: {loops: 1}", [("BR202", 2, 7)]),
        # A key of the legend at the key.
        ("legend: {ab: {}}\nmap: |\n  +---+\n  | S |\n  +---+", [("BR207", 2, 10)]),
        ("legend:\n  '#': {}\nmap: |\n  +---+\n  | S |\n  +---+", [("BR207", 3, 3)]),
        # What is left out, at what makes it wrong.
        ("exit: [0, 0]", [("BR303", 2, 7)]),
        ("start: [2, 2]", [("BR303", 2, 8)]),
        ("warps: [{at: [0, 0], to: [1, 1]}]", [("BR309", 2, 14)]),
        # The whole of a list entry, or the part of it that is wrong.
        ("areas: [{at: [0, 0]}, {at: [2, 2], size: [1, 2]}]", [("BR301", 2, 23)]),
        ("walls: [{at: [0, 0], side: E, length: 4}]", [("BR301", 2, 39)]),
        ("start: [[0, 0], [1, 0], [0, 0]]", [("BR305", 2, 25)]),
        ("wind: {north: [1, 2]}", [("BR315", 2, 15)]),
        ("start_weights: [1, 2]", [("BR329", 2, 16)]),
    ],
)
def test_places(text: str, expected: list[tuple[str, int, int]]) -> None:
    assert told(text) == expected


def test_too_many_states_are_told_at_the_legend_that_has_most_of_the_things(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(configurations, "MAX_STATES", 3)
    text = "version: 1\nmap: |\n  +---+---+\n  | S   a |\n  +---+---+\nlegend: {a: {item: a}}\n"
    assert read_level(SourceFile("x.yaml", text))[1] == []
    monkeypatch.setattr(layers, "MAX_STATES", 3)
    (found,) = read_level(SourceFile("x.yaml", text))[1]
    assert (found.code, found.line, found.column) == ("BR404", 6, 1)


MAP = """\
map: |
  +---+---+---+
  | S | x   E |
  +---+---+---+
legend: {x: {reward: 1}}
"""


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("areas: [{at: [0, 0]}, {at: [7, 7]}]", [("BR301", 7, 28)]),
        ("walls: [{at: [0, 0], side: E}, {at: [5, 5], side: N}]", [("BR301", 7, 37)]),
        ("walls: [{at: [0, 0], side: E, length: 2}]", [("BR301", 7, 39)]),
        ("areas: [{at: [7, 7]}, 5]", [("BR301", 7, 14), ("BR203", 7, 23)]),
        ("walls: [{at: [5, 5], side: N}]\nareas: [5]", [("BR301", 7, 14), ("BR203", 8, 8)]),
        (
            "walls: [{at: [0, 0], side: Q}, {at: [5, 5], side: N}]",
            [("BR204", 7, 28), ("BR301", 7, 37)],
        ),
    ],
)
def test_entries_beside_a_drawing_are_counted_as_the_file_counts_them(
    text: str, expected: list[tuple[str, int, int]]
) -> None:
    assert told(MAP + text) == expected


def test_a_fault_of_one_entry_does_not_hide_those_of_the_others() -> None:
    text = """\
areas:
  - {at: [8, 8]}
  - 7
  - {at: [9, 9], reward: much}
  - {at: [9, 9]}
puddles:
  - {at: [1, 1], size: huge}
  - {at: [1, 1]}
  - {at: [1, 1]}"""
    assert told(text) == [
        ("BR301", 3, 10),
        ("BR203", 4, 5),
        ("BR203", 5, 26),
        ("BR301", 6, 10),
        ("BR204", 8, 24),
        ("BR307", 10, 10),
    ]


def test_equal_entries_are_told_apart() -> None:
    walls = "walls:\n  - 5\n" + "  - {at: [9, 9], side: N}\n" * 3
    assert told(walls) == [("BR203", 3, 5), *[("BR301", line, 10) for line in (4, 5, 6)]]


def test_a_missing_version_does_not_hide_other_faults() -> None:
    found = diagnose("size: [3, 3]\nopenings: [{at: [0, 0], side: N}]\n")
    assert [d.code for d in found] == ["BR202", "BR310"]


@pytest.mark.parametrize(
    ("text", "code"),
    [
        (f"max_steps: {'9' * 5000}", "BR111"),
        ("skid: !!float half", "BR107"),
        ("robots: [{name: a, start: [0, 0]}, {name: b, start: [-1, 0]}]", "BR205"),
    ],
)
def test_one_fault_is_told_once(text: str, code: str) -> None:
    assert [found[0] for found in told(text)] == [code]


@pytest.mark.parametrize(
    "version", ["2", "0", "true", "'1'", "1.5", "", "[1]", "{}", "one", ".nan", "-1"]
)
def test_other_versions_are_refused(version: str) -> None:
    (found,) = diagnose(f"version: {version}\n")
    assert (found.code, found.line) == ("BR204", 1)


@pytest.mark.parametrize("version", ["1", "1.0", "0x1", "1e0", "!!int 1"])
def test_version_one_can_be_written_in_many_ways(version: str) -> None:
    assert diagnose(f"version: {version}\n") == []


@pytest.mark.parametrize(
    "text",
    [
        "size: [3.0, 4e0]",
        "rewards: {bump: null, stay: ~, closer: , farther: null}",
        "title:\ndescription: null\nmaze:\nwind:\nskid:\nmap:\nmax_steps:\nname:",
        "walls: [{at: [0, 0], side: west, color: null, width: null}]",
        "warps: [{at: [1, 1], to: start, reward: null}]",
        "areas: [{at: [1, 1], reward: null, skid: null, ends: null, label: null, color: null}]",
        "wind: {north: null}",
        "areas: [{at: [0, 0], color: '#ABCd'}, {at: [0, 0], color: 'rgba( 255,0 , 0, .25 )'}]",
        "areas:\n- at: [0, 0]\n  color: #c10\n    red",
        "start: [[0, 0]]",
        "puddles: []\nwalls: []\ntags: []",
    ],
)
def test_what_may_be_written(text: str) -> None:
    assert told(text) == []


@pytest.mark.parametrize(
    "text",
    [
        "size: null",
        "exit: null",
        "walls: null",
        "rewards: {step: null}",
        "discount: null",
        "puddle_types: {small: null}",
    ],
)
def test_null_is_only_for_fields_that_may_be_none(text: str) -> None:
    assert [code for code, _, _ in told(text)] == ["BR203"]


# -- hints -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("wals: []", "did you mean `walls`?"),
        ("rewards: {steps: 1}", "did you mean `step`?"),
        ("theme: {colors: {bordr: red}}", "did you mean `border`?"),
        (
            "areas: [{at: [0, 0], color: lightgoldenrodyelow}]",
            "did you mean `lightgoldenrodyellow`?",
        ),
        ("skid: {probability: 1, to: side}", "did you mean `sides`?"),
        ("exit:", "`exit: none`"),
        ("display: {compass: yes}", "`true` or `false`"),
        ("legend: {x: {}}", "`map`"),
    ],
)
def test_hints(text: str, hint: str) -> None:
    (found,) = diagnose(f"version: 1\n{text}\n")
    assert hint in f"{found.message} {found.help}"


@pytest.mark.parametrize("field", LevelFields.model_fields)
def test_what_is_told_to_write_is_right(field: str) -> None:
    found = [each for each in diagnose(f"version: 1\n{field}: 5\n") if each.code == "BR203"]
    told = re.fullmatch("write `(.*)`", f"{found[0].help}") if found else None
    if told is None:
        # The number is right, or the message itself says what can stand there.
        assert field not in {kind.field for kind in LISTED}
        return
    text = told[1].replace("[x, y]", "[1, 1]")
    assert text.startswith(f"{field}: ")
    # An exit that is drawn needs a second cell, and a legend its map.
    allowed = {"exit_one_of": ["BR205"], "legend": ["BR206"]}.get(field, [])
    codes = [each.code for each in diagnose(f"version: 1\n{text}\n") if each.code < "BR300"]
    assert codes == allowed


@pytest.mark.parametrize(
    ("name", "meant"),
    [("teleports", "warps"), ("Keys", "items"), ("goal", "exit"), ("portal", "warps")],
)
def test_names_that_others_use_are_understood(name: str, meant: str) -> None:
    (found,) = diagnose(f"version: 1\n{name}: []\n")
    assert found.message == f"unknown field `{name}`; did you mean `{meant}`?"


def test_a_number_is_not_asked_to_be_true_or_false() -> None:
    (found,) = diagnose("version: 1\nskid: yes\n")
    assert "`true`" not in f"{found.help}"


def places(schema: Any, part: Any, *, deep: int = 4) -> Iterator[tuple[str | int, ...]]:
    """Yield the ways to all places of a schema in which a value may stand."""
    if "$ref" in part:
        part = schema["$defs"][part["$ref"].rpartition("/")[2]]
    for other in (*part.get("anyOf", ()), *part.get("oneOf", ())):
        yield from places(schema, other, deep=deep)
    inner: dict[str | int, Any] = {**part.get("properties", {})}
    inner |= {"other": part.get("additionalProperties"), 0: part.get("items")}
    for name, each in inner.items() if deep else ():
        if isinstance(each, dict):
            yield (name,)
            yield from ((name, *way) for way in places(schema, each, deep=deep - 1))


def put(value: Any, way: tuple[str | int, ...]) -> Any:
    """Return a value inside of mappings and lists."""
    for name in reversed(way):
        value = {name: value} if isinstance(name, str) else [value]
    return value


@pytest.mark.slow
@pytest.mark.parametrize("model", [LevelFields, SuiteFields, SuiteListFields, PackFields])
def test_whatever_stands_anywhere_something_is_told(model: type[BaseModel]) -> None:
    schema = model.model_json_schema(mode="validation")
    ways = [*dict.fromkeys(places(schema, schema))]
    assert len(ways) > len(model.model_fields)
    wrong = ["heavy", "80%", -1, 2.5, [], {"a": 1}, [[1, 1]]]
    for way, value in itertools.product(ways, wrong):
        _, issues = validate({"version": 1, **put(value, way)}, model)
        assert all(each.message for each in issues), (way, value)


# -- limits ------------------------------------------------------------------------------------


def many(entry: str, count: int) -> str:
    return f"version: 1\nsize: [9, 9]\n{entry.partition(':')[0]}:\n" + "".join(
        f"  - {entry.partition(':')[2].strip()}\n" for _ in range(count)
    )


@pytest.mark.sweep
@pytest.mark.parametrize(
    "text",
    [
        many("walls: {at: [50, 0], side: N}", 14_000),
        many("walls: {at: [50, 0], side: N}", 14_000) + "  - 5\n",
        many("walls: {at: [0, 0], side: X}", 14_000),
        many("puddles: {at: [1, 1]}", 16_000),
        many("areas: {at: [0, 0], size: [1024, 1024]}", 9_000),
        "version: 1\n" + "".join(f"unknown-{number}: 1\n" for number in range(20_000)),
        "version: 1\nmap: |\n  " + "| ? " * 1024 + "|\n",
        "version: 1\nmap: |\n  "
        + "+---" * 1024
        + "+\n"
        + ("  " + "| ? " * 1024 + "|\n  " + "+-?-" * 1024 + "+\n") * 100,
        "version: 1\nmap: |\n" + "  +---+\n" * 130_000,
    ],
    ids=[
        "off the grid",
        "off the grid and a wrong one",
        "wrong sides",
        "puddles",
        "areas",
        "unknown fields",
        "one line",
        "faults of a drawing",
        "lines",
    ],
)
def test_files_full_of_faults_are_told_quickly(text: str) -> None:
    with counted_calls() as work:
        assert diagnose(text)
    assert work.calls < 5_000_000, work


# -- whatever a file holds ---------------------------------------------------------------------


def test_what_is_missing_at_the_end_of_a_line_takes_no_room() -> None:
    text = "version: 1\nmap: |\n  +---+---+\n  | S   E\n  +---+---+\n"
    (found,) = parse(SourceFile("x.yaml", text), Level).diagnostics
    assert (found.span.start, found.span.end) == ((4, 10), (4, 10))
