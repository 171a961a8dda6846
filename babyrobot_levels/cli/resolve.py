"""`babyrobot resolve`: a level with its maze written out as walls."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from babyrobot_levels.cli.console import ForceOption, OutputOption, fail, note, save, write
from babyrobot_levels.cli.new_level import schema_for
from babyrobot_levels.cli.preview import LevelArgument, load_level

if TYPE_CHECKING:
    from babyrobot_levels.library.level import Level

_RELATIVE_SCHEMA = re.compile(
    r"^(# yaml-language-server: *\$schema=)(?![A-Za-z][\w+.-]*:|/)\S+", re.M
)


def resolve(
    level: LevelArgument,
    maze_seed: Annotated[
        int | None,
        typer.Option(
            metavar="N", help="Of a level with random mazes, the seed to take.", show_default=False
        ),
    ] = None,
    output: OutputOption = None,
    force: ForceOption = False,
) -> None:
    """Write out a level's maze as walls; game and picture stay the same.

    `maze` and `openings` are gone from the file then, and each wall can be moved by hand.
    The other fields keep their comments.

    Examples:

      babyrobot resolve final-maze

      babyrobot resolve random-maze --maze-seed 7 -o seven.yaml
    """
    from babyrobot_levels.text.source import MAX_BYTES

    loaded = with_seed(load_level(level), maze_seed)
    if loaded.maze is None:
        note(f"{loaded.name or 'the level'} has no maze; nothing is to be written out")
    resolved = loaded.resolve()
    text = resolved.to_yaml(comments=True)
    if output is not None:
        text = _text_for(resolved, text, output)
    if len(text.encode("utf-8")) > MAX_BYTES:
        fail("the walls of this maze are too many for a level file, which has room for 1 MiB")
    if output is not None:
        save(output, text, force=force)
    else:
        write(text)


def with_seed(level: Level, maze_seed: int | None) -> Level:
    """Return a level with the maze of a seed, which is needed if its mazes are random."""
    if level.has_random_maze:
        if maze_seed is None:
            fail("each reset grows another maze of this level", "choose one with --maze-seed N")
        return level.with_maze_seed(maze_seed)
    if maze_seed is not None:
        fail("the level's maze is not random", "--maze-seed is for `maze: {seed: random}`")
    return level


def _text_for(level: Level, text: str, path: Path) -> str:
    """Return the text for a file: away from its folder, a level carries its theme with it."""
    from babyrobot_levels.language.looks import BUILTIN_THEMES
    from babyrobot_levels.library.reading import load_source
    from babyrobot_levels.text.errors import LevelError
    from babyrobot_levels.text.source import SourceFile

    if isinstance(level.theme, str) and level.theme not in BUILTIN_THEMES:
        try:
            theme = load_source(SourceFile(str(path), text), path).resolved_theme
        except LevelError:
            theme = None
        if theme != level.resolved_theme:
            text = level.replace(theme=level.resolved_theme).to_yaml(comments=True)
    # Where the schema lies is said as seen from the level's own folder.
    return _RELATIVE_SCHEMA.sub(lambda found: found[1] + schema_for(path), text, count=1)
