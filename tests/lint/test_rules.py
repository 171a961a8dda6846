"""The rules of play, each on files of its own: some beside what is told of them, and good ones."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.places import GALLERY_FOLDER
from support.reports import GOOD, LINT_BAD, LINT_GOOD, RULES, lint_report, linted

from babyrobot_levels.lint.fixer import apply, fix
from babyrobot_levels.lint.registry import all_rules
from babyrobot_levels.lint.runner import lint_source
from babyrobot_levels.text.files import read_source

PLAY = [rule for rule in all_rules() if rule.code < "BR6" and rule.check is not None]
GALLERY = sorted(GALLERY_FOLDER.rglob("*.yaml"))


def name(path: Path) -> str:
    return f"{path.parent.name}/{path.stem}"


@pytest.mark.parametrize("path", LINT_BAD, ids=name)
def test_bad_files_are_told_of_as_expected(path: Path) -> None:
    """`renew_reports.py` writes the expectations anew."""
    assert lint_report(path) == path.with_suffix(".txt").read_text(encoding="utf-8")
    assert {each.code for each in linted(path)} == {code_of(path)}


@pytest.mark.parametrize("path", LINT_GOOD, ids=name)
def test_nothing_is_told_of_good_files(path: Path) -> None:
    assert [str(each) for each in linted(path)] == []


def code_of(path: Path) -> str:
    return next(rule.code for rule in all_rules() if rule.name == path.parent.name)


def test_each_rule_of_play_has_bad_files_and_good_ones() -> None:
    for files in (LINT_BAD, LINT_GOOD):
        assert {path.parent.name for path in files} >= {rule.name for rule in PLAY}


def test_every_file_is_good_or_bad() -> None:
    reports = {path.with_suffix(".txt") for path in LINT_BAD}
    assert {path for path in RULES.rglob("*") if path.is_file()} == {
        *LINT_BAD,
        *LINT_GOOD,
        *reports,
    }


@pytest.mark.parametrize("path", [*LINT_BAD, *LINT_GOOD, *GOOD, *GALLERY], ids=name)
def test_no_safe_fix_changes_the_game(path: Path) -> None:
    """Each by itself, and all of all rules together."""
    source = read_source(path, path.name)
    before = lint_source(source, all_rules())
    assert before.is_valid
    for each in before.diagnostics:
        if each.fix is not None:
            text = apply(each.fix.edits, source)
            after = lint_source(type(source)(path.name, text), [])
            assert after.is_valid
            assert not each.fix.safe or after.digest == before.digest
    fixed = fix(source, all_rules())
    assert fixed.report.is_valid
    assert fixed.report.digest == before.digest
    assert not [each for each in fixed.report.diagnostics if each.fix and each.fix.safe]


@pytest.mark.parametrize("path", GALLERY, ids=name)
def test_the_gallery_is_clean(path: Path) -> None:
    report = lint_source(read_source(path, path.name), all_rules(), path)
    assert [str(each) for each in report.diagnostics] == []
