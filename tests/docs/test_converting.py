"""The tables of the document about formats are complete."""

from __future__ import annotations

import re

from support.places import DOCS

from babyrobot_levels.cli.convert import PICTURES, WRITTEN
from babyrobot_levels.convert.formats import FORMATS
from babyrobot_levels.convert.setups import _PLAYING, KEYWORDS

TEXT = (DOCS / "converting.md").read_text(encoding="utf-8")


def test_the_table_has_all_formats() -> None:
    head = "| format | what it is | read from | written as |\n|---|---|---|---|\n"
    table = TEXT.partition(head)[2].partition("\n\n")[0]
    rows = [[cell.strip() for cell in line.split("|")[1:5]] for line in table.splitlines()]
    names = {name: row for row in rows for name in re.findall(r"`([a-z-]+)`", row[0])}
    assert [*names] == [*FORMATS, *PICTURES]
    assert [name for name, row in names.items() if row[2]] == [*FORMATS]
    assert [name for name, row in names.items() if row[3]] == [*WRITTEN]
    for name, each in FORMATS.items():
        for suffix in {*each.suffixes, *each.written_suffixes}:
            assert f"`{suffix}`" in "".join(names[name]), name


def test_the_keywords_are_all_explained() -> None:
    explained = set(re.findall(r"`(\w+)`", TEXT))
    assert KEYWORDS - set(_PLAYING) <= explained
