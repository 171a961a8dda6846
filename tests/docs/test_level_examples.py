"""Every complete level in README and docs is clean under lint, or the page names the findings.

A page names them in a comment on the line before the block: `<!-- lint BR504 -->`.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from support.places import DOCS, ROOT

import babyrobot_levels as brl

PAGES = [ROOT / "README.md", *sorted(DOCS.glob("*.md"))]
BLOCK = re.compile(r"^(?:<!-- lint ([^>]*?) -->\n)?```yaml\n(.*?)^```", re.MULTILINE | re.DOTALL)


def examples() -> list[tuple[str, list[str], str]]:
    """Return place, expected codes and text of each block that loads as a level."""
    found = []
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        for block in BLOCK.finditer(text):
            if not brl.validate(block[2]):
                line = text.count("\n", 0, block.start()) + 1
                found.append((f"{page.name}:{line}", (block[1] or "").split(), block[2]))
    return found


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_mark_stands_before_an_example(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    marked = [block for block in BLOCK.finditer(text) if block[1]]
    assert len(marked) == text.count("<!-- lint ")


def test_complete_levels_have_exactly_the_findings_that_are_named() -> None:
    found = examples()
    assert len(found) > 30
    for place, expected, text in found:
        findings = brl.lint(text)
        codes = {finding.code for finding in findings if finding.severity != "info"}
        assert codes == set(expected), f"{place}: {findings}"
