"""The page on many robots at once: its pieces of code run, each alone."""

from __future__ import annotations

import re

import pytest
from support.places import DOCS

PAGE = (DOCS / "vector.md").read_text(encoding="utf-8")
PIECES = re.findall(r"^```python\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("code", PIECES)
def test_a_piece_of_code(code: str) -> None:
    # In the process of the tests, Gymnasium knows the levels anyway.
    assert re.search(r"^(import|from) babyrobot_levels\b", code, re.MULTILINE)
    exec(compile(code, "vector.md", "exec"), {})


def test_there_are_pieces_of_code() -> None:
    assert len(PIECES) > 3
