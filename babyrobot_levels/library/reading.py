"""Levels from files and texts: open a document, check it, load it."""

from __future__ import annotations

from pathlib import Path

from babyrobot_levels.language.documents import check_level
from babyrobot_levels.language.share_code import NAME, decode
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.gridworld import playable
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.files import source_of
from babyrobot_levels.text.reader import open_document, read
from babyrobot_levels.text.source import SourceFile


def load_document(document: Document, path: Path | None = None) -> Level:
    """Return the level of a document, which `path` is the file of: it gives name and themes.

    Raises:
        LevelError: it is not a valid level; its `diagnostics` say where and why.
    """
    return playable(check_level(document, Level, path), document).valid()


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
