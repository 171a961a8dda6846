"""Mistakes in files and drawings: what each is told, and what the fixes make of it."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.mistakes import FOLDER, entries, told

import babyrobot_levels as brl

FILES = sorted(FOLDER.glob("*.txt"))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_each_mistake_is_told_as_written_down(path: Path) -> None:
    text = path.read_text("utf-8")
    assert told(text) == text


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_no_mistake_passes_in_silence(path: Path) -> None:
    text = path.read_text("utf-8")
    assert "\nclean\n" not in text
    assert len([*entries(text)]) == len({did for did, _ in entries(text)})


@pytest.mark.parametrize(
    ("name", "text"), [("a.toml", "[size]\nwidth = 3\n"), ("a.py", "import gymnasium\n")]
)
def test_files_of_other_forms_are_told_which(name: str, text: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text, "utf-8")
    (found,) = brl.validate(tmp_path / name)
    form = {"a.toml": "TOML", "a.py": "Python"}[name]
    assert found.help == f"a level is written in YAML or JSON, and this is a file of {form}"
