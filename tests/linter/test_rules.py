"""The rules of play on files of their own, and details of single rules."""

from __future__ import annotations

from pathlib import Path
from unittest.mock import patch

import pytest
from support.combinations import swept
from support.places import GALLERY_FOLDER
from support.reports import GOOD, LINT_BAD, LINT_GOOD, RULES, each_rule, lint_report, linted

from babyrobot_levels.library.level import load_file
from babyrobot_levels.library.search_path import yaml_files
from babyrobot_levels.linter.rule import Rule
from babyrobot_levels.linter.rules import all_rules, select, walls
from babyrobot_levels.linter.runner import apply, fix, is_note, lint_source
from babyrobot_levels.text.diagnostics import Diagnostic
from babyrobot_levels.text.files import read_source
from babyrobot_levels.text.source import SourceFile

DEFAULT = select(None)
PLAY = [rule for rule in all_rules() if rule.code.startswith("BR5") and rule.check is not None]


def found(text: str, *rules: str) -> list[Diagnostic]:
    return lint_source(SourceFile("x.yaml", text), select(rules)).diagnostics


def of(rule: Rule, paths: list[Path]) -> list[Path]:
    return [path for path in paths if path.parent.name == rule.name]


@pytest.mark.parametrize("rule", each_rule(PLAY), ids=lambda rule: rule.name)
def test_a_rule_reports_its_bad_files_as_expected_and_no_good_ones(rule: Rule) -> None:
    """`python scripts/renew.py tests/linter` writes the expectations."""
    assert of(rule, LINT_BAD)
    assert of(rule, LINT_GOOD)
    for path in of(rule, LINT_BAD):
        assert lint_report(path) == path.with_suffix(".txt").read_text(encoding="utf-8")
        assert {each.code for each in linted(path)} == {rule.code}
    for path in of(rule, LINT_GOOD):
        assert [str(each) for each in linted(path)] == []


def test_every_file_belongs_to_a_rule() -> None:
    reports = {path.with_suffix(".txt") for path in LINT_BAD}
    files = {path for path in RULES.rglob("*") if path.is_file()}
    assert files == {*LINT_BAD, *LINT_GOOD, *reports}
    assert {path.parent.name for path in files} == {rule.name for rule in PLAY}


@pytest.mark.slow
@pytest.mark.parametrize("rule", swept(PLAY[::3], PLAY), ids=lambda rule: rule.name)
def test_no_safe_fix_changes_the_mdp(rule: Rule) -> None:
    for path in of(rule, LINT_BAD):
        check_fixes(path)


@pytest.mark.sweep
def test_no_safe_fix_of_a_level_with_everything_changes_the_mdp() -> None:
    for path in GOOD:
        check_fixes(path)


def check_fixes(path: Path) -> None:
    """Apply each fix by itself, and all safe fixes of all rules together."""
    source = read_source(path, path.name)
    before = lint_source(source, all_rules())
    assert before.is_valid
    for each in before.diagnostics:
        if each.fix is not None:
            text = apply(each.fix.edits, source)
            after = lint_source(SourceFile(path.name, text), [])
            assert after.is_valid
            assert not each.fix.safe or after.digest == before.digest
    fixed = fix(source, all_rules())
    assert fixed.report.is_valid
    assert fixed.report.digest == before.digest
    assert not [each for each in fixed.report.diagnostics if each.fix and each.fix.safe]


def test_the_levels_of_the_gallery_state_what_they_are_meant_to_be() -> None:
    files = [path for path in yaml_files(GALLERY_FOLDER) if path.parent.name != "suites"]
    stated = {path.stem: load_file(path).expect for path in files}
    # Of a maze that is another one each time nothing can be stated.
    assert {name for name, facts in stated.items() if facts is None} == {"random-maze"}
    assert all(2 <= len(facts.stated) <= 6 for facts in stated.values() if facts is not None)


@pytest.mark.slow
def test_the_gallery_has_no_findings() -> None:
    for path in GALLERY_FOLDER.rglob("*.yaml"):
        report = lint_source(read_source(path, path.name), all_rules(), path)
        assert [str(each) for each in report.diagnostics] == []


# -- unreachable-cells -------------------------------------------------------------------------


def test_cells_of_a_maze_behind_the_exit_are_a_note() -> None:
    """The default exit cuts off cells in most plain mazes."""
    notes = [
        each
        for seed in range(30)
        for each in found(f"version: 1\nsize: [8, 5]\nmaze: {{seed: {seed}}}\n", "BR5")
    ]
    assert len(notes) > 15
    assert {(each.code, each.severity) for each in notes} == {("BR502", "info")}
    assert all(map(is_note, notes))
    assert all(each.help and "the episode ends on [7, 4]" in each.help for each in notes)


@pytest.mark.parametrize(
    ("more", "severity"),
    [
        ("", "info"),
        ("puddles: [{at: [0, 0]}]", "info"),
        ("areas: [{at: [0, 0], size: [5, 1], color: gold}]", "info"),
        ("puddles: [{at: [4, 0]}]", "warning"),
        ("warps: [{at: [4, 0], to: start, when: leave}]", "warning"),
        ("areas: [{at: [4, 0], size: [1, 1], color: gold}]", "warning"),
        # Not only behind the exit.
        ("walls: [{at: [4, 0], side: W}]", "warning"),
    ],
)
def test_it_is_a_note_only_if_nothing_else_is_affected(more: str, severity: str) -> None:
    maze = "version: 1\nsize: [5, 1]\nmaze: {seed: 1}\nexit: [2, 0]\n"
    assert [each.severity for each in found(f"{maze}{more}\n", "BR502")] == [severity]


def test_it_is_a_warning_without_a_maze() -> None:
    (found_here,) = found("version: 1\nsize: [5, 1]\nexit: [2, 0]\n", "BR502")
    assert found_here.severity == "warning"
    assert not is_note(found_here)


def test_findings_of_style_are_no_notes() -> None:
    (empty,) = found("version: 1\nwalls: []\n", "BR609")
    assert empty.severity == "info"
    assert not is_note(empty)


def test_the_help_beside_a_drawing_can_be_followed() -> None:
    drawing = (
        "version: 1\nmap: |\n"
        "  +---+---+---+\n  | S     |{}|\n  +   +   +---+\n  |         E |\n  +---+---+---+\n"
    )
    (found_here,) = found(drawing.format("   "), "BR502")
    assert found_here.help == "open a path, or draw cells that are not part of the level as `###`"
    assert found(drawing.format("###"), "ALL", "BR502") == found(drawing.format("###"), "BR6")


# -- other rules -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("cells", "merged"),
    [
        ("{at: [1, 2], size: [2, 1]}, {at: [1, 3], size: [2, 2]}", "2x3"),
        ("{at: [1, 2]}, {at: [1, 3]}, {at: [1, 4]}, {at: [4, 5]}", "1x3"),
        ("{at: [1, 2], size: [2, 1]}, {at: [1, 3]}", None),
    ],
)
def test_cells_that_fill_a_rectangle_can_be_one_entry(cells: str, merged: str | None) -> None:
    told = [
        each.message for each in found(f"version: 1\nsize: [6, 6]\nblocked: [{cells}]\n", "BR606")
    ]
    assert [f" {merged} " in each for each in told] == ([] if merged is None else [True])


def test_an_infinite_return_is_reported_as_such() -> None:
    text = "version: 1\nareas:\n  - {{at: [1, 1], reward: 5}}\ndiscount: {}\n"
    (infinite,) = found(text.format(1.0), "BR504")
    (finite,) = found(text.format(0.99), "BR504")
    assert infinite.message.endswith("gives an infinite return")
    assert finite.message.endswith("is worth more than ending it")


@pytest.mark.parametrize(("loops", "passages"), [(0.2, 16), (1, 19)])
def test_a_maze_with_loops_is_not_built_a_second_time(loops: float, passages: int) -> None:
    """A tree of 16 cells has 15 passages."""
    text = f"version: 1\nsize: [4, 4]\nmaze: {{seed: 3, loops: {loops}}}\n"
    report = lint_source(SourceFile("x.yaml", text), [])
    assert report.level is not None
    assert int.from_bytes(report.level.grid().open_bits).bit_count() // 2 == passages
    with patch.object(walls, "build_grid", side_effect=AssertionError):
        assert found(text, "BR526") == []


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["version"], None),
        (["version", "title"], None),
        (["version", "title", "size", "exit"], None),
        (["title", "version"], "`version` should come before `title`"),
        (["version", "size", "title"], "`title` should come before `size`"),
        (["version", "exit", "start"], "`start` should come before `exit`"),
        (["version", "exit", "size", "title"], "`size` should come before `exit`"),
    ],
)
def test_the_first_field_out_of_order_is_reported(names: list[str], message: str | None) -> None:
    values = {"version": "1", "title": "x", "size": "[3, 3]", "start": "[0, 0]", "exit": "[2, 2]"}
    text = "".join(f"{name}: {values[name]}\n" for name in names)
    assert [each.message for each in found(text, "BR604")] == ([message] if message else [])


# -- expectations ------------------------------------------------------------------------------

EXPECTING = "version: 1\nsize: [4, 1]\nexpect:\n  path_length: 3\n  lint: clean\n"


def told(text: str) -> list[tuple[str, int]]:
    return [
        (each.code, each.line)
        for each in lint_source(SourceFile("x.yaml", text), DEFAULT).diagnostics
    ]


def test_a_level_without_other_findings_is_clean() -> None:
    assert told(EXPECTING) == []
    # Notes do not count.
    assert told("version: 1\nsize: [6, 6]\nmaze: {seed: 1}\nexpect: {lint: clean}\n") == [
        ("BR502", 3)
    ]


@pytest.mark.parametrize(
    ("field", "code"), [("walls: []", "BR609"), ("max_steps: 2", "BR511"), ("skid: 0.0", "BR522")]
)
def test_findings_of_other_rules_are_told_where_none_are_expected(field: str, code: str) -> None:
    assert told(f"{EXPECTING}{field}\n")[:1] == [("BR540", 5)]
    assert code in {each for each, _ in told(f"{EXPECTING}{field}\n")}


def test_another_broken_fact_is_told_once() -> None:
    assert told(EXPECTING.replace("3", "2")) == [("BR540", 4)]


def test_broken_facts_can_be_ignored() -> None:
    text = EXPECTING.replace("3", "2  # babyrobot: ignore[broken-expectation] later")
    assert told(text) == []
    assert told(text.replace("2  #", "3  #")) == [("BR699", 4), ("BR540", 5)]


def test_fixes_are_applied_beside_broken_facts() -> None:
    fixed = fix(SourceFile("x.yaml", f"{EXPECTING.replace('3', '2')}walls: []\n"), DEFAULT)
    assert fixed.text == EXPECTING.replace("3", "2")


def test_facts_of_the_largest_levels_are_told_not_to_be_checked() -> None:
    large = EXPECTING.replace("[4, 1]", "[1024, 1024]\nskid: 0.2")
    assert told(large) == [("BR539", 2), ("BR540", 4)]
