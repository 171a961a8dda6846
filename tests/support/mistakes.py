"""Mistakes that people make, and what they are told: files that `scripts/renew.py` writes anew.

A file of mistakes holds entries: `## ` and what somebody did; the text of a level or a suite; below
`---` what the linter says of it; and, where its fixes change the text, below `+++` what is left.
What somebody did to a `pack.yaml` begins with `pack: `.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from babyrobot_levels.language.suite_list import PackFields
from babyrobot_levels.language.validation import parse
from babyrobot_levels.linter.rules import select
from babyrobot_levels.linter.runner import fix, lint_source
from babyrobot_levels.text.source import SourceFile
from support.places import TESTS

FOLDER = TESTS / "mistakes"
NAME, PACK = "level.yaml", "pack.yaml"


def entries(text: str) -> Iterator[tuple[str, str]]:
    """Yield the mistakes of a file: what somebody did, and the text that came of it."""
    for part in re.split(r"^## ", text, flags=re.M)[1:]:
        did, _, rest = part.partition("\n")
        yield did, rest.partition("---\n")[0]


def told(text: str) -> str:
    """Return a file of mistakes with what each of them is told now."""
    return "\n".join(_entry(did, level) for did, level in entries(text))


def _entry(did: str, level: str) -> str:
    if did.startswith("pack: "):
        diagnostics = parse(SourceFile(PACK, level), PackFields)[1]
        return f"## {did}\n{level}---\n" + "".join(f"{each}\n" for each in diagnostics)
    source, rules = SourceFile(NAME, level), select(None)
    shown = f"## {did}\n{level}---\n"
    shown += "".join(f"{each}\n" for each in lint_source(source, rules).diagnostics) or "clean\n"
    fixed = fix(source, rules).text
    return shown if fixed == level else f"{shown}+++\n{fixed}"
