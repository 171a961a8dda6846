"""Mistakes in files and drawings: what each is told, and what the fixes make of it."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.mistakes import FOLDER, entries, told

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
