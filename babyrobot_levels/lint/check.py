"""Checking a level from Python, without loading it."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

from babyrobot_levels.language.documents import errors_of
from babyrobot_levels.lint.registry import select
from babyrobot_levels.lint.runner import lint_file, lint_source
from babyrobot_levels.lint.settings import settings_for
from babyrobot_levels.text.diagnostics import Diagnostic
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import read_source
from babyrobot_levels.text.source import SourceFile


def check(path_or_text: str | Path, *, lint: bool = False) -> list[Diagnostic]:
    """Return all that is wrong with a level or a suite, a path or a text; nothing if all is well.

    A `str` counts as a text if it has a line end or a `: ` in it, else as a path.

    Args:
        path_or_text: the level or the suite.
        lint: whether to look also for faults of play and of style, as `babyrobot lint` does: by
            the rules that the project of the file selects, for a text by the usual ones.

    Raises:
        SettingsError: the project's settings are faulty.
    """
    if isinstance(path_or_text, str) and ("\n" in path_or_text or ": " in path_or_text):
        source = SourceFile("<text>", path_or_text)
        return lint_source(source, select(None)).diagnostics if lint else errors_of(source)
    path = Path(path_or_text)
    with suppress(RuntimeError):
        path = path.expanduser()
    if lint:
        return lint_file(path, settings_for(path).rules_for(path)).diagnostics
    try:
        return errors_of(read_source(path), path)
    except LevelError as fault:
        return [*fault.diagnostics]
