"""Levels and suites checked as wholes, with the theme that they name."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from babyrobot_levels.language.level import LevelSpec
from babyrobot_levels.language.looks import BUILTIN_THEMES, Theme
from babyrobot_levels.language.names import slug
from babyrobot_levels.language.plain_data import MAX_VALUES, plain
from babyrobot_levels.language.validation import Checked, ModelT, check, parse, validate
from babyrobot_levels.text.diagnostics import Diagnostic, Issue
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import (
    MAX_DEPTH,
    PACK_FILE,
    SUFFIXES,
    is_file,
    is_within,
    unreadable,
)
from babyrobot_levels.text.reader import MAX_NODES, open_document, read
from babyrobot_levels.text.source import MAX_BYTES, SourceFile
from babyrobot_levels.text.words import did_you_mean

if TYPE_CHECKING:
    from babyrobot_levels.language.suite import SuiteFields
    from babyrobot_levels.language.suite_list import AnySuite

LevelT = TypeVar("LevelT", bound=LevelSpec)

_MOST = 5
"""Of more issues than this without a location, only so many are listed."""

_LONGEST_KEY = 100
"""No field's name is longer; what YAML takes for a name ends at some length as well."""

_LIST_HELP = "`brl.load_suite` loads its levels"
_SUITE_HELP = "`brl.load_suite` makes its levels, `babyrobot generate` writes them"


def is_suite(document: Document) -> bool:
    """Tell whether a document says that it is something else than a level: `kind: suite`."""
    return isinstance(document.data, dict) and "kind" in document.data


def check_document(
    document: Document, model: type[LevelT], path: Path | None = None
) -> Checked[LevelT] | Checked[AnySuite]:
    """Check a level or a suite, whichever the document says it is; see `check_level`."""
    return check_suite(document, path) if is_suite(document) else check_level(document, model, path)


def check_level(
    document: Document, model: type[LevelT], path: Path | None = None
) -> Checked[LevelT]:
    """Check a document as a level.

    Args:
        document: the document.
        model: the class of the level.
        path: the file that it is from: it gives the level's name, and themes beside it.
    """
    if is_suite(document):
        help_text = _LIST_HELP if "levels" in document.data else _SUITE_HELP
        issue = Issue("BR201", ("kind",), "this is a suite of levels, not a level", help_text)
        return Checked(None, [document.diagnostic(issue)])
    theme = _ThemeCheck(path)
    level, diagnostics = check(document, model, [theme])
    diagnostics += theme.diagnostics
    if level is None or diagnostics:
        return Checked(None, diagnostics)
    _name(level, path)
    level.remember_origin(document.source, theme.folder, theme.found)
    return Checked(level, [])


def check_suite(document: Document, path: Path | None = None) -> Checked[AnySuite]:
    """Check a document as a suite; see `check_level`. What it lists is not looked for."""
    from babyrobot_levels.language.suite import SuiteFields, impossible
    from babyrobot_levels.language.suite_list import SuiteListFields, suite_model

    if suite_model(document.data) is SuiteListFields:
        suite: AnySuite | None
        suite, diagnostics = check(document, SuiteListFields)
    else:
        theme = _ThemeCheck(path)
        suite, diagnostics = check(document, SuiteFields, [theme, impossible])
        diagnostics += theme.diagnostics
    if suite is None or diagnostics:
        return Checked(None, diagnostics)
    _name(suite, path)
    return Checked(suite, [])


def level_from_mapping(
    data: Mapping[str, Any],
    model: type[LevelT],
    *,
    name: str | None = None,
    folder: Path | None = None,
) -> LevelT:
    """Return the level that a mapping of the language's fields gives.

    Args:
        data: the fields. NumPy's numbers and arrays, tuples and models are taken too.
        model: the class of the level.
        name: the level's name, if the mapping gives none.
        folder: where `themes/` may stand.

    Raises:
        LevelError: the mapping is not a valid level. The diagnostics point into the mapping
            as it would be written in a file.
    """
    theme = _ThemeCheck(None, folder)
    level = _from_mapping(data, model, [theme], theme)
    if level.name is None and name is not None:
        level.__dict__["name"] = name
    level.remember_origin(None, folder, theme.found)
    return level


def error_in_mapping(data: Mapping[str, Any], issues: Sequence[Issue]) -> LevelError:
    """Return the error of a mapping whose fields are valid by themselves.

    Its diagnostics point into the mapping as it would be written in a file.
    """
    fields = plain(data, most=MAX_VALUES)
    if not _fits(fields):
        return LevelError(message="; ".join(issue.message for issue in issues[:_MOST]))
    document = read(_written(fields))
    return LevelError([document.diagnostic(issue) for issue in issues])


def suite_from_mapping(data: Mapping[str, Any]) -> AnySuite:
    """Return the fields of a suite that a mapping gives. What it lists is not looked for.

    Raises:
        LevelError: the mapping is not a valid suite; see `level_from_mapping`.
    """
    from babyrobot_levels.language.suite_list import SuiteListFields, suite_model

    if suite_model(data) is SuiteListFields:
        return _from_mapping(data, SuiteListFields, [], None)
    return grown_from_mapping(data)


def grown_from_mapping(data: Mapping[str, Any]) -> SuiteFields:
    """Return the fields of a suite that grows mazes; see `suite_from_mapping`."""
    from babyrobot_levels.language.suite import SuiteFields, impossible

    theme = _ThemeCheck(None)
    return _from_mapping(data, SuiteFields, [theme, impossible], theme)


def _name(model: LevelSpec | AnySuite, path: Path | None) -> None:
    """Give a level or a suite the name of its file, if it states none."""
    if model.name is None and path is not None:
        model.__dict__["name"] = slug(path.stem)


def _from_mapping(
    data: Mapping[str, Any],
    model: type[ModelT],
    checks: Sequence[Callable[[Any], Iterable[Issue]]],
    theme: _ThemeCheck | None,
) -> ModelT:
    fields = plain(data, most=MAX_VALUES)
    value, issues = validate(fields, model)
    if value is not None:
        issues = [issue for each in checks for issue in each(value)]
    found = [] if theme is None else theme.diagnostics
    if value is not None and not issues and not found:
        return value
    shown: list[Diagnostic] = []
    if _fits(fields):
        shown = parse(_written(fields), model, checks).diagnostics
    shown += found
    raise LevelError(shown, None if shown else "; ".join(issue.message for issue in issues[:_MOST]))


def _written(fields: Any) -> SourceFile:
    """Return the text of a file with these fields."""
    from babyrobot_levels.text.emitter import emit

    return SourceFile("<mapping>", emit(fields) or "{}", is_made=True)


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


class _ThemeCheck:
    """Looks for the theme that a level names: a built-in one, or one of its folder.

    Attributes:
        folder: the folder of the level, None if it has none.
        found: the theme, None for a built-in one.
        diagnostics: what is wrong with the theme's file.
    """

    def __init__(self, path: Path | None, folder: Path | None = None):
        self.folder = path.parent if path is not None else folder
        self.found: Theme | None = None
        self.diagnostics: list[Diagnostic] = []

    def __call__(self, level: LevelSpec | SuiteFields) -> list[Issue]:
        name = level.theme
        if isinstance(name, Theme) or name in BUILTIN_THEMES:
            return []
        folders = theme_folders(self.folder) if self.folder is not None else []
        self.found, self.diagnostics = read_theme(name, folders)
        if self.found is not None or self.diagnostics:
            return []
        known = [*BUILTIN_THEMES, *theme_names(folders)]
        message = f"unknown theme `{name}`{did_you_mean(name, known)}"
        return [Issue("BR401", ("theme",), message, "known themes: " + ", ".join(known))]


def theme_folders(folder: Path) -> list[Path]:
    """Return where the themes of the levels in a folder stand, the nearest first.

    In `themes/` of the folder itself; of a folder in a pack, also of those around it, up to the one
    that holds the `pack.yaml`.
    """
    # Up by names, not by links: what a link leads to may lie in another pack, or in none.
    here = Path(os.path.abspath(folder))  # noqa: PTH100
    around = [folder, *here.parents[:MAX_DEPTH]]
    for number, each in enumerate(around, 1):
        if os.path.lexists(each / PACK_FILE):
            return [inner / "themes" for inner in around[:number]]
    return [folder / "themes"]


def read_theme(name: str, folders: Sequence[Path]) -> Checked[Theme]:
    """Return the theme of that name from the first folder that has it, or what is wrong with it.

    None, and nothing wrong, where no folder has it. The file lies in what is around the folder, or
    around the last one, which is that of the pack: a link may lead to any file of this machine.
    """
    for folder in folders:
        for suffix in SUFFIXES:
            path = folder / f"{name}{suffix}"
            if is_file(path):
                try:
                    if not any(is_within(path, each.parent) for each in (folder, folders[-1])):
                        why, advice = "this link leads out of the folder", "replace it by the file"
                        raise unreadable("BR101", str(path), why, advice)
                    return check(open_document(path), Theme)
                except LevelError as error:
                    return Checked(None, [*error.diagnostics])
    return Checked(None, [])


def theme_names(folders: Sequence[Path]) -> list[str]:
    """Return the names of the themes in some folders, sorted."""
    return sorted(
        {path.stem for folder in folders for path in _inside(folder) if path.suffix in SUFFIXES}
    )


def _inside(folder: Path) -> list[Path]:
    """Return what is in a folder: nothing where it is not there, or not for us to see."""
    try:
        return [*folder.iterdir()]
    except OSError:
        return []
