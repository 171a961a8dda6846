"""`resolve`: a level with its maze written out as walls, and its file."""

from __future__ import annotations

import os
from pathlib import Path

from babyrobot_levels.language.looks import BUILTIN_THEMES
from babyrobot_levels.library.catalogue import LevelLike, load
from babyrobot_levels.library.level import Level
from babyrobot_levels.library.reading import load_source
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import schema_for, write_new
from babyrobot_levels.text.source import MAX_BYTES, SourceFile, with_schema


def resolve(
    level: LevelLike,
    path: str | os.PathLike[str] | None = None,
    *,
    maze_seed: int | None = None,
    force: bool = False,
) -> Level:
    """Return a level with its maze written out as walls, as `babyrobot resolve` does.

    A level without a maze is returned as it is.

    Args:
        level: a name, a path, a share code, a mapping, or a level.
        path: a file to write it to; it keeps the level's comments.
        maze_seed: the seed of the maze of a level with a random maze.
        force: whether to replace an existing file.

    Raises:
        LevelNotFoundError: nothing has that name.
        LevelError: the level is not valid, or its maze is random and there is no seed.
        ValueError: the level's maze is not random, or its walls do not fit into a file.
        FileExistsError: there is a file, and `force` is not given.
    """
    found = load(level)
    if maze_seed is not None:
        if not found.has_random_maze:
            raise ValueError("the level's maze is not random: leave out maze_seed")
        found = found.with_maze_seed(maze_seed)
    resolved = found.resolve()
    if path is not None:
        text = text_for(resolved, resolved.to_yaml(comments=True), Path(path))
        if len(text.encode("utf-8")) > MAX_BYTES:
            raise ValueError("the walls of this maze do not fit into a level file of 1 MiB")
        write_new(Path(path), text, force=force)
    return resolved


def text_for(level: Level, text: str, path: Path) -> str:
    """Return the text for a file; it includes a theme that is not found from there."""
    if isinstance(level.theme, str) and level.theme not in BUILTIN_THEMES:
        try:
            theme = load_source(SourceFile(str(path), text), path).resolved_theme
        except LevelError:
            theme = None
        if theme != level.resolved_theme:
            text = level.replace(theme=level.resolved_theme).to_yaml(comments=True)
    return with_schema(text, schema_for(path))
