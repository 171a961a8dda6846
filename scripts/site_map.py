"""`llms.txt`, which leads language models to the pages of the site."""

from __future__ import annotations

import json
import posixpath
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

_CONTENTS = re.compile(r"```\{toctree\}\n:caption: (.*?)\n.*?\n\n(.*?)```", re.S)


def llms() -> str:
    """Return the list of all pages, by the captions and in the order of the site's contents."""
    index = (ROOT / "docs" / "index.md").read_text("utf-8")
    summary = re.search(r"^\*\*Grid worlds as files\.\*\* (.*?)\n\n", index, re.M | re.S)
    assert summary
    plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", " ".join(summary[1].split()))
    parts = [
        f"# babyrobot-levels\n\n> Grid worlds as files. {plain}\n\n"
        "To write levels, read [SKILL.md](SKILL.md): the language, the commands, and traps.\n"
    ]
    for caption, entries in _CONTENTS.findall(index):
        parts.append(f"\n## {caption}\n\n")
        for entry in entries.split("\n")[:-1]:
            name = entry.partition("<")[2].rstrip(">") or entry
            page = posixpath.normpath(posixpath.join("docs", name))
            parts.append(f"- [{_title(ROOT / page)}]({page}.html)\n")
    return "".join(parts)


def _title(page: Path) -> str:
    """Return the heading of a page or a notebook."""
    path = page.with_suffix(".md")
    if path.exists():
        text = path.read_text("utf-8")
    else:
        cells = json.loads(page.with_suffix(".ipynb").read_text("utf-8"))["cells"]
        text = "".join(cells[0]["source"])
    heading = re.search(r"^# (.*)", text, re.M)
    assert heading, page
    return heading[1]
