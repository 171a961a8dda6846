"""The pages of codes: each is there, says what is so, and stands in the documentation."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import babyrobot_levels
from babyrobot_levels.cli.rule_pages import documents
from babyrobot_levels.lint.pages import all_pages, page_of, titles
from babyrobot_levels.lint.registry import all_rules, select
from babyrobot_levels.lint.rule import Rule
from babyrobot_levels.lint.runner import lint_source
from babyrobot_levels.text.diagnostics import Severity
from babyrobot_levels.text.source import SourceFile

PACKAGE = Path(babyrobot_levels.__file__).parent
DOCS = PACKAGE.parent / "docs" / "rules"
ERRORS = [page for page in all_pages() if page.severity is Severity.ERROR]


def examples(rule: Rule) -> list[str]:
    return re.findall(r"```yaml\n(.*?)```", rule.page, re.DOTALL)


def test_the_documentation_has_these_pages_and_no_others() -> None:
    # `python -m babyrobot_levels.cli.rule_pages docs/rules` writes them anew.
    assert {path.name: path.read_text("utf-8") for path in DOCS.iterdir()} == documents()


def test_every_code_that_is_spoken_of_in_the_sources_has_a_page() -> None:
    sources = "".join(path.read_text("utf-8") for path in PACKAGE.rglob("*.py"))
    spoken = set(re.findall(r'"(BR\d{3})"', sources))
    assert spoken == set(titles())


def test_codes_and_names_are_unique() -> None:
    pages = all_pages()
    assert len({page.code for page in pages}) == len({page.name for page in pages}) == len(pages)
    assert len(all_rules()) >= 25


@pytest.mark.parametrize("page", all_pages(), ids=lambda page: page.code)
def test_a_page_begins_with_one_sentence_and_says_what_to_do(page: Rule) -> None:
    assert re.fullmatch(r"[A-Z][^\n]{9,98}\.", page.summary)
    assert page_of(page.code) is page is page_of(page.name)
    assert len(examples(page)) in (0, 2)
    assert examples(page) or "## What to do" in page.page
    if page.severity is not Severity.ERROR:
        assert "## Why it is bad" in page.page


@pytest.mark.parametrize("page", ERRORS, ids=lambda page: page.code)
def test_the_examples_of_an_error_have_it_and_have_it_not(page: Rule) -> None:
    texts = examples(page)
    found = [lint_source(SourceFile("x.yaml", text), select([])).diagnostics for text in texts]
    if texts:
        assert {each.code for each in found[0]} == {page.code}
        assert found[1] == []
    else:
        # These speak of bytes, of sizes, and of other files, which a page cannot show.
        assert page.code in ("BR101", "BR102", "BR103", "BR109", "BR701", "BR702")
