"""Levels of texts, or what is wrong with them, without exceptions."""

from __future__ import annotations

from pathlib import Path

from babyrobot_levels.language.validation import Checked
from babyrobot_levels.library.level import Level
from babyrobot_levels.suites.checking import check_document
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile


def read_level(source: SourceFile, path: Path | None = None) -> Checked[Level]:
    """Return the level of a text, or its diagnostics."""
    try:
        level, diagnostics = check_document(read(source), Level, path)
    except LevelError as error:
        return Checked(None, [*error.diagnostics])
    assert level is None or isinstance(level, Level)
    return Checked(level, diagnostics)
