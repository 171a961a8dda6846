"""Texts and files to levels, with their themes; and checking them without loading."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from babyrobot_levels.diagnostics import Diagnostic
from babyrobot_levels.errors import LevelError
from babyrobot_levels.files import SUFFIXES, ReadFault, read_source
from babyrobot_levels.level import Level, plain, slug
from babyrobot_levels.loader import diagnostic, from_yaml, parse, parse_document, validate
from babyrobot_levels.source import SourceFile
from babyrobot_levels.spec.looks import BUILTIN_THEMES, Theme
from babyrobot_levels.spec.problem import Problem
from babyrobot_levels.spec.suite import SuiteFields, impossible
from babyrobot_levels.suggest import did_you_mean
from babyrobot_levels.syntax.document import Document, YamlFault
from babyrobot_levels.syntax.emitter import emit
from babyrobot_levels.syntax.reader import read

_SUITE_HELP = "`brl.load_suite` makes its levels, `babyrobot generate` writes them"


def loads(text: str, *, name: str = "<text>") -> Level:
    """Return the level that a YAML text says.

    Args:
        text: the text of a level file.
        name: what messages call the text.

    Raises:
        LevelError: the text is not a valid level; its `diagnostics` say where and why.
    """
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
    fields = plain(data)
    theme = _ThemeCheck(folder)
    level, problems = validate(fields, Level)
    if level is None or [*theme(level), *theme.diagnostics]:
        shown = parse(SourceFile("<mapping>", emit(fields) or "{}"), Level, [_ThemeCheck(folder)])[
            1
        ]
        told = "; ".join(problem.message for problem in problems)
        raise LevelError([*shown, *theme.diagnostics], None if shown else told or None)
    if level.name is None and name is not None:
        level.__dict__["name"] = name
    level.remember_origin(None, folder, theme.found)
    return level


def suite_from_mapping(data: Mapping[str, Any]) -> SuiteFields:
    """Return the fields of a suite that a mapping gives.

    Raises:
        LevelError: the mapping is not a valid suite; see `from_mapping`.
    """
    fields = plain(data)
    suite, problems = validate(fields, SuiteFields)
    if suite is None or [*_ThemeCheck(None)(suite), *impossible(suite)]:
        text = SourceFile("<mapping>", emit(fields) or "{}")
        shown = parse(text, SuiteFields, [_ThemeCheck(None), impossible])[1]
        raise LevelError(shown, "; ".join(problem.message for problem in problems) or None)
    return suite


class _ThemeCheck:
    """Looks for the theme that a level names: among ours, or in `themes/` of its folder."""

    def __init__(self, folder: Path | None):
        self.folder = folder / "themes" if folder is not None else None
        self.found: Theme | None = None
        self.diagnostics: list[Diagnostic] = []

    def __call__(self, level: Level | SuiteFields) -> list[Problem]:
        name = level.theme
        if isinstance(name, Theme) or name in BUILTIN_THEMES:
            return []
        if self.folder is not None:
            self.found, self.diagnostics = _read_theme(self.folder, name)
        if self.found is not None or self.diagnostics:
            return []
        known = [*BUILTIN_THEMES, *_theme_names(self.folder)]
        message = f"there is no theme `{name}`{did_you_mean(name, known)}"
        return [Problem("BR401", ("theme",), message, "known here: " + ", ".join(known))]


def _whole(result: tuple[Level | None, list[Diagnostic]]) -> Level:
    level, diagnostics = result
    if level is None:
        raise LevelError(diagnostics)
    return level


def _read_theme(folder: Path, name: str) -> tuple[Theme | None, list[Diagnostic]]:
    """Return the theme of that name in a folder, None where there is no such file."""
    for suffix in SUFFIXES:
        path = folder / f"{name}{suffix}"
        if path.is_file():
            try:
                return parse(read_source(path), Theme)
            except ReadFault as fault:
                return None, [fault.diagnostic]
    return None, []


def _theme_names(folder: Path | None) -> list[str]:
    if folder is None or not folder.is_dir():
        return []
    return sorted(path.stem for path in folder.iterdir() if path.suffix in SUFFIXES)
