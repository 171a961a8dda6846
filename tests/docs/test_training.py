"""The page on training names all examples."""

from __future__ import annotations

import re

from support.places import DOCS, EXAMPLES

PAGE = (DOCS / "training.md").read_text(encoding="utf-8")


def test_the_page_names_all_examples() -> None:
    examples = {path.name for path in (EXAMPLES).glob("*.py")}
    named = set(re.findall(r"\.\./examples/(\w+\.py)", PAGE))
    assert named == examples - {"arguments.py", "cluster.py", "comparison.py", "play.py"}
