"""Sentences of pages as tests hold them: word for word, without marks and line breaks."""

from __future__ import annotations

import re
from functools import cache

from support.places import DOCS


def plain(text: str) -> str:
    """Return a text of a page without its marks and line breaks."""
    text = re.sub(r"\[([^]]+)\]\([^)]*\)", r"\1", text)
    return " ".join(re.sub(r"\*\*([^*]+)\*\*|\*(\w[^*]*\w)\*", r"\1\2", text).split())


@cache
def _page(name: str) -> str:
    return plain((DOCS / f"{name}.md").read_text(encoding="utf-8"))


def says(page: str, *sentences: str) -> None:
    """Assert that a page still says so; the test that asks shows that it is so."""
    for sentence in sentences:
        assert sentence in _page(page), f"docs/{page}.md no longer says: {sentence}"
