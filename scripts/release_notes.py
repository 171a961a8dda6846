"""Print the notes of a release: the section of its version in CHANGELOG.md.

Usage: python scripts/release_notes.py VERSION

The version has to be that of the package and of CITATION.cff.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def notes(version: str, root: Path = ROOT) -> str:
    """Return the notes of a version.

    Raises:
        ValueError: it is not the version of the package or of CITATION.cff, or the changelog has
            no section for it.
    """
    for name, pattern in (
        ("babyrobot_levels/__init__.py", r'^__version__ = "(.+)"$'),
        ("CITATION.cff", r"^version: (.+)$"),
    ):
        stated = re.search(pattern, (root / name).read_text(encoding="utf-8"), re.MULTILINE)
        if stated is None or stated[1] != version:
            found = "none" if stated is None else stated[1]
            raise ValueError(f"the version in {name} is {found}, not {version}")
    changelog = (root / "CHANGELOG.md").read_text(encoding="utf-8")
    for section in re.split(r"^## ", changelog, flags=re.MULTILINE)[1:]:
        heading, _, text = section.partition("\n")
        if heading.split(" ")[0].strip("[]") == version:
            return text.strip() + "\n"
    raise ValueError(f"CHANGELOG.md has no section `## {version}`: rename `## Unreleased`")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python scripts/release_notes.py VERSION")
    try:
        sys.stdout.write(notes(sys.argv[1]))
    except ValueError as error:
        sys.exit(f"error: {error}")
