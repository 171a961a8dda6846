"""The page on learning says what is so: its examples run and print what it says they print."""

from __future__ import annotations

import re

import pytest
from support.places import DOCS

from babyrobot_levels.analysis import learning

PAGE = (DOCS / "learning.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```python\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("code", BLOCKS)
def test_the_examples_print_what_their_comments_say(
    code: str, capsys: pytest.CaptureFixture[str]
) -> None:
    exec(compile(code, "example", "exec"), {})
    assert capsys.readouterr().out.splitlines() == re.findall(r"^# (.*)$", code, re.MULTILINE)


@pytest.mark.parametrize("name", [name for name in learning.__all__ if name.islower()])
def test_each_algorithm_has_an_example(name: str) -> None:
    assert any(name in code for code in BLOCKS)
