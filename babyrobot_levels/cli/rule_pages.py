"""Write the pages of all codes: `python -m babyrobot_levels.cli.rule_pages docs/rules`."""

from __future__ import annotations

import sys
from pathlib import Path

from babyrobot_levels.linter.registry import all_pages, as_markdown, index
from babyrobot_levels.text.files import write_text


def documents() -> dict[str, str]:
    """Return the contents of each file by its name."""
    pages = {f"{rule.name}.md": as_markdown(rule) for rule in all_pages()}
    return {"README.md": index(), **pages}


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    for name, text in documents().items():
        write_text(folder / name, text)
    for path in folder.glob("*.md"):
        if path.name not in documents():
            path.unlink()
