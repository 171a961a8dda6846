"""Levels from files and texts: open a document, check it, load it."""

from __future__ import annotations

from pathlib import Path

from babyrobot_levels.language.documents import check_document as check_any
from babyrobot_levels.language.documents import check_level
from babyrobot_levels.language.share_code import NAME, decode
from babyrobot_levels.language.suite_list import AnySuite
from babyrobot_levels.language.validation import Checked
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.errors import UnplayableError
from babyrobot_levels.text.files import source_of
from babyrobot_levels.text.reader import open_document, read
from babyrobot_levels.text.source import SourceFile


def check_document(
    document: Document, path: Path | None = None
) -> Checked[Level] | Checked[AnySuite]:
    """Check a level or a suite, whichever the document says it is, without what a suite lists.

    `path` is the file that it is from: it gives the name, and themes beside it.
    """
    checked = check_any(document, Level, path)
    return _playable(checked, document) if isinstance(checked.value, Level) else checked


def load_document(document: Document, path: Path | None = None) -> Level:
    """Return the level of a document; see `check_document`.

    Raises:
        LevelError: it is not a valid level; its `diagnostics` say where and why.
    """
    return _playable(check_level(document, Level, path), document).valid()


def _playable(checked: Checked[Level], document: Document) -> Checked[Level]:
    """Refuse a level that cannot be compiled: where its fields leave that open, by compiling it."""
    level = checked.value
    if level is None or level.has_random_maze:
        return checked
    # What most levels need not import.
    from babyrobot_levels.mdp.configurations import surely_fits
    from babyrobot_levels.mdp.grid import check_placement

    try:
        if not surely_fits(level):
            level.compile()
        elif level.stands_on_grid:
            check_placement(level, level.grid())
    except UnplayableError as error:
        found = sorted(map(document.diagnostic, error.issues), key=lambda at: (at.line, at.column))
        return Checked(None, found)
    return checked


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
    return load_source(SourceFile(name, text))


def load_source(source: SourceFile, path: Path | None = None) -> Level:
    """Return the level of a text; see `load_document`."""
    return load_document(read(source), path)


def load_file(path: Path) -> Level:
    """Return the level of a file. A theme that it names may stand in `themes/` beside it.

    Raises:
        LevelError: the file cannot be read, or is not a valid level.
    """
    return load_document(open_document(path), path)


def load_code(text: str) -> Level:
    """Return the level of a share code, or of a link that ends in one. Blanks do not count.

    Raises:
        LevelError: the code is damaged, cut off, of an unknown version, or what it holds is not
            a valid level.
    """
    level = load_source(source_of(decode(text), NAME))
    # The JSON is no text that saving should keep.
    level.remember_origin(None, None, None)
    return level
