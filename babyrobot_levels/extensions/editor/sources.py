"""What the editor is opened with, such as files and share codes, and the copies that it makes."""

import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal, get_args

from babyrobot_levels.analysis.guides import guide_of
from babyrobot_levels.extensions.editor.changes.draft import RefusedError
from babyrobot_levels.extensions.editor.session import EditedFile, Session
from babyrobot_levels.extensions.formats.conversion import ConversionError, file_text
from babyrobot_levels.extensions.formats.formats import FORMATS
from babyrobot_levels.extensions.formats.reading import guess
from babyrobot_levels.language.looks import BUILTIN_THEMES
from babyrobot_levels.language.share_code import is_code
from babyrobot_levels.library.catalogue import find, levels, load, looks_like_path
from babyrobot_levels.library.level import Level, load_code
from babyrobot_levels.library.search_path import gallery_folder
from babyrobot_levels.render.page import link_fragment
from babyrobot_levels.render.page_format import TooLargeError
from babyrobot_levels.text.budget import OverBudgetError
from babyrobot_levels.text.errors import LevelError, LevelNotFoundError
from babyrobot_levels.text.files import SUFFIXES, read_source, unreadable
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile, with_schema

EMPTY = """\
version: 1
title: Untitled
size: [8, 5]
start: [0, 0]
exit: [7, 4]
"""
"""A new level."""

NAME = "untitled"
"""What a level without a name is called."""


def session_of(level: str | os.PathLike[str] | Level | None) -> Session:
    """Return a session for a level.

    A level of one's own folders is edited in its file, which need not be a valid level, nor exist
    if it is given by its path. One of the gallery, of a pack, or without a file is a copy.

    Args:
        level: a name, a path, a share code or a level; None for a new one.

    Raises:
        LevelNotFoundError: nothing has that name.
        LevelError: the file cannot be read, or the share code is damaged.
    """
    if level is None:
        return Session(EMPTY, name=NAME)
    if isinstance(level, Level):
        return Session(text_of(level), name=level.name or NAME)
    if isinstance(level, str) and is_code(level):
        return session_of(load_code(level))
    if not isinstance(level, str) or looks_like_path(level):
        return _session_of_file(Path(level).expanduser())
    path = find(level)
    if "/" not in level and not path.resolve().is_relative_to(gallery_folder().resolve()):
        return _session_of_file(path)
    return Session(_copied(level, path), name=level.rpartition("/")[2])


def _session_of_file(path: Path) -> Session:
    if path.suffix not in (*SUFFIXES, ".json"):
        raise unreadable("BR101", str(path), "no level file; give one that ends in .yaml")
    file = EditedFile(path)
    return Session(file.text or EMPTY, file=file)


def text_of(level: Level) -> str:
    """Return a level as the text of a file, without what is relative to its former place.

    A theme that stands in a file of its own is part of the text; a schema is not named.
    """
    if isinstance(level.theme, str) and level.theme not in BUILTIN_THEMES:
        level = level.replace(theme=level.resolved_theme)
    return with_schema(level.to_yaml(comments=True))


def _copied(name: str, path: Path) -> str:
    """Return the text of a level that is found by its name."""
    try:
        return text_of(load(name))
    except LevelError:
        return read_source(path).text


def known() -> dict[str, Any]:
    """Return what can be opened: `levels` by name, and the `formats` of texts, as plain data."""
    return {
        "levels": [
            {"name": each.name, "title": each.title, "size": [*each.size]} for each in levels()
        ],
        "formats": [{"name": name, "title": each.title} for name, each in FORMATS.own.items()],
    }


def opened(source: str, kind: str | None = None) -> tuple[str, str]:
    """Return the text and the name of a level that is asked for in the editor.

    Files are not opened by their paths here: the page reads those that the user chooses, and
    sends their text.

    Args:
        source: a name, a share code or a link with one, the text of a level, or a map of another
            program.
        kind: the format of the map, a name of `FORMATS`, where it may be in several.

    Raises:
        RefusedError: it is none of these, or may be several; nothing is opened.
    """
    if not source.strip():
        raise RefusedError("the text is blank")
    try:
        if is_code(source):
            level = load_code(source)
            return text_of(level), level.name or NAME
        name = source.strip()
        if not any(sign in name for sign in "\n:") and not looks_like_path(name):
            return _copied(name, find(name)), name.rpartition("/")[2]
        return _read(source, kind), NAME
    except LevelNotFoundError as error:
        raise RefusedError(str(error)) from None
    except LevelError as error:
        raise RefusedError(sentence(error)) from None


def _read(text: str, kind: str | None) -> str:
    """Return the text of a level that a text is, or is translated to."""
    source = SourceFile("the text", text)
    if kind is None and _is_level(source):
        return text
    found = [kind] if kind and kind in FORMATS else guess(source)
    if not found:
        raise RefusedError("the text is no level and no map of a known format")
    if len(found) > 1:
        titles = " or a ".join(FORMATS[each].title for each in found)
        raise RefusedError(f"the text may be a {titles}: choose the format")
    return file_text(FORMATS[found[0]].read(source), schema=None, name=None, title="Imported")


def _is_level(source: SourceFile) -> bool:
    """Tell whether a text is meant as a level, valid or not."""
    try:
        data = read(source).data
    except LevelError:
        return source.text.lstrip().startswith(("version:", "#"))
    # Maps of Tiled have a version as well.
    return isinstance(data, Mapping) and "version" in data and "layers" not in data


def sentence(error: LevelError) -> str:
    """Return what is wrong with a level in one sentence."""
    if error.diagnostics:
        first = error.diagnostics[0]
        return first.message if first.line <= 1 else f"line {first.line}: {first.message}"
    if isinstance(error, ConversionError) and error.help:
        return f"{str(error).partition(chr(10))[0]}; {error.help}"
    return str(error).partition("\n")[0]


# -- copies ------------------------------------------------------------------------------


Form = Literal["yaml", "drawing", "python", "code", "link"]
"""The forms: the text, a drawing, a call in Python, a share code, the end of a link."""

FORMS: tuple[Form, ...] = get_args(Form)


def copied(session: Session, form: Form) -> str:
    """Return the level of a session in a form.

    A link is the address of any page that `babyrobot preview LEVEL -o page.html` has made, and
    what this returns for `"link"`: `#`, the share code, and what the page plays.

    Raises:
        RefusedError: the text has errors, or the level does not have this form.
    """
    if form == "yaml":
        return session.text
    if not session.is_valid or session.level is None:
        raise RefusedError("the text has errors; correct them, or copy the text")
    try:
        match form:
            case "drawing":
                return session.level.draw()
            case "python":
                return _python(session.text)
            case "code":
                return session.level.share_code()
            case "link":
                return _link(session.level)
    except TooLargeError as error:
        raise RefusedError(f"{error}; send the level file") from None
    except LevelError as error:
        raise RefusedError(str(error).partition("\n")[0]) from None


def _python(text: str) -> str:
    quoted = text.replace("\\", "\\\\").replace('"""', '\\"\\"\\"').rstrip("\n")
    return f'import babyrobot_levels as brl\n\nlevel = brl.loads("""\\\n{quoted}\n""")\n'


def _link(level: Level) -> str:
    played = level.with_maze_seed(0) if level.has_random_maze else level
    fragment = link_fragment(level, played)
    with suppress(ArithmeticError, OverBudgetError, TooLargeError):
        fragment = link_fragment(level, played, guide_of(played))
    return f"#{fragment}"
