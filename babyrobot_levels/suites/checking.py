"""The texts of levels and suites: found by what names them, checked, and formatted."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from babyrobot_levels.language.looks import BUILTIN_THEMES
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.language.validation import Checked
from babyrobot_levels.mdp.gridworld import GridWorld, WorldT, check_world
from babyrobot_levels.text.diagnostics import Diagnostic, Findings
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import is_folder, read_source, write_text
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile

if TYPE_CHECKING:
    from babyrobot_levels.language.formatting import Formatted
    from babyrobot_levels.language.suite_list import AnySuite
    from babyrobot_levels.library.level import Level
    from babyrobot_levels.suites.suite import Levels


PLACEMENT = ("BR322", "BR323")
"""The errors of what stands or walks where walls are."""


def validate(levels: Levels) -> Findings:
    """Return the errors in levels and suites, as `babyrobot validate` does; empty if all are valid.

    Args:
        levels: a name, a path, a text, a share code, a mapping, or a `Level`; a folder or a pack;
            or several of these. A text has a line break, or a colon and a space.

    Raises:
        LevelNotFoundError: nothing has that name.
        LevelError: a share code is damaged.
        ValueError: there are no level files in a folder.
    """
    return Findings(found for each in texts_of(levels) for found in _errors_in(each))


def format(level: Levels, *, write: bool = False) -> str:  # noqa: A001
    """Return the text of a level or a suite in its canonical form, as `babyrobot format` does.

    Comments are kept. The level stays the same, and so does its digest. Formatting twice changes
    nothing.

    Args:
        level: a name, a path, a text, a share code, a mapping, or a `Level`. A text has a line
            break, or a colon and a space.
        write: whether to write the text to the file that it is from.

    Raises:
        LevelNotFoundError: nothing has that name.
        LevelError: the text is not valid; its `diagnostics` say where and why.
        ValueError: it is not one level, or there is no file to write to.
    """
    found = [*texts_of(level)]
    if len(found) > 1:
        raise ValueError(f"format takes one level, not {len(found):,}")
    if isinstance(found[0], SourceFile):
        if write:
            raise ValueError("the text is from no file that could be written")
        return formatted(found[0]).text
    source = read_source(found[0])
    text = formatted(source, found[0]).text
    if write and (text != source.text or source.mark):
        write_text(found[0], text)
    return text


def formatted(source: SourceFile, path: Path | None = None) -> Formatted:
    """Return the canonical form of a text, as `format_source` does; see there.

    Raises:
        LevelError: the text is not valid, or its doors and movers do not fit its walls.
    """
    from babyrobot_levels.language.formatting import format_source

    found = format_source(source, path)
    if "doors" in source.text or "movers" in source.text:
        errors = [each for each in errors_of(source, path) if each.code in PLACEMENT]
        if errors:
            raise LevelError(errors)
    return found


def texts_of(levels: Levels) -> Iterator[Path | SourceFile]:
    """Yield the files of levels and suites, or the texts of those that are in no file.

    Args and errors are those of `validate`.
    """
    from babyrobot_levels.language.share_code import decode, is_code
    from babyrobot_levels.library.level import Level
    from babyrobot_levels.text.emitter import emit

    if isinstance(levels, Level):
        yield SourceFile(levels.name or "<level>", _text_of(levels))
    elif isinstance(levels, Mapping):
        yield SourceFile("<mapping>", emit(plain(levels)) or "{}", is_made=True)
    elif isinstance(levels, str) and is_code(levels):
        yield decode(levels)
    elif isinstance(levels, str) and ("\n" in levels or ": " in levels):
        yield SourceFile("<text>", levels)
    elif isinstance(levels, str | os.PathLike):
        yield from _files_of(levels)
    elif isinstance(levels, Iterable):
        for each in levels:
            yield from texts_of(each)
    else:
        raise TypeError(f"a level is a name, a path or a text, not {type(levels).__name__}")


def _text_of(level: Level) -> str:
    """Return the text of a level that stands alone, with its name and its theme."""
    alone = level if level.name is None else level.replace(name=level.name)
    if isinstance(level.theme, str) and level.theme not in BUILTIN_THEMES:
        alone = alone.replace(theme=level.resolved_theme)
    return alone.to_yaml(comments=True)


def _files_of(name: str | os.PathLike[str]) -> Iterator[Path]:
    from babyrobot_levels.library.catalogue import find, folder_named, looks_like_path
    from babyrobot_levels.library.search_path import yaml_files

    path = Path(name)
    with suppress(RuntimeError):
        path = path.expanduser()
    folder = path if is_folder(path) else folder_named(name) if isinstance(name, str) else None
    if isinstance(name, str) and looks_like_path(name) and folder is None:
        yield path
    elif folder is None:
        yield find(name) if isinstance(name, str) else path
    else:
        files = [*yaml_files(folder, all_of_them=True)]
        if not files:
            raise ValueError(f"no level files (.yaml) in {name}")
        yield from files


def check_document(
    document: Document, model: type[WorldT], path: Path | None = None
) -> Checked[WorldT] | Checked[AnySuite]:
    """Check a level or a suite, whichever the document says it is, with what the suite lists.

    Args:
        document: the document.
        model: the class of the level.
        path: the file that it is from: it gives the name, and what stands beside it.
    """
    checked = check_world(document, model, path)
    if checked.value is None or isinstance(checked.value, GridWorld):
        return checked
    from babyrobot_levels.language.suite_list import SuiteListFields
    from babyrobot_levels.suites.members import member_issues

    if not isinstance(checked.value, SuiteListFields):
        return checked
    issues = member_issues(checked.value, path)
    return Checked(None, [*map(document.diagnostic, issues)]) if issues else checked


def errors_of(source: SourceFile, path: Path | None = None) -> list[Diagnostic]:
    """Return what is wrong with a text that is a level or a suite; nothing if all is well."""
    try:
        return check_document(read(source), GridWorld, path).diagnostics
    except LevelError as error:
        return [*error.diagnostics]


def _errors_in(given: Path | SourceFile) -> list[Diagnostic]:
    if isinstance(given, SourceFile):
        return errors_of(given)
    try:
        return errors_of(read_source(given), given)
    except LevelError as error:
        return [*error.diagnostics]
