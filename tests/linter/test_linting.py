"""`brl.lint`: what it takes, which rules it applies, and what it fixes."""

from __future__ import annotations

from pathlib import Path

import pytest

import babyrobot_levels as brl
from babyrobot_levels.linter.registry import UnknownRuleError

pytestmark = pytest.mark.usefixtures("here")
WET = "version: 1\nsize: [3, 1]\nopenings: []\n"


def codes(found: list[brl.Diagnostic]) -> list[str]:
    return [each.code for each in found]


def test_levels_are_linted_in_all_forms() -> None:
    Path("wet.yaml").write_text(WET, encoding="utf-8")
    told = codes(brl.lint(WET))
    assert told
    level = brl.load("wet.yaml")
    for form in (Path("wet.yaml"), "wet.yaml", ["wet.yaml"], level, Path()):
        assert codes(brl.lint(form)) == told, form
    assert set(codes(brl.lint({"version": 1, "size": [3, 1], "openings": []}))) <= set(told)
    assert brl.lint("final-maze") == []


def test_rules_are_selected_and_ignored() -> None:
    told = codes(brl.lint(WET))
    assert brl.lint(WET, ignore=told) == []
    assert codes(brl.lint(WET, select=told[:1])) == told[:1]
    with pytest.raises(UnknownRuleError, match="BR999"):
        brl.lint(WET, select=["BR999"])


def test_files_are_fixed_and_texts_are_not() -> None:
    path = Path("wet.yaml")
    path.write_text(WET, encoding="utf-8")
    assert [each.fix is not None for each in brl.lint(WET, fix=True)].count(True)
    before = brl.lint(path)
    assert path.read_text("utf-8") == WET
    after = brl.lint(path, fix=True)
    assert len(after) < len(before)
    assert path.read_text("utf-8") != WET
    assert brl.lint(path) == after


def test_equal_levels_of_a_folder_are_told() -> None:
    for name in ("a", "b"):
        Path(f"{name}.yaml").write_text("version: 1\nsize: [3, 2]\n", encoding="utf-8")
    found = [each for each in brl.lint(Path()) if each.file == "b.yaml"]
    assert found[0].message.startswith("this level has the same MDP as a.yaml")
