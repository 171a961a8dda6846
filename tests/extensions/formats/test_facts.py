"""Facts about a level in files of other programs."""

from __future__ import annotations

from pathlib import Path

import pytest

import babyrobot_levels as brl
from babyrobot_levels.library.level import Level

EXPECT = {"path_length": 4.0, "best_return": "-4.5..-4", "best_steps": {"min": 4}, "lint": "clean"}


def test_facts_go_to_tiled_and_back(tmp_path: Path) -> None:
    level = Level.from_fields({"version": 1, "expect": EXPECT})
    path = tmp_path / "level.tmj"
    assert not brl.export(level, path=path).warnings
    assert brl.import_(path).to_dict()["expect"] == EXPECT


def test_what_holds_no_facts_says_so() -> None:
    level = Level.from_fields({"version": 1, "expect": EXPECT})
    lost = [warning.field for warning in brl.export(level, "prism").warnings]
    assert "expect" in lost


def test_what_is_wrong_in_a_mapping_has_no_lines() -> None:
    with pytest.raises(brl.LevelError) as caught:
        brl.export({"version": 1, "exit": [9, 9]}, format="tiled")
    told = str(caught.value)
    assert any(line.startswith("exit: error BR301") for line in told.splitlines())
    assert "<" not in told
