"""The example of learners: what it prints is what the page shows."""

from __future__ import annotations

import re
import subprocess
import sys
from importlib.util import find_spec

import pytest
from support.places import DOCS, ROOT


@pytest.mark.sweep
def test_learners_find_what_the_page_says() -> None:
    page = (DOCS / "robots.md").read_text(encoding="utf-8")
    shown = re.search(r"<!-- learners -->\n```text\n(.*?)```", page, re.S)
    assert shown is not None
    rows = shown[1].splitlines(keepends=True)
    if find_spec("overcooked_ai_py") is None:
        rows = [row for row in rows if not row.startswith("coordination-ring")]
    command = [sys.executable, str(ROOT / "examples" / "robots" / "learners.py")]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=300)
    assert done.stdout == "".join(rows)
