"""The page on scoring: its examples run, and the numbers that it shows are those that come out."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from support.places import DOCS

TEXT = (DOCS / "scoring.md").read_text("utf-8")
BLOCKS = re.findall(r"^```python\n(.*?)^```", TEXT, re.MULTILINE | re.DOTALL)


def test_numbers_behind_an_expression_are_its_value(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    count = 0
    for block in BLOCKS:
        names: dict[str, Any] = {}
        exec(block, names)
        for expression, shown in re.findall(
            r"^(\S.*\S)  # (-?\d[\d.]*|True)(?=[…:\n])", block, re.M
        ):
            count += 1
            value = eval(expression, names)
            if shown == "True":
                assert value is True, expression
                continue
            # Digits that are not shown are cut off.
            unit = 10.0 ** -len(shown.partition(".")[2])
            assert abs(value - float(shown)) < unit, expression
    assert count >= 4
    assert (tmp_path / "scores.csv").exists()
    picture = (DOCS / "images" / "scores.svg").read_text("utf-8")
    assert (tmp_path / "scores.svg").read_text("utf-8") == picture


def test_each_attribute_of_a_score_is_described() -> None:
    from dataclasses import fields

    from babyrobot_levels.scoring.results import LevelScore, Summary

    for name in [field.name for kind in (LevelScore, Summary) for field in fields(kind)]:
        assert f"`{name}`" in TEXT or name in {"level", "levels", "digest"}, name
