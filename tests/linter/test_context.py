"""Comments that suppress findings: what they cover, and which of them are unused."""

from __future__ import annotations

from textwrap import dedent

import pytest

from babyrobot_levels.linter.rules import select
from babyrobot_levels.linter.runner import fix, lint_source
from babyrobot_levels.text.source import SourceFile


def codes(text: str, rules: list[str]) -> list[str]:
    report = lint_source(SourceFile("x.yaml", dedent(text)), select(rules))
    return [each.code for each in report.diagnostics]


WALLS = """\
version: 1
walls:
  - {at: [1, 0], side: south}
  - {at: [0, 1], side: east}
"""


def test_without_a_comment_both_are_found() -> None:
    assert codes(WALLS, ["BR608"]) == ["BR608", "BR608"]


@pytest.mark.parametrize("word", ["BR608", "br608", "side-spelling", "BR503, BR608", "BR608,BR503"])
def test_above_the_first_field_it_covers_the_whole_file(word: str) -> None:
    assert codes(f"# babyrobot: ignore[{word}] why\n{WALLS}", ["BR608"]) == []


@pytest.mark.parametrize(
    "comment",
    [
        "# babyrobot: ignore[BR601] another rule",
        "# babyrobot: ignore nothing named",
        "# babyrobot ignore[BR608]",
        "# see babyrobot: ignore[BR608]",
    ],
)
def test_other_comments_suppress_nothing(comment: str) -> None:
    assert codes(f"{comment}\n{WALLS}", ["BR608"]) == ["BR608", "BR608"]


def test_after_an_entry_it_covers_the_entry() -> None:
    text = WALLS.replace("south}", "south}  # babyrobot: ignore[BR608] why")
    assert codes(text, ["BR608"]) == ["BR608"]


def test_above_an_entry_it_covers_what_begins_below() -> None:
    text = WALLS.replace("  - {at: [0", "  # babyrobot: ignore[BR608] why\n\n  # more\n  - {at: [0")
    assert codes(text, ["BR608"]) == ["BR608"]


def test_after_a_field_it_covers_everything_nested_in_it() -> None:
    text = WALLS.replace("walls:", "walls:  # babyrobot: ignore[BR608] why")
    assert codes(text, ["BR608"]) == []


def test_after_the_indicator_of_a_block_it_covers_the_drawing() -> None:
    drawn = """\
        version: 1
        map: |{}
          +---+---+---+
          | S     |   |
          +   +   +---+
          |         E |
          +---+---+---+
        warps:
          - {{at: [0, 1], to: [2, 0]}}
        """
    assert codes(drawn.format(""), ["BR503"]) == ["BR503"]
    assert codes(drawn.format("  # babyrobot: ignore[BR503] why"), ["BR503"]) == []


def test_text_that_looks_like_a_comment_suppresses_nothing() -> None:
    text = f'title: "a # babyrobot: ignore[BR608] b"\n{WALLS}'
    assert codes(text, ["BR608"]) == ["BR608", "BR608"]
    text = f"description: |\n  # babyrobot: ignore[BR608]\n{WALLS}"
    assert codes(text, ["BR608"]) == ["BR608", "BR608"]


def test_errors_are_never_suppressed() -> None:
    report = lint_source(
        SourceFile("x.yaml", "# babyrobot: ignore[BR201] no\nversion: 1\nnonsense: 1\n"),
        select(None),
    )
    assert [each.code for each in report.diagnostics] == ["BR201"]


# -- unused suppressions ----------------------------------------------------------------------


def test_a_suppression_of_a_rule_that_does_not_run_is_not_reported() -> None:
    text = "# babyrobot: ignore[BR608] why\nversion: 1\n"
    assert codes(text, ["BR699"]) == []
    assert codes(text, ["BR699", "BR608"]) == ["BR699"]


def test_a_suppression_of_a_rule_that_compares_files_is_not_reported() -> None:
    assert codes("# babyrobot: ignore[BR515] why\nversion: 1\n", ["ALL"])[:1] != ["BR699"]


def test_each_rule_of_a_suppression_is_checked_by_itself() -> None:
    text = WALLS.replace("walls:", "walls:  # babyrobot: ignore[BR608, BR610] why")
    report = lint_source(SourceFile("x.yaml", text), select(["BR608", "BR610", "BR699"]))
    (found,) = report.diagnostics
    assert found.code == "BR699"
    assert "`BR610`" in found.message
    assert "BR608" not in found.message


def test_the_fix_of_a_line_of_its_own_removes_this_line_alone() -> None:
    text = "version: 1\n# babyrobot: ignore[BR608] why\nsize: [4, 4]\n"
    fixed = fix(SourceFile("x.yaml", text), select(["BR608", "BR699"]))
    assert fixed.text == "version: 1\nsize: [4, 4]\n"
