"""Rules, error codes and their pages: names, examples, and the documentation."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from support.reports import each_rule

import babyrobot_levels
from babyrobot_levels.linter.finding import Needs
from babyrobot_levels.linter.rule import Rule
from babyrobot_levels.linter.rules import all_pages, all_rules, documents
from babyrobot_levels.linter.rules.expectations import BROKEN_EXPECTATION
from babyrobot_levels.linter.runner import apply, lint_source
from babyrobot_levels.text.diagnostics import Diagnostic, Fix
from babyrobot_levels.text.source import SourceFile

PACKAGE = Path(babyrobot_levels.__file__).parent
DOCS = PACKAGE.parent / "docs" / "rules"
RULES = all_rules()
PLAY = [rule for rule in RULES if rule.code.startswith("BR5")]
WITHOUT_EXAMPLES = {
    # About bytes, sizes and other files.
    *("BR101", "BR102", "BR103", "BR109", "BR701", "BR702"),
    # About several files and about names of files.
    *("BR515", "BR601", "BR611"),
}
each_page = pytest.mark.parametrize("page", each_rule(all_pages()), ids=lambda page: page.code)


def examples(page: Rule) -> list[str]:
    """Return the bad and the good example of a page."""
    return re.findall(r"```yaml\n(.*?)```", page.page, re.DOTALL)


def lint(page: Rule, text: str) -> list[Diagnostic]:
    """Return what a rule and all rules of play find in a text, for an error its errors."""
    rules = [r for r in RULES if r in (*PLAY, page)] if page in RULES else []
    return lint_source(SourceFile("x.yaml", text), rules).diagnostics


def fixes(page: Rule, text: str) -> list[Fix]:
    return [each.fix for each in lint(page, text) if each.code == page.code and each.fix]


def test_the_documentation_has_these_pages_and_no_others() -> None:
    # `python scripts/renew.py docs/rules` writes them.
    assert {path.name: path.read_text("utf-8") for path in DOCS.iterdir()} == documents()


def test_codes_and_names_are_unique() -> None:
    words = [word for page in all_pages() for word in page.names]
    assert len({*words}) == len(words)


@each_page
def test_a_page_has_its_headings_and_its_examples_are_right(page: Rule) -> None:
    headings = re.findall(r"^## (.*)$", page.page, re.MULTILINE)
    is_error = not page.code.startswith(("BR5", "BR6"))
    first = ["What it means"] if is_error else ["What it does", "Why is this bad?"]
    assert headings[: len(first)] == first
    has_examples = page.code not in WITHOUT_EXAMPLES
    assert len(examples(page)) == (2 if has_examples else 0)
    assert headings[len(first) :][:1] == (["Example"] if has_examples else ["How to fix it"])
    assert not has_examples or re.search(r"^(.* )?Use instead:$", page.page, re.MULTILINE)
    assert re.fullmatch(r"[A-Z`][^\n]{9,98}\.", page.summary)
    assert page.page.startswith("## ")

    for bad, good in [examples(page)] if examples(page) else []:
        codes = {each.code for each in lint(page, bad)}
        assert page.code in codes
        assert not is_error or codes == {page.code}
        assert [str(each) for each in lint(page, good)] == []


@pytest.mark.parametrize("rule", each_rule(RULES), ids=lambda rule: rule.code)
def test_a_fix_is_described_and_fixes_the_bad_example(rule: Rule) -> None:
    described = rule.page.partition("\n## Fix safety\n")[2]
    assert bool(described) == any(fixes(rule, text) for text in examples(rule))
    assert not described or "safe" in described
    text = next(iter(examples(rule)), "")
    for fix in fixes(rule, text)[:1]:
        after = apply(fix.edits, SourceFile("x.yaml", text))
        assert rule.code not in {each.code for each in lint(rule, after)}
        if fix.safe:
            before, then = (lint_source(SourceFile("x.yaml", t), []) for t in (text, after))
            assert before.digest == then.digest


def test_rules_of_play_are_warnings_and_those_of_style_infos() -> None:
    for rule in RULES:
        assert re.fullmatch(r"BR[56]\d\d", rule.code)
        # What a level states of itself is right or wrong.
        severity = "error" if rule.code == BROKEN_EXPECTATION else "warning"
        assert rule.severity == (severity if rule in PLAY else "info")
        assert rule.needs in Needs
