"""Texts and files to levels, with their themes; and checking them without loading."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from babyrobot_levels.language.looks import BUILTIN_THEMES, Theme
from babyrobot_levels.language.plain_data import MAX_VALUES, plain
from babyrobot_levels.language.problem import Problem
from babyrobot_levels.language.suite import SuiteFields, impossible
from babyrobot_levels.language.themes import read_theme, theme_folders, theme_names
from babyrobot_levels.language.validation import (
    ModelT,
    diagnostic,
    from_yaml,
    parse,
    parse_document,
    validate,
)
from babyrobot_levels.library.level import Level, slug
from babyrobot_levels.text.diagnostics import Diagnostic
from babyrobot_levels.text.document import Document, YamlFault
from babyrobot_levels.text.emitter import emit
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import ReadFault, read_source
from babyrobot_levels.text.reader import MAX_BYTES, MAX_NODES, read
from babyrobot_levels.text.source import SourceFile
from babyrobot_levels.text.suggest import did_you_mean

_MOST = 5
"""Of more problems than this without a place, only so many are told."""

_LONGEST_KEY = 100
"""No field's name is longer; what YAML takes for a name ends at some length as well."""

_SUITE_HELP = "`brl.load_suite` makes its levels, `babyrobot generate` writes them"


def loads(text: str, *, name: str = "<text>") -> Level:
    """Return the level that a YAML text says.

    Args:
        text: the text of a level file.
        name: what messages call the text.

    Raises:
        LevelError: the text is not a valid level; its `diagnostics` say where and why.
    """
    if not isinstance(text, str):
        raise TypeError(f"the text of a level is a str, not {type(text).__name__}")
    return _whole(read_level(SourceFile(name, text)))


def load_file(path: Path) -> Level:
    """Return the level of a file. A theme that it names may stand in `themes/` beside it.

    Raises:
        LevelError: the file cannot be read, or is not a valid level.
    """
    return _whole(read_file(path))


def read_file(path: Path) -> tuple[Level | None, list[Diagnostic]]:
    """Return the level of a file, or None and what is wrong with it."""
    try:
        source = read_source(path)
    except ReadFault as fault:
        return None, [fault.diagnostic]
    return read_level(source, path)


def read_level(
    source: SourceFile, path: Path | None = None
) -> tuple[Level | None, list[Diagnostic]]:
    """Return the level of a text, or None and what is wrong with it.

    `path` is the file that the text is from: it gives the level's name, and themes beside it.
    """
    try:
        document = read(source)
    except YamlFault as fault:
        return None, [from_yaml(fault.problem, source)]
    return read_document(document, path)


def read_document(
    document: Document, path: Path | None = None
) -> tuple[Level | None, list[Diagnostic]]:
    """Return the level of a text that was read as YAML; see `read_level`."""
    if is_suite(document):
        problem = Problem("BR201", ("kind",), "this is a suite of levels, not a level", _SUITE_HELP)
        return None, [diagnostic(problem, document)]
    folder = path.parent if path is not None else None
    theme = _ThemeCheck(folder)
    level, diagnostics = parse_document(document, Level, [theme])
    diagnostics += theme.diagnostics
    if level is None or diagnostics:
        return None, diagnostics
    if level.name is None and path is not None:
        level.__dict__["name"] = slug(path.stem)
    level.remember_origin(document.source, folder, theme.found)
    return level, []


def is_suite(document: Document) -> bool:
    """Tell whether a text says that it is something else than a level: `kind: suite`."""
    return isinstance(document.data, dict) and "kind" in document.data


def read_suite(
    document: Document, path: Path | None = None
) -> tuple[SuiteFields | None, list[Diagnostic]]:
    """Return the fields of a suite, or None and what is wrong with it.

    `path` is the file that the text is from: it gives the suite's name, and themes beside it.
    """
    theme = _ThemeCheck(path.parent if path is not None else None)
    suite, diagnostics = parse_document(document, SuiteFields, [theme, impossible])
    diagnostics += theme.diagnostics
    if suite is None or diagnostics:
        return None, diagnostics
    if suite.name is None and path is not None:
        suite.__dict__["name"] = slug(path.stem)
    return suite, []


def errors_of(source: SourceFile, path: Path | None = None) -> list[Diagnostic]:
    """Return what is wrong with a text that is a level or a suite; nothing if all is well."""
    try:
        document = read(source)
    except YamlFault as fault:
        return [from_yaml(fault.problem, source)]
    if is_suite(document):
        return read_suite(document, path)[1]
    return read_document(document, path)[1]


def from_mapping(
    data: Mapping[str, Any], *, name: str | None = None, folder: Path | None = None
) -> Level:
    """Return the level that a mapping of the language's fields says.

    Args:
        data: the fields. NumPy's numbers and arrays, tuples and models are taken too.
        name: the level's name, if the mapping gives none.
        folder: where `themes/` may stand.

    Raises:
        LevelError: the mapping is not a valid level. The diagnostics point into the mapping
            as it would be written in a file.
    """
    fields = plain(data, most=MAX_VALUES)
    theme = _ThemeCheck(folder)
    level, problems = validate(fields, Level)
    problems += theme(level) if level is not None else []
    if level is None or problems or theme.diagnostics:
        shown = _in_text(fields, Level, _ThemeCheck(folder)) + theme.diagnostics
        raise LevelError(shown, None if shown else _told(problems))
    if level.name is None and name is not None:
        level.__dict__["name"] = name
    level.remember_origin(None, folder, theme.found)
    return level


def suite_from_mapping(data: Mapping[str, Any]) -> SuiteFields:
    """Return the fields of a suite that a mapping gives.

    Raises:
        LevelError: the mapping is not a valid suite; see `from_mapping`.
    """
    fields = plain(data, most=MAX_VALUES)
    suite, problems = validate(fields, SuiteFields)
    checks = (_ThemeCheck(None), impossible)
    problems += [each for check in checks for each in check(suite)] if suite is not None else []
    if suite is None or problems:
        shown = _in_text(fields, SuiteFields, *checks)
        raise LevelError(shown, None if shown else _told(problems))
    return suite


def _in_text(
    fields: dict[str, Any],
    model: type[ModelT],
    *checks: Callable[[ModelT], Iterable[Problem]],
) -> list[Diagnostic]:
    """Return what is wrong with a mapping, in the text that it would be; nothing if too long."""
    if not _fits(fields):
        return []
    return parse(SourceFile("<mapping>", emit(fields) or "{}"), model, checks)[1]


def _fits(data: Any) -> bool:
    """Tell whether plain data has no more values, and no longer texts, than a file may have."""
    left, waiting = MAX_NODES, [data]
    while waiting:
        value = waiting.pop()
        size = len(value) if isinstance(value, dict | list | str) else 0
        left -= 1
        if size > (MAX_BYTES if isinstance(value, str) else left):
            return False
        if isinstance(value, dict):
            if any(len(key) > _LONGEST_KEY for key in value):
                return False
            waiting += [*value, *value.values()]
        elif isinstance(value, list):
            waiting += value
    return True


def _told(problems: Sequence[Problem]) -> str:
    return "; ".join(problem.message for problem in problems[:_MOST])


class _ThemeCheck:
    """Looks for the theme that a level names: among ours, or where its folder's themes are."""

    def __init__(self, folder: Path | None):
        self.folder = folder
        self.found: Theme | None = None
        self.diagnostics: list[Diagnostic] = []

    def __call__(self, level: Level | SuiteFields) -> list[Problem]:
        name = level.theme
        if isinstance(name, Theme) or name in BUILTIN_THEMES:
            return []
        folders = theme_folders(self.folder) if self.folder is not None else []
        self.found, self.diagnostics = read_theme(name, folders)
        if self.found is not None or self.diagnostics:
            return []
        known = [*BUILTIN_THEMES, *theme_names(folders)]
        message = f"there is no theme `{name}`{did_you_mean(name, known)}"
        return [Problem("BR401", ("theme",), message, "known here: " + ", ".join(known))]


def _whole(result: tuple[Level | None, list[Diagnostic]]) -> Level:
    level, diagnostics = result
    if level is None:
        raise LevelError(diagnostics)
    return level
