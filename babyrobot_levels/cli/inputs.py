"""The levels that commands take as arguments: names, files, share codes, standard input."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from babyrobot_levels.cli.console import fail
from babyrobot_levels.cli.reporting import STANDARD_INPUT, read_path

if TYPE_CHECKING:
    from babyrobot_levels.library.level import Level

LevelArgument = Annotated[
    str,
    typer.Argument(
        metavar="LEVEL",
        help="A name, pack/name, the path of a file, or a share code; `-` is standard input.",
    ),
]


def load_level(text: str) -> Level:
    """Return the level that an argument names."""
    from babyrobot_levels.language.share_code import is_code
    from babyrobot_levels.library.catalogue import load
    from babyrobot_levels.text.errors import LevelNotFoundError

    if text == str(STANDARD_INPUT):
        return _read_level()
    if "\n" in text and not is_code(text):
        raise LevelNotFoundError(text)
    return load(text)


def load_two(one: str, other: str) -> tuple[Level, Level]:
    """Return the two levels that arguments name, of which one may be standard input."""
    if one == other == str(STANDARD_INPUT):
        fail("standard input can be one of the two levels only")
    return load_level(one), load_level(other)


def _read_level() -> Level:
    """Return the level that standard input holds."""
    from babyrobot_levels.library.reading import read_level
    from babyrobot_levels.text.errors import LevelError
    from babyrobot_levels.text.files import ReadFault

    try:
        level, diagnostics = read_level(read_path(STANDARD_INPUT))
    except ReadFault as fault:
        raise LevelError([fault.diagnostic]) from None
    if level is None:
        raise LevelError(diagnostics)
    return level


def with_seed(level: Level, maze_seed: int | None) -> Level:
    """Return a level with the maze of a seed, which is needed if its mazes are random."""
    if level.has_random_maze:
        if maze_seed is None:
            fail("each reset grows another maze of this level", "choose one with --maze-seed N")
        return level.with_maze_seed(maze_seed)
    if maze_seed is not None:
        fail("the level's maze is not random", "--maze-seed is for `maze: {seed: random}`")
    return level
