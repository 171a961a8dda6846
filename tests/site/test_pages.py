"""Every page of the documentation site is valid HTML, and its links lead somewhere."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.web import SITE, WebPage, foreign_in_style, pages


def name_of(path: Path) -> str:
    return path.relative_to(SITE).as_posix()


@pytest.mark.parametrize("path", pages(), ids=name_of)
def test_a_page_is_valid_and_its_links_lead_somewhere(path: Path) -> None:
    assert list(WebPage(path).faults()) == []


@pytest.mark.parametrize("path", sorted(SITE.rglob("*.css")), ids=name_of)
def test_no_style_asks_other_hosts(path: Path) -> None:
    assert list(foreign_in_style(path.read_text(encoding="utf-8"), path)) == []


@pytest.mark.parametrize("place", ["docs/index.html", "gallery/index.html", "editor/index.html"])
def test_the_site_is_there(place: str) -> None:
    assert (SITE / place).is_file(), "`bash scripts/site.sh` builds it"
