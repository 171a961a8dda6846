"""Texts to their canonical form: the same data and the same comments, in one form."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from babyrobot_levels.language.documents import check_document, is_suite
from babyrobot_levels.language.formatting.scalars import KeptAsIs
from babyrobot_levels.language.formatting.tree import fields_of, tidy, tree_of
from babyrobot_levels.language.level import LevelSpec
from babyrobot_levels.language.looks import Theme
from babyrobot_levels.language.suite_list import AnySuite, suite_model
from babyrobot_levels.language.validation import check
from babyrobot_levels.text.comments import comments
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.emitter import lines_of
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile


@dataclass(frozen=True, slots=True)
class Formatted:
    """What became of a text.

    Attributes:
        text: its canonical form.
        kept: why the text is left as it is, None where it is not.
    """

    text: str
    kept: str | None = None


def format_source(source: SourceFile, path: Path | None = None) -> Formatted:
    """Return the canonical form of a level, of a suite, or of a theme.

    Args:
        source: the text.
        path: the file that it is from: one in a folder `themes` is a theme, and a theme that a
            level names has to be there.

    Raises:
        LevelError: the text is not valid.
    """
    document = read(source)
    is_theme = path is not None and path.absolute().parent.name == "themes"
    model: type[LevelSpec | AnySuite | Theme] = LevelSpec
    if is_theme or is_suite(document):
        model = Theme if is_theme else suite_model(document.data)
    if is_theme or path is None:
        # Whether a theme that the level names is there, only a file's folder tells.
        check(document, model).valid()
    else:
        check_document(document, LevelSpec, path).valid()
    try:
        lines = lines_of(tree_of(document, fields_of(model)))
    except KeptAsIs as reason:
        return Formatted(source.text, str(reason))
    text = "".join(f"{line}\n" for line in lines)
    is_dos = source.text.find("\r\n") == source.text.find("\n") - 1 >= 0
    text = text.replace("\n", "\r\n") if is_dos else text
    if text != source.text and not _says_the_same(text, document):
        return Formatted(source.text, "any other form would change its meaning")
    return Formatted(text)


def _says_the_same(text: str, before: Document) -> bool:
    """Tell whether a text has the data and the comments of a document."""
    try:
        after = read(SourceFile("", text))
    except LevelError:
        return False
    return not after.issues and _content(after) == _content(before)


def _content(document: Document) -> tuple[str, Counter[str]]:
    # As JSON, where 1, 1.0 and true are three things, and the order of fields is none.
    data = json.dumps(document.data, sort_keys=True)
    return data, Counter(tidy(comment.text) for comment in comments(document))
