"""The pages of the rules: each one's bad example has what it speaks of, and the good one not."""

from __future__ import annotations

import re

import pytest

from babyrobot_levels.lint.fixer import apply
from babyrobot_levels.lint.registry import all_rules
from babyrobot_levels.lint.rule import Needs, Rule
from babyrobot_levels.lint.rules import same_game
from babyrobot_levels.lint.runner import lint_source
from babyrobot_levels.text.diagnostics import Diagnostic, Fix
from babyrobot_levels.text.source import SourceFile

RULES = all_rules()
PLAY = [rule for rule in RULES if rule.code < "BR6"]
WITH_A_FILE = {"BR601": "mine.yaml", "BR611": "mine.yml"}
"""Rules that look at the file's name, of which a page can only speak."""

each_rule = pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.code)


def examples(rule: Rule) -> dict[str, str]:
    """Return the examples of a page by the heading above them."""
    found = re.findall(r"^## (\w+)$.*?```yaml\n(.*?)```", rule.page, re.DOTALL | re.MULTILINE)
    return {heading: text for heading, text in found if heading in ("Example", "Instead")}


def found(rule: Rule, text: str) -> list[Diagnostic]:
    """Return what a rule and all rules of play find; silences are judged by those that ran."""
    rules = [each for each in RULES if each in (*PLAY, rule)]
    return lint_source(SourceFile("x.yaml", text), rules).diagnostics


def test_pages_have_two_examples_but_those_of_several_files_and_of_names() -> None:
    without = {rule.code for rule in RULES if not examples(rule)}
    assert same_game.CODE in without
    assert {rule.code for rule in RULES if rule.check is None} <= without
    assert without <= {same_game.CODE, *WITH_A_FILE}
    assert all(len(examples(rule)) == 2 for rule in RULES if rule.code not in without)


@each_rule
def test_a_rule_finds_its_bad_example(rule: Rule) -> None:
    for text in [examples(rule)["Example"]] if examples(rule) else []:
        assert rule.code in {each.code for each in found(rule, text)}


@each_rule
def test_nothing_is_found_in_the_good_example(rule: Rule) -> None:
    for text in [examples(rule)["Instead"]] if examples(rule) else []:
        assert [str(each) for each in found(rule, text)] == []


def fixes(rule: Rule, text: str) -> list[Fix]:
    return [each.fix for each in found(rule, text) if each.code == rule.code and each.fix]


@each_rule
def test_a_page_tells_of_a_fix_if_there_is_one(rule: Rule) -> None:
    told = rule.page.partition("\n## Fix\n")[2]
    mended = [fix for text in examples(rule).values() for fix in fixes(rule, text)]
    assert not mended or "safe" in told
    # Some of style are mended by `babyrobot format`.
    assert mended or not told or rule not in PLAY


@each_rule
def test_the_fix_of_the_bad_example_mends_it(rule: Rule) -> None:
    text = examples(rule).get("Example", "")
    for fix in fixes(rule, text)[:1]:
        after = apply(fix.edits, SourceFile("x.yaml", text))
        assert rule.code not in {each.code for each in found(rule, after)}
        if fix.safe:
            before, then = (lint_source(SourceFile("x.yaml", t), []) for t in (text, after))
            assert before.digest == then.digest


@each_rule
def test_rules_of_play_come_before_those_of_style(rule: Rule) -> None:
    assert re.fullmatch(r"BR[56]\d\d", rule.code)
    assert rule.severity == ("warning" if rule in PLAY else "info")
    assert rule.needs in Needs
