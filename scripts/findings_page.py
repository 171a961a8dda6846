"""The page of `findings/`, made from the heads of its scripts."""

from __future__ import annotations

import re
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[1] / "findings"
FIELDS = ("Packages", "Tried", "Expected", "Seen", "Why it matters", "Here")
"""What a head says after its title, in this order."""

INTRODUCTION = """\
# Findings

What surprised us in the libraries, tools and formats that grid worlds and reinforcement learning
are made with. None of it is a fault of this project, and none is easy to guess from documentation.
Each script installs what it names in a temporary folder, runs it without this project, prints what
would be expected and what is seen, and fails if that has changed: `bash findings/NAME.sh`. No check
runs them. This page is made from their heads.
"""


def head(path: Path) -> dict[str, str]:
    """Return the title (``""``) and the fields that the comments at the top of a script say."""
    comments = re.match(r"#!.*\n((?:#.*\n)+)", path.read_text("utf-8"))
    assert comments, path
    text = re.sub(r"\n#   ", " ", comments[1])
    title, *fields = re.findall(r"^# (.+)$", text, re.M)
    return {"": title, **dict(each.split(": ", 1) for each in fields)}


def page() -> str:
    """Return the text of `findings/README.md`."""
    parts = [INTRODUCTION]
    for path in sorted(FOLDER.glob("*.sh")):
        told = head(path)
        title, tried = (told[name].rstrip(".") for name in ("", "Tried"))
        link = f"[{path.name}]({path.name}): {told['Packages']}. Tried: {tried}."
        lines = [f"- **{name}:** {told[name]}" for name in FIELDS[2:]]
        parts.append("\n".join([f"## {title}", "", link, "", *lines, ""]))
    return "\n".join(parts)
