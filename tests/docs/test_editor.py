"""The page on the editor: its tables are those of the editor."""

from __future__ import annotations

import re

from renew import editor_page
from support.places import DOCS

from babyrobot_levels.render.templates import static

TEXT = (DOCS / "editor.md").read_text("utf-8")


def rows(heading: str) -> list[list[str]]:
    """The rows of the table below a heading, without its head."""
    section = TEXT.partition(f"\n## {heading}\n")[2].partition("\n## ")[0]
    lines = [line for line in section.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]


def test_the_keys_are_those_of_the_editor() -> None:
    # `python scripts/renew.py docs/editor.md` writes them.
    assert len(rows("Keys")) > 20
    assert editor_page() == TEXT


def test_the_tools_are_those_of_the_editor() -> None:
    tools = [
        tuple(re.search(rf'\b{field}: "([^"]+)"', entry)[1] for field in ("key", "title"))  # type: ignore[index]
        for name in ("tools.js", "rail.js")
        for entry in static(f"editor/static/{name}").split("    name: ")[1:]
    ]
    shown = [
        pair
        for keys, titles, _ in rows("Tools")
        for pair in zip(keys.split(", "), titles.split(", "), strict=True)
    ]
    assert len(tools) > 10
    assert shown == tools
