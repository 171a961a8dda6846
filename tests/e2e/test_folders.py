"""All that take levels take a folder."""

from __future__ import annotations

from pathlib import Path

import pytest

import babyrobot_levels as brl


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of two levels and a suite, below an empty current folder."""
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "week-1"
    (folder / "more").mkdir(parents=True)
    for name, width in {"b": 3, "more/a": 2}.items():
        text = f"version: 1\nname: level-{width}\nsize: [{width}, 1]\n"
        (folder / f"{name}.yaml").write_text(text, encoding="utf-8")
    suite = "version: 1\nkind: suite\ncount: 2\nsize: [4, 4]\n"
    (folder / "drawn.yaml").write_text(suite, encoding="utf-8")
    return folder


@pytest.mark.slow
def test_all_that_take_levels_take_a_folder(folder: Path, tmp_path: Path) -> None:
    assert [each.name for each in brl.solve_many(folder)] == ["level-3", "level-2"]
    assert [each.level for each in brl.score(folder, "random")] == ["level-3", "level-2"]
    assert len(brl.sheet(folder, per_page=1).pages) == 2
    made = brl.gallery(folder, tmp_path / "site")
    assert made.title == "week-1"
    assert [each["name"] for each in made.levels] == ["level-3", "level-2"]
