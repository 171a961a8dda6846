"""The nearest known name, for messages about unknown ones."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

MAX_LENGTH = 64
"""Longer texts are not compared: nobody mistypes that much, and comparing takes long."""


def nearest(name: str, known: Iterable[str], count: int = 3) -> list[str]:
    """Return up to `count` of the known names that look like `name`, the likeliest first."""
    if len(name) > MAX_LENGTH:
        return []
    by_folded = {candidate.casefold(): candidate for candidate in known}
    folded = name.casefold()
    matches = difflib.get_close_matches(folded, list(by_folded), n=count, cutoff=0.6)
    if not matches and len(folded) > 2:
        # An abbreviation looks unlike the whole word, and is meant all the same.
        matches = [candidate for candidate in by_folded if candidate.startswith(folded)][:count]
    return [by_folded[match] for match in matches]


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return `; did you mean …?` with the nearest known name, or an empty text."""
    found = nearest(name, known, 1)
    return f"; did you mean `{found[0]}`?" if found else ""
