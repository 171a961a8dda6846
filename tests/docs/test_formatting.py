"""The page on the canonical form: its example is what the formatter does."""

from __future__ import annotations

import re

from support.places import DOCS

import babyrobot_levels as brl

TEXT = (DOCS / "formatting.md").read_text(encoding="utf-8")


def block(name: str) -> str:
    found = re.search(rf"<!-- {name} -->\n```yaml\n(.*?)```", TEXT, re.DOTALL)
    assert found
    return found[1]


def test_the_example() -> None:
    assert brl.format(block("before")) == block("after")
    assert brl.format(block("after")) == block("after")


def test_numbers_and_words_are_written_as_told() -> None:
    pairs = re.findall(r"`([^`]+)` becomes `([^`]+)`", TEXT.split("| numbers |")[1])
    assert pairs == [("+3", "3"), (".50", "0.5"), ("1E+3", "1e3"), ("True", "true")]
    for before, after in pairs:
        field = "display: {compass: %s}" if before == "True" else "rewards: {step: %s}"
        assert brl.format(f"version: 1\n{field % before}\n") == f"version: 1\n{field % after}\n"
