"""The page on scoring: its picture is made as it says, and no attribute is missing."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from support.places import DOCS

TEXT = (DOCS / "scoring.md").read_text("utf-8")
BLOCKS = re.findall(r"^```python\n(.*?)^```", TEXT, re.MULTILINE | re.DOTALL)


def test_the_picture_is_what_the_example_saves(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    exec(next(block for block in BLOCKS if "scores.svg" in block), {})
    picture = (DOCS / "images" / "scores.svg").read_text("utf-8")
    assert Path("scores.svg").read_text("utf-8") == picture


def test_each_attribute_of_a_score_is_described() -> None:
    from dataclasses import fields

    from babyrobot_levels.scoring.results import LevelScore, Summary

    for name in [field.name for kind in (LevelScore, Summary) for field in fields(kind)]:
        assert f"`{name}`" in TEXT or name in {"level", "levels", "digest"}, name
