"""Texts and files to levels, with their themes; and checking them without loading."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from babyrobot_levels.diagnostics import Diagnostic
from babyrobot_levels.errors import LevelError
from babyrobot_levels.files import SUFFIXES, ReadFault, read_source
from babyrobot_levels.level import Level, slug
from babyrobot_levels.loader import parse
from babyrobot_levels.source import SourceFile
from babyrobot_levels.spec.looks import BUILTIN_THEMES, Theme
from babyrobot_levels.spec.problem import Problem
from babyrobot_levels.suggest import did_you_mean


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


def check(path_or_text: str | Path) -> list[Diagnostic]:
    """Return all that is wrong with a level, given as a path or as a text; nothing if all is well.

    A `str` counts as a text if it has a line end or a `: ` in it, else as a path.
    """
    if isinstance(path_or_text, str) and ("\n" in path_or_text or ": " in path_or_text):
        return read_level(SourceFile("<text>", path_or_text))[1]
    return read_file(Path(path_or_text))[1]


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
    themes: list[Theme] = []
    foreign: list[Diagnostic] = []

    def check_theme(level: Level) -> Iterable[Problem]:
        if isinstance(level.theme, Theme) or level.theme in BUILTIN_THEMES:
            return
        folder = path.parent / "themes" if path is not None else None
        theme, found = _read_theme(folder, level.theme) if folder else (None, [])
        if theme is not None:
            themes.append(theme)
        elif found:
            foreign.extend(found)
        else:
            known = [*BUILTIN_THEMES, *_theme_names(folder)]
            yield Problem(
                "BR401",
                ("theme",),
                f"there is no theme `{level.theme}`{did_you_mean(level.theme, known)}",
                "known here: " + ", ".join(known),
            )

    level, diagnostics = parse(source, Level, [check_theme])
    diagnostics += foreign
    if level is None or diagnostics:
        return None, diagnostics
    if level.name is None and path is not None:
        level.__dict__["name"] = slug(path.stem)
    level.remember_origin(source, themes[0] if themes else None)
    return level, []


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
