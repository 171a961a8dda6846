"""Fixes: what they leave unchanged, and which of them are refused."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace as replace_fields

import pytest

from babyrobot_levels.linter import runner
from babyrobot_levels.linter.context import LintContext
from babyrobot_levels.linter.finding import Finding, Needs
from babyrobot_levels.linter.fixes import append, remove, replace
from babyrobot_levels.linter.rule import Rule
from babyrobot_levels.linter.rules import all_rules
from babyrobot_levels.linter.runner import apply, fix
from babyrobot_levels.text.budget import Limits, spend
from babyrobot_levels.text.diagnostics import Edit, Fix, Severity
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile

Route = tuple[str | int, ...]


def without(text: str, route: Route) -> str:
    source = SourceFile("x.yaml", text)
    return apply([remove(read(source), route)], source)


@pytest.mark.parametrize(
    ("text", "route", "after"),
    [
        ("a: 1\nb: 2\nc: 3\n", ("b",), "a: 1\nc: 3\n"),
        ("a: 1\nb: 2\n", ("b",), "a: 1\n"),
        ("a: 1\nb: 2", ("b",), "a: 1\n"),
        ("a: 1\nb:\n  - 1\n  - 2\nc: 3\n", ("b",), "a: 1\nc: 3\n"),
        ("a: 1\n# why\nb: |\n  x\n\n  y\n\nc: 3\n", ("b",), "a: 1\n# why\n\nc: 3\n"),
        ("{a: 1, b: 2, c: 3}\n", ("b",), "{a: 1, c: 3}\n"),
        ("{a: 1, b: 2}\n", ("b",), "{a: 1}\n"),
        ("x:\n  - {a: 1, b: 2} # c\n", ("x", 0, "a"), "x:\n  - {b: 2} # c\n"),
        ("x:\n  - a: 1\n    b: 2\n", ("x", 0, "a"), "x:\n  - b: 2\n"),
        ("x:\n  - a: 1\n    b: 2\n", ("x", 0, "b"), "x:\n  - a: 1\n"),
        ("x:\n- 1 # one\n- 2\n- 3\n", ("x", 1), "x:\n- 1 # one\n- 3\n"),
        ("x:\n-\n  a: 1\n- {a: 2}\n", ("x", 0), "x:\n- {a: 2}\n"),
        ("x: [1, [2, 3], 4]\n", ("x", 1), "x: [1, 4]\n"),
        ("x: [1, 2]\n", ("x", 1), "x: [1]\n"),
        # What would be left empty goes too.
        ("y: 1\nx: [2]\n", ("x", 0), "y: 1\n"),
        ("y: 1\nx:\n  - {a: 1}\n", ("x", 0, "a"), "y: 1\n"),
        ("x:\n  - {a: 1}\n  - {b: 2}\n", ("x", 0, "a"), "x:\n  - {b: 2}\n"),
        ("y: 1\r\nx: 2\r\nz: 3\r\n", ("x",), "y: 1\r\nz: 3\r\n"),
        # Comments stay.
        ("x:\n  - 1\n  - 2 # two\n  - 3\n", ("x", 1), "x:\n  - 1\n  # two\n  - 3\n"),
        ("y: 1 # one\r\nx: # b\r\n  # c\r\n  - 2", ("x",), "y: 1 # one\r\n# b\r\n# c\r\n"),
        ("x: [1,\n    2, # two\n    3]\n", ("x", 1), "x: [1,\n    # two\n    3]\n"),
        ("x: [1, # one\n    2 # two\n    ]\n", ("x", 1), "x: [1  # one\n     # two\n    ]\n"),
        ("x: [1, # '#'\n  '# 2']\n", ("x", 0), "x: [  # '#'\n  '# 2']\n"),
        ("x:\n  - a: 1 # a\n    b: 2\n", ("x", 0, "a"), "x:\n  - # a\n    b: 2\n"),
    ],
)
def test_only_the_value_is_removed(text: str, route: Route, after: str) -> None:
    assert without(text, route) == after


def test_missing_values_cannot_be_removed() -> None:
    document = read(SourceFile("x.yaml", "a: {b: 1}\n"))
    with pytest.raises(KeyError):
        remove(document, ("a", "c"))
    with pytest.raises(KeyError):
        replace(document, ("a", "b", "c"), "1")


def rule(text: str, new: str, *, safe: bool = True) -> Rule:
    """Return a rule that writes `new` for `text`, wherever it stands."""

    def check(context: LintContext) -> Iterator[Finding]:
        at = context.source.text.find(text)
        if at >= 0:
            start, end = context.source.position(at), context.source.position(at + len(text))
            edit = Edit(type(context.document.root.span)(start, end), new)
            yield Finding((), "a problem", fix=Fix("fix it", (edit,), safe))

    return Rule("BR999", "problem", "", "", Severity.INFO, Needs.LEVEL, check)


def test_unsafe_fixes_are_applied_on_request_only() -> None:
    source = SourceFile("x.yaml", "version: 1\ntitle: old # c\n")
    assert fix(source, [rule("old", "new")]).text == "version: 1\ntitle: new # c\n"
    unsafe = rule("old", "new", safe=False)
    assert fix(source, [unsafe]).count == 0
    assert fix(source, [unsafe], unsafe=True).text == "version: 1\ntitle: new # c\n"


def test_a_safe_fix_that_changes_the_mdp_is_refused() -> None:
    source = SourceFile("x.yaml", "version: 1\nsize: [3, 4]\n")
    fixed = fix(source, [rule("[3, 4]", "[4, 4]")])
    assert (fixed.text, fixed.count) == (source.text, 0)
    assert fix(source, [rule("[3, 4]", "[4, 4]", safe=False)], unsafe=True).count == 1


@pytest.mark.parametrize("new", ["[3, 0]", "[", "{"])
def test_a_fix_after_which_the_level_does_not_load_is_refused(new: str) -> None:
    source = SourceFile("x.yaml", "version: 1\nsize: [3, 4]\n")
    fixed = fix(source, [rule("[3, 4]", new, safe=False)], unsafe=True)
    assert (fixed.text, fixed.count) == (source.text, 0)


def test_fixes_are_repeated_up_to_a_limit() -> None:
    source = SourceFile("x.yaml", "version: 1\ntitle: aaaa\n")
    assert fix(source, [rule("aa", "a")]).text == "version: 1\ntitle: a\n"
    assert fix(source, [rule("a", "b"), rule("b", "a")]).count > 1


def test_fixes_end_with_the_work_of_a_command(monkeypatch: pytest.MonkeyPatch) -> None:
    def check(context: LintContext) -> Iterator[Finding]:
        spend(60)
        assert plain.check is not None
        yield from plain.check(context)

    plain = rule("aa", "a")
    costly = replace_fields(plain, check=check)
    source = SourceFile("x.yaml", "version: 1\ntitle: aaaaaaaa\n")
    monkeypatch.setattr(runner, "COMMAND", Limits(100, math.inf))
    cut = fix(source, [costly])
    assert (cut.count, cut.is_cut) == (1, True)
    monkeypatch.undo()
    whole = fix(source, [costly])
    assert (whole.count, whole.is_cut) == (7, False)


ANCHORED = """\
source: " x"
theme: "high_contrast"
wind: {east: &b1 [ 0.0, 0 ]}
start:
 - +0
 - 1
size:
 - 1
 - 2
walls:
 - &x
  at:
   - 0
   - 1
  side: 'N'
 -
  at: *b1
  side: 'S'
 -
  at:
  - 0x0
  - 1
  side: "N"
# é漢
  pass: 0.25
  fit: true
 -
  at:
   - 0
   - 0o1
  side: "N"
 -
  at:
  - 0
  - &b3 0
  side: "S"
version: 1
rewards:
 exit: 1000000.0  #c
 step: &b4 5e-324
exit: "none"
"""


def test_a_fix_that_others_make_possible_is_applied_in_the_same_run() -> None:
    """The wind can only be removed once the alias of its value is gone."""
    once = fix(SourceFile("x.yaml", ANCHORED), all_rules(), unsafe=True)
    assert "wind" not in once.text
    twice = fix(SourceFile("x.yaml", once.text), all_rules(), unsafe=True)
    assert (twice.text, twice.count) == (once.text, 0)


def test_one_bad_fix_does_not_stop_the_others() -> None:
    """More good fixes than rounds would allow if each were applied by itself."""
    names = [f"x{number}" for number in range(150)]
    text = "version: 1\nsize: [3, 4]\nsource: |\n" + "".join(f"  {name}.\n" for name in names)
    rules = [rule("[3, 4]", "[4, 4]"), *(rule(f"{name}.", "y") for name in names)]
    fixed = fix(SourceFile("x.yaml", text), rules)
    assert fixed.count == len(names)
    assert fixed.text == "version: 1\nsize: [3, 4]\nsource: |\n" + "  y\n" * len(names)


@pytest.mark.parametrize(
    "text",
    ["{version: 1, size: [3, 3]}\n", "version: 1\nopenings: &same []\nwalls: *same\n"],
    ids=["the whole file is in flow style", "the list is an alias"],
)
def test_entries_are_not_appended_where_there_is_no_good_position(text: str) -> None:
    document = read(SourceFile("x.yaml", text))
    field = "walls" if "walls" in text else "openings"
    assert append(document, field, ["{at: [0, 0], side: E}"], ["version"]) is None
