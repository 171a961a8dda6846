"""The page on learning has examples of all algorithms."""

from __future__ import annotations

import re

import pytest
from support.places import DOCS

from babyrobot_levels.analysis import learning

PAGE = (DOCS / "learning.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```python\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("name", [name for name in learning.__all__ if name.islower()])
def test_each_algorithm_has_an_example(name: str) -> None:
    assert any(name in code for code in BLOCKS)
