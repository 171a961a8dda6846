"""Levels and suites checked with everything that they name."""

from __future__ import annotations

from pathlib import Path

from babyrobot_levels.language.suite_list import AnySuite, SuiteListFields
from babyrobot_levels.language.validation import Checked
from babyrobot_levels.library import reading
from babyrobot_levels.library.level import Level
from babyrobot_levels.suites.members import member_issues
from babyrobot_levels.text.diagnostics import Diagnostic
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile


def check_document(
    document: Document, path: Path | None = None
) -> Checked[Level] | Checked[AnySuite]:
    """Check a level or a suite, whichever the document says it is, with what the suite lists.

    `path` is the file that it is from: it gives the name, and what stands beside it.
    """
    checked = reading.check_document(document, path)
    if not isinstance(checked.value, SuiteListFields):
        return checked
    issues = member_issues(checked.value, path)
    return Checked(None, [*map(document.diagnostic, issues)]) if issues else checked


def errors_of(source: SourceFile, path: Path | None = None) -> list[Diagnostic]:
    """Return what is wrong with a text that is a level or a suite; nothing if all is well."""
    try:
        return check_document(read(source), path).diagnostics
    except LevelError as error:
        return [*error.diagnostics]
