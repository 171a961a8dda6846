"""The tables of the document about formats are complete."""

from __future__ import annotations

import re

from support.places import DOCS

from babyrobot_levels.cli.convert import ExportFormat
from babyrobot_levels.convert.babyrobot.reading import _PLAYING, KEYWORDS

TEXT = (DOCS / "converting.md").read_text(encoding="utf-8")


def test_the_table_has_all_formats() -> None:
    rows = re.findall(r"^\| (`.*?`) \|", TEXT, re.MULTILINE)
    names = [name for row in rows for name in re.findall(r"`([a-z-]+)`", row)]
    assert names[: len(ExportFormat)] == list(ExportFormat)


def test_the_keywords_are_all_explained() -> None:
    explained = set(re.findall(r"`(\w+)`", TEXT))
    assert KEYWORDS - set(_PLAYING) <= explained
