"""The codes of errors and rules in all of the package."""

from __future__ import annotations

import re

from support.places import ROOT

from babyrobot_levels.linter.rules import titles


def test_every_code_in_the_sources_has_a_page() -> None:
    sources = "".join(path.read_text("utf-8") for path in (ROOT / "babyrobot_levels").rglob("*.py"))
    assert set(re.findall(r'"(BR\d{3})"', sources)) == set(titles())
