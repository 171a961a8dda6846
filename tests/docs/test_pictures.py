"""The document about pictures shows things as they are drawn, and names their characters."""

from __future__ import annotations

import re

from support.places import DOCS

from babyrobot_levels.analysis.pictures import FORMATS
from babyrobot_levels.render.text import PLAIN_ROBOTS, ROBOTS
from babyrobot_levels.render.text_plan import ITEMS, LOCKED, MOVER

TEXT = (DOCS / "pictures.md").read_text(encoding="utf-8")


def test_the_pictures_of_things_are_shown() -> None:
    assert all(f"images/{name}.svg" in TEXT for name in ("things", "things-held"))


def test_the_table_has_all_formats_with_their_files_methods_and_options() -> None:
    head = "| format | files | in Python | options |\n|---|---|---|---|\n"
    table = TEXT.partition(head)[2].partition("\n\n")[0]
    rows = [[re.findall(r"`(.*?)`", cell) for cell in row.split("|")] for row in table.splitlines()]
    assert [name for row in rows for name in row[1]] == [*FORMATS]
    for _, names, files, methods, options, _ in rows:
        formats = [FORMATS[name] for name in names]
        assert files == list(dict.fromkeys(file for each in formats for file in each.suffixes))
        assert methods == [f"to_{each.name}" for each in formats if each.make is not None]
        assert all([*each.shows.__annotations__] == options for each in formats)


def test_the_characters_of_things_are_those_of_the_table() -> None:
    unicode, ascii_ = (" ".join(f"`{pair[kind]}`" for pair in ITEMS.values()) for kind in (0, 1))
    assert f"| {', '.join(ITEMS)} | {unicode} | {ascii_} |" in TEXT
    assert f"| mover | `{MOVER[0]}` | `{MOVER[1]}` |" in TEXT
    robots = (" ".join(f"`{robot}`" for robot in robots[:4]) for robots in (ROBOTS, PLAIN_ROBOTS))
    assert f"| robot that turns | {' | '.join(robots)} |" in TEXT
    assert f"| exit whose needs are not met | `{LOCKED}` | `{LOCKED}` |" in TEXT
