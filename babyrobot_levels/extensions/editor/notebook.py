"""The editor in a notebook, for those who may not have what it needs."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from babyrobot_levels.library.level import Level
from babyrobot_levels.text.errors import how_to_install

if TYPE_CHECKING:
    from babyrobot_levels.extensions.editor.widget import Editor


def edit(level: str | os.PathLike[str] | Mapping[str, Any] | Level | None = None) -> Editor:
    """Return an editor for a notebook cell: a widget in which a level is drawn.

    What is drawn is in `editor.level` and `editor.yaml` at once; `editor.observe(handler,
    "level")` calls a handler at each change, and `editor.save(path)` writes the text to a file.

    Args:
        level: a name, a path, a share code, a mapping of the language's fields or a level; None
            for a new one. A file is saved in its place, and need not be valid, nor exist.

    Raises:
        ImportError: the package `anywidget` is not installed.
        LevelNotFoundError: nothing has that name.
        LevelError: the file cannot be read, or the level is not valid.
    """
    try:
        from babyrobot_levels.extensions.editor.widget import Editor
    except ModuleNotFoundError as error:
        if error.name != "anywidget":
            raise
        raise ImportError(
            f"the editor needs the package `anywidget`: {how_to_install('editor')}",
            name="anywidget",
        ) from None
    from babyrobot_levels.extensions.editor.sources import session_of
    from babyrobot_levels.library.catalogue import load

    return Editor(session_of(load(level) if isinstance(level, Mapping) else level))
