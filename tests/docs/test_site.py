"""The documentation site has all pages and all public names; `bash scripts/site.sh` builds it."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
from support.places import DOCS, ROOT

import babyrobot_levels as brl

# The pages of the rules are added by docs/conf.py, those of the interface by its first page.
FOUND = {*DOCS.glob("*.md"), *ROOT.glob("*.md"), *(ROOT / "notebooks").glob("*.ipynb")}
PAGES = sorted(FOUND - {DOCS / "index.md"})


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_contents_list_every_page(page: Path) -> None:
    name = Path(os.path.relpath(page, DOCS)).with_suffix("").as_posix()
    contents = (DOCS / "index.md").read_text("utf-8")
    assert re.search(rf"^(.* <)?{re.escape(name)}>?$", contents, re.MULTILINE)


def test_the_reference_has_every_public_name_once() -> None:
    pages = [page.read_text("utf-8") for page in (DOCS / "api").glob("*.md")]
    named = re.findall(r"^\.\. auto\w+:: (\w+)$", "\n".join(pages), re.MULTILINE)
    assert sorted(named) == [name for name in brl.__all__ if name != "__version__"]
