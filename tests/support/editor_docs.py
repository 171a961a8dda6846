"""What the page on the editor shows of it: the table of keys, and a picture."""

from __future__ import annotations

import re

from babyrobot_levels.render.scripts import static
from support.places import DOCS

PAGE = DOCS / "editor.md"
PICTURE = DOCS / "images" / "editor.png"

TABLE = re.compile(r"(?<=\n\| \| key \| what it does \|\n\|---\|---\|---\|\n)(?:\|.*\|\n)*")
"""The rows of the table of keys, in the text of the page."""


def key_rows() -> str:
    """Return the rows of the table of keys, from the front end."""
    script = static("editor/static/keys.js")
    lines = []
    for group in script[script.index("const KEYS") : script.index("];\n\n")].split("{ title: ")[1:]:
        title = group.split('"')[1]
        for keys, what in re.findall(r'\["([^"]+)", "([^"]+)",', group):
            lines.append(f"| {title} | {keys} | {what} |\n".replace("|  |", "| |"))
            title = ""
    return "".join(lines)
